// SPDX-License-Identifier: GPL-3.0-or-later
// The four garments of examples/ on the built-in form, from their files to written files.
#include "draping/compare.h"
#include "io/read_garment.h"
#include "src/pipeline.h"
#include "tests/support/sound_drape.h"
#include "tests/support/temp_folder.h"

#include <catch2/catch.hpp>

using namespace toile;
using namespace toile::test;

namespace {

DrapeJob job_of(const std::string& name) {
    DrapeJob job;
    job.pattern = TOILE_SOURCE_DIR "/examples/" + name + ".json";
    job.edge_length = 0.03;
    return job;
}

const std::string reference_of(const std::string& name) {
    return TOILE_SOURCE_DIR "/tests/reference/" + name + ".obj";
}

TriMesh mesh_of(const ReadGarment& g) {
    return {g.x, node_triangles(g.garment)};
}

const char* fabric_of(const std::string& name) {
    return name == "tee" ? "jersey" : name == "skirt" ? "wool" : name == "trousers" ? "linen" : "poplin";
}

} // namespace

TEST_CASE("the examples drape on the form and keep every promise") {
    for (const std::string name : {"tee", "skirt", "trousers", "dress"}) {
        INFO(name);
        const TempFolder folder;
        DrapeJob job = job_of(name);
        job.garments = {folder / "a.obj", folder / "a.glb"};
        const DrapeOutcome drape = drape_soundly(job, fabric_of(name), 0.03);
        CHECK(drape.result.residual <= 1e-3);
        for (const Landmark& l : drape.result.landmarks)
            if (l.belongs == Belongs::neck) CHECK(l.off.value() < 0.03);
        // Many drapes are valid; this one is of the same kind as the stored one.
        const ReadGarment stored = read_garment(reference_of(name));
        CHECK(compare({drape.result.state.positions, node_triangles(drape.result.garment)}, mesh_of(stored)).rms < 0.02);
    }
}

TEST_CASE("a stored drape is at rest: a restart stays within half a millimetre of it") {
    for (const std::string name : {"tee", "skirt", "trousers", "dress"}) {
        INFO(name);
        DrapeJob job = job_of(name);
        job.from = reference_of(name);
        const DrapeOutcome drape = run_job(job);
        INFO(drape.result.where);
        CHECK(drape.result.status == DrapeStatus::converged);
        const ReadGarment stored = read_garment(job.from);
        const Comparison c =
            compare({drape.result.state.positions, node_triangles(drape.result.garment)}, mesh_of(stored));
        CHECK(c.same_triangles);
        CHECK(c.max < 0.5e-3);
    }
}

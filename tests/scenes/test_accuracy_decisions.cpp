// SPDX-License-Identifier: GPL-3.0-or-later
// What a drape to an accuracy decides by itself, forced the other way: no decision may cost more than the accuracy asked for.
#include "draping/compare.h"
#include "draping/drape_to_accuracy.h"
#include "sewing/avatar.h"
#include "sewing/form.h"
#include "src/drape_input.h"

#include <catch2/catch.hpp>

using namespace toile;

namespace {

constexpr double asked = 5e-3; // m

struct Tee {
    Pattern pattern;
    DrapeInput input;
    TriMesh form = make_form({});

    Tee() {
        std::vector<std::string> warnings;
        pattern = sound_pattern(TOILE_SOURCE_DIR "/examples/tee.json", warnings);
        input = input_of(pattern, "", 0.04);
    }
    AccuracyOptions options() const {
        AccuracyOptions o;
        o.asked = asked;
        o.mesh = [this](double edge, const PlaceFactor& size) { return stage(pattern, flat_of(pattern, edge, false, size)); };
        return o;
    }
    DrapeResult drape(const AccuracyOptions& o) const { return drape_to_accuracy(o, {form, smoothed_toward_core(form, 0.01)}, input.fabrics, {}); }
};

} // namespace

TEST_CASE("decisions of a drape to an accuracy cost no more than it when forced the other way") {
    const Tee tee;
    const DrapeResult chosen = tee.drape(tee.options());
    REQUIRE(chosen.status == DrapeStatus::converged);
    REQUIRE(chosen.accuracy->met);
    SECTION("iterations to the end") {
        AccuracyOptions o = tee.options();
        o.ends_early = false;
        const DrapeResult other = tee.drape(o);
        CHECK(other.residual <= 1e-3);
        CHECK(chosen.residual > 1e-3);
        CHECK(compare(surface(chosen), surface(other)).rms < 0.1 * asked);
    }
    SECTION("equal triangles everywhere") {
        AccuracyOptions o = tee.options();
        o.graded = false;
        const DrapeResult other = tee.drape(o);
        CHECK(chosen.garment.uv.size() < 0.8 * other.garment.uv.size());
        CHECK(compare(surface(chosen), surface(other)).rms < asked);
    }
}

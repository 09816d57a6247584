// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/drape.h"
#include "io/read_pattern.h"
#include "sewing/form.h"

#include <catch2/catch.hpp>

using namespace toile;

TEST_CASE("the tee of the examples drapes on the form and keeps its promises") {
    const Pattern pattern = read_pattern(TOILE_SOURCE_DIR "/examples/tee.json");
    TriangulateOptions sizing;
    sizing.edge_length = 0.03;
    sizing.levels = 2;
    const FlatPattern flat = triangulate(pattern, sizing);
    const TriMesh body = make_form({});
    const PanelFabrics fabrics(pattern.panels.size(), fabric_preset("jersey"));
    const DrapeResult drape = toile::drape(pattern, flat, {body, body.points}, fabrics, {});

    CHECK(drape.status == DrapeStatus::converged);
    CHECK(drape.residual <= 1e-3);
    const std::vector<Triangle> cloth = node_triangles(drape.garment);
    const IntersectionCount crossings = count_intersections(cloth, drape.state.positions, body);
    CHECK(crossings.cloth_avatar == 0);
    CHECK(crossings.cloth_cloth == 0);
    CHECK(seam_gap_max(drape.garment, drape.state.positions) == 0);
    CHECK(count_pieces(cloth, drape.garment.node_count) == 1);
    CHECK(clearance_min(cloth, drape.state.positions, body) > 1e-5);
    const StrainMeasure strain = measure_strain(drape.garment, drape.state.positions, fabrics);
    CHECK(strain.warp.max <= strain.limit_warp);
    CHECK(strain.weft.max <= strain.limit_weft);
}

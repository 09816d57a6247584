// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_pattern.h"
#include "io/write_altered.h"
#include "io/write_file.h"
#include "patterns/alter.h"
#include "patterns/curve.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_data.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <sstream>

using namespace toile;
using namespace toile::test;

namespace {

/// Every vertex of every panel somewhere else, and every control point.
Pattern shaken(const Pattern& drawn) {
    std::vector<Alteration> all(1);
    int n = 0;
    for (int p = 0; p < int(drawn.panels.size()); ++p)
        for (int e = 0; e < int(drawn.panels[p].outline.size()); ++e) {
            const Curve& curve = drawn.panels[p].outline[e].curve;
            const int controls = std::holds_alternative<Quadratic>(curve) ? 1 : std::holds_alternative<Cubic>(curve) ? 2 : 0;
            for (int c = 0; c <= controls; ++c, ++n)
                all[0].moves.push_back({{p, e, c}, {std::sin(2.0 * n), std::cos(3.0 * n)}});
        }
    return altered(drawn, all, Eigen::VectorXd::Constant(1, 1e-3));
}

double largest_difference(const Pattern& a, const Pattern& b) {
    REQUIRE(a.panels.size() == b.panels.size());
    double most = 0;
    for (std::size_t p = 0; p < a.panels.size(); ++p) {
        const Panel &pa = a.panels[p], &pb = b.panels[p];
        for (std::size_t e = 0; e < pa.outline.size(); ++e)
            for (const double u : {0.0, 0.3, 0.7}) { // in space, since files may shift a panel's origin
                const Vec2 x = point_at(pa.outline[e], u), y = point_at(pb.outline[e], u);
                most = std::max(most, (pa.placement.rotation * Vec3(x.x(), x.y(), 0) + pa.placement.translation -
                                       pb.placement.rotation * Vec3(y.x(), y.y(), 0) - pb.placement.translation)
                                          .norm());
            }
    }
    return most;
}

void check_written(const std::string& path) {
    INFO(path);
    const Pattern drawn = read_pattern(path), now = shaken(drawn);
    const TempFolder folder;
    const std::string copy = folder / "a.json";
    write_file(copy, altered_pattern_text(path, drawn, now));
    CHECK(largest_difference(read_pattern(copy), now) < 1e-9);
    CHECK(largest_difference(drawn, now) > 5e-4);
    write_file(copy, altered_pattern_text(path, drawn, drawn));
    CHECK(largest_difference(read_pattern(copy), drawn) < 1e-15);
}

} // namespace

TEST_CASE("an altered pattern is read back as it was altered") {
    for (const char* name : {"skirt", "tee", "dress", "hooded_top"})
        check_written(TOILE_SOURCE_DIR "/examples/" + std::string(name) + ".json");
    for (const char* name : {"garmentcode/tshirt_specification.json", "garmentcode/pencil_skirt_specification.json",
                             "garmentcode_2021/tee.json", "garmentcode_2021/skirt_4_panels.json"})
        if (const auto file = test_data(name)) check_written(*file);
}

TEST_CASE("the picture and the table have the panels that differ") {
    const Pattern drawn = read_pattern(TOILE_SOURCE_DIR "/examples/skirt.json");
    const Pattern now = altered(drawn, {{"hem", lengthen_edge(drawn, 0, 0), -1, 1}}, Eigen::VectorXd::Constant(1, 0.01));
    const std::string svg = altered_svg(drawn, now);
    CHECK(svg.find(">front<") != std::string::npos);
    CHECK(svg.find(">back<") == std::string::npos);
    const std::vector<EdgeChange> changes = edge_changes(drawn, now);
    REQUIRE(changes.size() == 2); // the edge that is longer, and its neighbour, whose start goes along
    CHECK(changes[0].edge == 0);
    CHECK(changes[0].moved == Approx(0.01));
    CHECK(changes[0].after > changes[0].before + 0.009);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/text.h"
#include "io/companion.h"
#include "io/read_pattern.h"
#include "io/write_altered.h"
#include "io/write_file.h"
#include "patterns/alter.h"
#include "patterns/curve.h"
#include "patterns/shrink.h"
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

TEST_CASE("altered rest lengths are read back from the companion file, all else as it was") {
    const TempFolder folder;
    const std::string path = folder / "a.json", companion = companion_path(path), copy = folder / "b.json";
    const std::string skirt = read_file(TOILE_SOURCE_DIR "/examples/skirt.json", 1 << 20);
    write_file(path, skirt);
    write_file(copy, skirt);
    const auto written = [&](const std::string& said, const auto& alter) {
        if (said.empty())
            std::filesystem::remove(companion);
        else
            write_file(companion, said);
        Pattern drawn = read_pattern(path), now = drawn;
        alter(now);
        const std::string text = altered_companion_text(companion, drawn, now);
        write_file(companion_path(copy), text);
        const Pattern back = read_pattern(copy);
        CHECK(back.fabric == now.fabric);
        REQUIRE(back.elastics.size() == now.elastics.size());
        for (std::size_t e = 0; e < now.elastics.size(); ++e) {
            const Elastic &a = back.elastics[e], &b = now.elastics[e];
            CHECK(std::array{a.ratio, a.stiffness, a.span.t0, a.span.t1} == std::array{b.ratio, b.stiffness, b.span.t0, b.span.t1});
            CHECK(std::array{a.span.panel, a.span.edge} == std::array{b.span.panel, b.span.edge});
        }
        for (std::size_t p = 0; p < now.panels.size(); ++p) CHECK(back.panels[p].shrink == now.panels[p].shrink);
        return text;
    };
    const std::string banded = R"({"toile": 1, "fabric": "wool", "panels": {"back": {"grain": 80}}, "elastics": [
        {"panel": "back", "edge": 0, "ratio": 0.9, "from": 0.25, "to": 0.75}, {"label": "lower_interface", "ratio": 0.8, "stiffness": 30}]})";
    CHECK(written(banded, [](Pattern&) {}) == banded);
    // One that was put in has no item yet.
    CHECK(written("", [](Pattern&) {}).find("elastics") == std::string::npos);
    // An item of a label stays one as long as its elastics have one ratio.
    CHECK(written(banded, [](Pattern& p) { for (Elastic& e : p.elastics) e.ratio -= 0.1; }).find("label") != std::string::npos);
    CHECK(written(banded, [](Pattern& p) { p.elastics[2].ratio = 0.123456789; }).find("label") == std::string::npos);
    written(banded, [](Pattern& p) { p.panels[0].shrink = {0.01, -0.02}, p.panels[1].shrink.y() = 0.3; });
    CHECK(written("", [](Pattern& p) { p.panels[0].shrink.y() = 0.04; }).find("\"warp\": 0.04") != std::string::npos);
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

TEST_CASE("the picture says what outlines do not show: bands are dotted, lengths at rest written") {
    const std::string path = TOILE_SOURCE_DIR "/examples/skirt.json";
    Pattern drawn = read_pattern(path);
    drawn.elastics = {{{1, 3, 0, 1}, 0.8, 30}};
    CHECK(altered_svg(drawn, drawn).find("band\" d") == std::string::npos); // nothing has changed
    Pattern now = drawn;
    now.elastics[0].ratio = 0.7;
    now.panels[0].shrink.y() = 0.03;
    const std::string svg = altered_svg(drawn, now);
    CHECK(svg.find("class=\"band\"") != std::string::npos);
    const double cloth = length_at_rest(drawn, drawn.elastics[0].span);
    CHECK(svg.find(text("elastic on edge 3: %.1f mm relaxed, was %.1f", 700 * cloth, 800 * cloth)) != std::string::npos);
    CHECK(svg.find("after it is cut shrunk by 3 % along the warp, was not") != std::string::npos);
    const std::vector<ElasticChange> changes = elastic_changes(drawn, now);
    REQUIRE(changes.size() == 1);
    CHECK(changes[0].after - changes[0].before == Approx(-0.1 * cloth));
}

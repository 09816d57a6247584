// SPDX-License-Identifier: GPL-3.0-or-later
// The garments in examples/ are cut well and start clean round the built-in form.
#include "geometry/bvh.h"
#include "geometry/distance.h"
#include "geometry/intersections.h"
#include "io/read_pattern.h"
#include "patterns/check.h"
#include "sewing/arrange.h"
#include "sewing/form.h"
#include "tests/support/temp_folder.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <fstream>
#include <limits>
#include <set>
#include <sstream>

using namespace toile;

namespace {

constexpr const char* names[] = {"tee",        "skirt",           "trousers",        "dress",
                                 "hooded_top", "two_layer_skirt", "pleated_skirt",   "shirt_and_jacket"};
const std::string folder = std::string(TOILE_SOURCE_DIR) + "/examples/";

std::string contents(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

/// Smallest distance of the points from the body.
double nearest(const Points& points, const TriMesh& body) {
    const Bvh tree(triangle_boxes(body.points, body.triangles, 0));
    double squared = std::numeric_limits<double>::infinity();
    for (const Vec3& p : points)
        tree.nearest(p, squared, [&](int t) {
            const Triangle& c = body.triangles[t];
            return nearest_point_triangle(p, body.points[c[0]], body.points[c[1]], body.points[c[2]]).squared;
        });
    return std::sqrt(squared);
}

} // namespace

TEST_CASE("the examples are cut without a fault", "[examples]") {
    for (const char* name : names) {
        INFO(name);
        const Pattern pattern = read_pattern(folder + name + ".json");
        for (const Issue& issue : check(pattern)) {
            INFO(issue.text);
            CHECK(issue.severity == Severity::note);
        }
        for (const Seam& seam : pattern.seams) {
            INFO(seam.name);
            CHECK(seam_lengths(pattern, seam).ease < 0.01);
        }
        CHECK_FALSE(pattern.fabric.empty());
        std::set<std::string> labels;
        for (const Panel& panel : pattern.panels)
            for (const Edge& edge : panel.outline) labels.insert(edge.label);
        CHECK(labels.count("left_collar") + labels.count("lower_interface") >= 1);
    }
}

TEST_CASE("the examples start clear of the form and of themselves", "[examples]") {
    const TriMesh form = make_form({});
    for (const char* name : names) {
        INFO(name);
        const Pattern pattern = read_pattern(folder + name + ".json");
        TriangulateOptions options;
        options.edge_length = 0.02;
        const FlatPattern flat = triangulate(pattern, options);
        const TriMesh cloth{place(pattern, flat.levels.back()), flat.levels.back().triangles};
        CHECK(intersecting_pairs(cloth, form).empty());
        CHECK(self_intersecting_pairs(cloth).empty());
        CHECK(nearest(cloth.points, form) > 0.012);
    }
}

TEST_CASE("the examples are what the script drafts", "[examples]") {
    if (std::system("python3 --version > /dev/null 2>&1") != 0) {
        WARN("skipped: there is no python3");
        return;
    }
    const test::TempFolder drafted;
    const std::string script = std::string(TOILE_SOURCE_DIR) + "/scripts/make_examples.py";
    REQUIRE(std::system(("python3 '" + script + "' --out '" + drafted.path() + "'").c_str()) == 0);
    for (const char* name : names)
        for (const char* ending : {".json", ".toile.json"}) {
            INFO(name << ending);
            CHECK(contents(drafted / (std::string(name) + ending)) == contents(folder + name + ending));
        }
}

TEST_CASE("the examples can be cut for another body", "[examples]") {
    if (std::system("python3 --version > /dev/null 2>&1") != 0) {
        WARN("skipped: there is no python3");
        return;
    }
    const test::TempFolder drafted;
    std::ofstream(drafted / "body.json") << R"({"bust": 110, "waist": 95, "hip": 115, "waist_y": 110, "hip_y": 86})";
    const std::string script = std::string(TOILE_SOURCE_DIR) + "/scripts/make_examples.py";
    REQUIRE(std::system(("python3 '" + script + "' --body '" + (drafted / "body.json") + "' --out '" + drafted.path() + "'")
                            .c_str()) == 0);
    for (const char* name : names) {
        INFO(name);
        const Pattern pattern = read_pattern(drafted / (std::string(name) + ".json"));
        for (const Issue& issue : check(pattern)) {
            INFO(issue.text);
            CHECK(issue.severity == Severity::note);
        }
        for (const Seam& seam : pattern.seams) CHECK(seam_lengths(pattern, seam).ease < 0.015);
    }
}

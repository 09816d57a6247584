// SPDX-License-Identifier: GPL-3.0-or-later
// Cloth in places that let other tools' contact fail: on points and edges, through a ring, in heaps, wrung.
#include "draping/decisions.h"
#include "tests/support/cloth_scene.h"
#include "tests/support/shapes.h"
#include "tests/support/sound_drape.h"
#include "tests/support/temp_folder.h"

#include <catch2/catch.hpp>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <numbers>

using namespace toile;
using namespace toile::test;

namespace {

constexpr double pi = std::numbers::pi;

TriMesh joined(TriMesh a, const TriMesh& b) {
    const int first = int(a.points.size());
    a.points.insert(a.points.end(), b.points.begin(), b.points.end());
    for (const Triangle& t : b.triangles) a.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    return a;
}

TriMesh floor_at(double y) { return box(Vec3(-1, y - 0.1, -1), Vec3(1, y, 1)); }

/// Upright, from its base about the origin to a point at `height`.
TriMesh spike(double radius, double height, int around) {
    TriMesh m;
    for (int i = 0; i < around; ++i)
        m.points.push_back({radius * std::cos(2 * pi * i / around), 0, -radius * std::sin(2 * pi * i / around)});
    m.points.push_back({0, height, 0});
    m.points.push_back({0, 0, 0});
    for (int i = 0; i < around; ++i) {
        m.triangles.push_back({i, (i + 1) % around, around});
        m.triangles.push_back({(i + 1) % around, i, around + 1});
    }
    return m;
}

/// A torus about the y axis at the origin.
TriMesh ring(double radius, double thickness, int around, int across) {
    TriMesh m;
    for (int i = 0; i < around; ++i)
        for (int j = 0; j < across; ++j) {
            const double a = 2 * pi * i / around, b = 2 * pi * j / across;
            const double r = radius + thickness * std::cos(b);
            m.points.push_back({r * std::cos(a), thickness * std::sin(b), r * std::sin(a)});
        }
    const auto at = [&](int i, int j) { return (i % around) * across + j % across; };
    for (int i = 0; i < around; ++i)
        for (int j = 0; j < across; ++j) {
            m.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j)});
            m.triangles.push_back({at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)});
        }
    return m;
}

/// A flat mesh laid level at height y, its middle at (at.x, at.y) in x and z, turned about the upright.
Points level(const FlatMesh& mesh, double y, double turn = 0, const Vec2& at = Vec2::Zero()) {
    Vec2 middle = Vec2::Zero();
    for (const Vec2& p : mesh.points) middle += p / double(mesh.points.size());
    Points x;
    for (const Vec2& p : mesh.points) {
        const Vec2 q = Eigen::Rotation2Dd(turn) * (p - middle) + at;
        x.push_back({q.x(), y, -q.y()});
    }
    return x;
}

int node_nearest(const Points& x, const Vec3& p) {
    int best = 0;
    for (int i = 1; i < int(x.size()); ++i)
        if ((x[i] - p).squaredNorm() < (x[best] - p).squaredNorm()) best = i;
    return best;
}

using nlohmann::json;

/// A rectangle, cm, its lower edge (0) at height `y` and as far in front as `z`, or behind.
json rectangle(double width, double height, double y, double z) {
    json panel = {{"vertices", {{-width / 2, 0}, {width / 2, 0}, {width / 2, height}, {-width / 2, height}}},
                  {"edges",
                   {{{"endpoints", {0, 1}}}, {{"endpoints", {1, 2}}}, {{"endpoints", {2, 3}}}, {{"endpoints", {3, 0}}}}}};
    panel["translation"] = {0, y, z};
    panel["rotation"] = {0, z < 0 ? 180 : 0, 0};
    return panel;
}

json seam(const std::string& a, int edge_a, const std::string& b, int edge_b) {
    const auto end = [](const std::string& panel, int edge) { return json{{"panel", panel}, {"edge", edge}}; };
    return json::array({end(a, edge_a), end(b, edge_b)});
}

/// Front and back of a tube, sewn at both sides.
void add_tube(json& pattern, const std::string& name, double width, double height, double y, double z) {
    pattern["panels"][name + "_front"] = rectangle(width, height, y, z);
    pattern["panels"][name + "_back"] = rectangle(width, height, y, -z);
    pattern["stitches"].push_back(seam(name + "_front", 1, name + "_back", 3));
    pattern["stitches"].push_back(seam(name + "_front", 3, name + "_back", 1));
}

std::string write_pattern(const TempFolder& folder, const json& pattern) {
    const std::string path = folder / "skirt.json";
    std::ofstream(path) << json{
        {"pattern", pattern},
        {"properties", {{"units_in_meter", 100}, {"curvature_coords", "relative"}, {"normalized_edge_loops", true}}}};
    return path;
}

} // namespace

TEST_CASE("cloth that falls on a spike or a needle is not pierced", "[hard]") {
    const Fabric& fabric = fabric_preset("poplin");
    for (const auto& [radius, height, around] : {std::tuple{0.05, 0.15, 12}, {0.5e-3, 0.15, 6}}) {
        INFO("radius " << radius);
        const FlatMesh sheet = jittered_rectangle(0.24, 0.24, 0.015, 0.25, 3);
        ClothScene s(garment_of(sheet), joined(spike(radius, height, around), floor_at(-0.002)),
                     level(sheet, height + 0.02, 0, Vec2(0.004, 0.003)), fabric, {0.3});
        const bool settled = s.settle_to(1e-3, 1500);
            CHECK(settled);
        CHECK(s.crossings() == 0);
        CHECK(s.lowest() > -0.002);
    }
}

TEST_CASE("cloth that falls on the edge of a cube hangs over it", "[hard]") {
    TriMesh cube = box(Vec3(-0.1, -0.1, -0.1), Vec3(0.1, 0.1, 0.1));
    const Mat3 turn = Eigen::AngleAxisd(pi / 4, Vec3::UnitZ()).toRotationMatrix();
    for (Vec3& p : cube.points) p = turn * p;
    const FlatMesh sheet = jittered_rectangle(0.3, 0.24, 0.015, 0.25, 5);
    ClothScene s(garment_of(sheet), joined(cube, floor_at(-0.3)), level(sheet, 0.16, 0.3), fabric_preset("linen"), {0.3});
    CHECK(s.settle_to(1e-3, 1500));
    CHECK(s.crossings() == 0);
    CHECK(s.highest() > 0.1 * std::sqrt(2));
    CHECK(s.lowest() < 0.1);
}

TEST_CASE("a square is pulled through a ring", "[hard]") {
    const FlatMesh sheet = jittered_rectangle(0.2, 0.2, 0.0125, 0.25, 7);
    const Fabric& fabric = fabric_preset("silk");
    ClothScene s(garment_of(sheet), ring(0.04, 0.006, 24, 8), level(sheet, 0.008), fabric, {0.2});
    HookSpring pull;
    pull.node = node_nearest(s.x, Vec3(0, 0.008, 0));
    pull.stiffness = 300;
    pull.cap = 3;
    pull.place = s.x[pull.node];
    const double down = 0.3, stride = 0.01;
    for (double gone = 0; gone < down && s.highest() > -0.02; gone += stride) {
        pull.place.y() -= stride;
        s.problem->hooks = {pull};
        s.settle_to(1, 30);
    }
    CHECK(s.crossings() == 0);
    CHECK(s.highest() < 0);
    CHECK(s.settle_to(1e-3, 1500));
    CHECK(s.crossings() == 0);
}

TEST_CASE("ten sheets fall on a plane and lie on each other", "[hard]") {
    const FlatMesh sheet = jittered_rectangle(0.12, 0.12, 0.02, 0.25, 11);
    FlatMesh all;
    Points x;
    for (int k = 0; k < 10; ++k) {
        add_sheet(all, sheet, 0.2 * k);
        const Points one = level(sheet, 0.005 + 0.005 * k, 0.35 * k);
        x.insert(x.end(), one.begin(), one.end());
    }
    ClothScene s(garment_of(all), floor_at(0), x, fabric_preset("poplin"), {0.3, 0.3});
    CHECK(s.settle_to(1e-3, 200));
    CHECK(s.crossings() == 0);
    CHECK(s.highest() < 0.01);
    CHECK(s.lowest() > 0);
    CHECK(count_touching(s.problem->contact(), s.x).cloth_pairs > 1000);
}

TEST_CASE("a strip is wrung by four turns", "[hard]") {
    constexpr double width = 0.06, length = 0.4;
    const FlatMesh sheet = jittered_rectangle(width, length, 0.01, 0.2, 13);
    Points x;
    for (const Vec2& p : sheet.points) x.push_back({p.x() - width / 2, p.y(), 0});
    ClothScene s(garment_of(sheet), TriMesh{}, x, fabric_preset("jersey"), {0});
    s.problem->gravity = 0;
    const Points start = s.x;
    // Both ends turn, the lower one in its place, the upper one pulled up by 1.4 N in all.
    const auto hold = [&](double angle) {
        s.problem->hooks.clear();
        for (int i = 0; i < s.garment.node_count; ++i) {
            const bool top = start[i].y() == length;
            if (!top && start[i].y() != 0) continue;
            const Mat3 turn = Eigen::AngleAxisd(top ? angle / 2 : -angle / 2, Vec3::UnitY()).toRotationMatrix();
            s.problem->hooks.push_back({i, turn * start[i], Vec3(1, top ? 0 : 1, 1), 500, 5});
            if (top) s.problem->hooks.push_back({i, start[i] + Vec3(0, 10, 0), Vec3(0, 1, 0), 1, 0.2});
        }
    };
    constexpr int steps = 288;
    for (int k = 1; k <= steps; ++k) {
        hold(8 * pi * k / steps);
        s.settle_to(30, 15);
    }
    CHECK(s.crossings() == 0);
    CHECK(s.settle_to(1e-2, 1500));
    CHECK(s.crossings() == 0);
    CHECK(count_touching(s.problem->contact(), s.x).cloth_pairs > 100);
}

TEST_CASE("a skirt with a ruffle of 2.2 times its width", "[hard]") {
    const TempFolder folder;
    json pattern;
    add_tube(pattern, "skirt", 50, 30, 65, 22);
    add_tube(pattern, "ruffle", 110, 10, 50, 22);
    pattern["panels"]["skirt_front"]["edges"][2]["label"] = "lower_interface";
    pattern["panels"]["skirt_back"]["edges"][2]["label"] = "lower_interface";
    pattern["stitches"].push_back(seam("skirt_front", 0, "ruffle_front", 2));
    pattern["stitches"].push_back(seam("skirt_back", 0, "ruffle_back", 2));
    DrapeJob job;
    job.pattern = write_pattern(folder, pattern);
    job.fabric = "silk";
    job.edge_length = 0.025;
    job.drape.hold = {"waist"};
    job.garments = {folder / "a.obj"};
    drape_soundly(job, job.fabric, 0.12, 0.5); // half of a ruffle's folds look inward
}

TEST_CASE("a skirt of two layers", "[hard]") {
    const TempFolder folder;
    json pattern;
    add_tube(pattern, "under", 52, 45, 55, 20);
    add_tube(pattern, "over", 58, 50, 50, 26);
    for (const char* name : {"under_front", "under_back", "over_front", "over_back"})
        pattern["panels"][name]["edges"][2]["label"] = "lower_interface";
    DrapeJob job;
    job.pattern = write_pattern(folder, pattern);
    std::ofstream(folder / "skirt.toile.json") << json{
        {"toile", 1},
        {"panels", {{"over_front", {{"layer", 1}}}, {"over_back", {{"layer", 1}}}}}};
    job.fabric = "linen";
    job.edge_length = 0.03;
    job.drape.hold = {"waist"};
    const DrapeOutcome drape = run_job(job);
    INFO(drape.result.where);
    CHECK(drape.result.status == DrapeStatus::converged);
    const Garment& g = drape.result.garment;
    const Points& x = drape.result.state.positions;
    const Inspection i = inspect(g, x, drape.body, PanelFabrics(g.panel_names.size(), fabric_preset(job.fabric)));
    CHECK(i.intersections.cloth_avatar == 0);
    CHECK(i.intersections.cloth_cloth == 0);
    CHECK(i.seam_gap_max == 0);
    CHECK(i.pieces == 2);
    // The outer layer is outside, seen from the upright through the middle.
    double inner = 0, outer = 0, inner_nodes = 0, outer_nodes = 0;
    for (std::size_t v = 0; v < g.uv.size(); ++v) {
        const Vec3& p = x[g.node_of_vertex[v]];
        const bool over = g.panel_layers[g.panel_of_vertex[v]] > 0;
        (over ? outer : inner) += std::hypot(p.x(), p.z());
        ++(over ? outer_nodes : inner_nodes);
    }
    CHECK(outer / outer_nodes > inner / inner_nodes);
}

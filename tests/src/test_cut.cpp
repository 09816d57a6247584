// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/edges.h"
#include "io/read_garment.h"
#include "io/write_file.h"
#include "tests/src/run.h"
#include "tests/support/obj_text.h"
#include "tests/support/surfaces.h"
#include "tests/support/temp_folder.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>

using namespace toile;
using namespace toile::test;
using Catch::Matchers::Contains;

namespace {

constexpr double radius = 0.25; // m, of the ball; it stands 1 m high
constexpr double lobes = 0.44;  // rad, half the width of a panel at its waist

TriMesh ball(double r) {
    TriMesh mesh = ellipsoid(Vec3(r, r, r), 60, 36);
    for (Vec3& p : mesh.points) p.y() += 1;
    return mesh;
}

/// A baseball's seam on the unit sphere (Thompson, Designing a Baseball Cover, 1998).
Points seam(int count) {
    Points points;
    for (int i = 0; i < count; ++i) {
        const double t = 4 * EIGEN_PI * i / count, a = EIGEN_PI / 2 - (EIGEN_PI / 2 - lobes) * std::cos(t), b = t / 2 + lobes * std::sin(2 * t);
        points.push_back({std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)});
    }
    return points;
}

std::string write_lines(const TempFolder& folder, const std::vector<nlohmann::json>& lines, const std::vector<nlohmann::json>& panels) {
    const std::string file = folder / "lines.json";
    write_file(file, nlohmann::json{{"toile_cut", 1}, {"units_in_meter", 1}, {"lines", lines}, {"panels", panels}}.dump());
    return file;
}

} // namespace

TEST_CASE("cut: a baseball of two flat panels, sewn on a ball, is strained by no less than any flat cloth must be") {
    const TempFolder folder;
    const std::string surface = folder / "surface.obj", body = folder / "ball.obj", pattern = folder / "cover.json";
    write_file(surface, obj_text(ball(radius + 0.002)));
    write_file(body, obj_text(ball(radius)));
    nlohmann::json points;
    for (const Vec3& p : seam(120)) points.push_back({radius * p.x(), 1 + radius * p.y(), radius * p.z()});
    const std::string lines = write_lines(folder, {{{"name", "seam"}, {"points", points}, {"closed", true}}},
                                          {{{"name", "one"}, {"inside", {0, 1, radius}}}, {{"name", "other"}, {"inside", {0, 1, -radius}}}});
    const Run cut = run_toile({"cut", surface, "--lines", lines, "-o", pattern, "--surface", folder / "cut.obj", "--json"});
    CAPTURE(cut.err);
    REQUIRE(cut.code == 0);
    const auto report = nlohmann::json::parse(cut.out);
    REQUIRE(report["panels"].size() == 2);
    const double whole = 4 * EIGEN_PI * (radius + 0.002) * (radius + 0.002);
    for (const auto& p : report["panels"]) {
        CHECK(p["area"].get<double>() == Approx(whole / 2).epsilon(0.01));
        CHECK(p["settled"] == true);
        CHECK(p["strain_mean"].get<double>() < 0.08);
        REQUIRE(p["would_take"].size() == 1);
        CHECK(p["would_take"][0]["kind"] == "dart");
        CHECK(p["would_take"][0]["degrees"].get<double>() == Approx(360).epsilon(0.05)); // half of a sphere
    }
    for (const auto& s : report["seams"]) {
        CHECK(std::abs(s["length_a"].get<double>() - s["length_b"].get<double>()) < 3e-4);
    }
    const ReadGarment pieces = read_garment(folder / "cut.obj");
    const EdgeTable edges = make_edges(node_triangles(pieces.garment), pieces.garment.node_count);
    double length = 0; // of both sides
    for (int e = 0; e < edges.size(); ++e)
        if (edges.triangles_at(e) == 1) length += (pieces.x[edges.ends[e][0]] - pieces.x[edges.ends[e][1]]).norm();
    CHECK(length == Approx(2 * 11.0702 * (radius + 0.002)).epsilon(0.02));

    const Run run = run_toile({"drape", pattern, "--avatar", body, "--fabric", "jersey", "--edge-length", "30mm", "-o", folder / "out.obj", "--report", folder / "r.json"});
    CAPTURE(run.err);
    REQUIRE(run.code == 0);
    const auto strain = nlohmann::json::parse(read_file(folder / "r.json", 1 << 20))["strain"]["principal"];
    // The largest cap within a panel, of angle alpha: no map to the plane has less than log(alpha / sin alpha) between its
    // largest and its least stretch (Milnor, A Problem in Cartography, 1969).
    double alpha = 0;
    const Points line = seam(400);
    for (const Vec3& p : ellipsoid(Vec3(1, 1, 1), 60, 36).points) {
        double nearest = EIGEN_PI;
        for (const Vec3& q : line) nearest = std::min(nearest, std::acos(std::clamp(p.normalized().dot(q), -1.0, 1.0)));
        alpha = std::max(alpha, nearest);
    }
    const double range = std::log((1 + strain["max"].get<double>()) / (1 + strain["min"].get<double>()));
    CHECK(range > std::log(alpha / std::sin(alpha)));
    CHECK(range < 3 * std::log(alpha / std::sin(alpha)));
}

TEST_CASE("cut: a dart is advised for a dome and a gusset for the foot that it stands on, each by its curvature") {
    const TempFolder folder;
    TriMesh sheet; // a bell 0.1 m high on a plane: its dome and its foot cancel
    const int side = 80;
    const double width = 0.08, height = 0.1; // m
    for (int i = 0; i <= side; ++i)
        for (int k = 0; k <= side; ++k) {
            const double x = 0.6 * (double(i) / side - 0.5), z = 0.6 * (double(k) / side - 0.5);
            sheet.points.push_back({x, height * std::exp(-0.5 * (x * x + z * z) / (width * width)), z});
        }
    for (int i = 0; i < side; ++i)
        for (int k = 0; k < side; ++k) {
            const int a = i * (side + 1) + k, b = a + side + 1;
            sheet.triangles.push_back({a, a + 1, b + 1});
            sheet.triangles.push_back({a, b + 1, b});
        }
    write_file(folder / "bell.obj", obj_text(sheet));
    const std::string lines = write_lines(folder, {{{"name", "edge"}, {"plane", {{"point", {0.28, 0, 0}}, {"normal", {1, 0, 0}}}}}},
                                          {{{"name", "bell"}, {"inside", {0, 0.1, 0}}}});
    const Run run = run_toile({"cut", folder / "bell.obj", "--lines", lines, "-o", folder / "out.json", "--json"});
    CAPTURE(run.err);
    REQUIRE(run.code == 0);
    const auto found = nlohmann::json::parse(run.out)["panels"][0]["would_take"];
    REQUIRE(found.size() == 2);
    // Within the circle of the steepest slope, by Gauss and Bonnet: 360 degrees less the cosine of that slope's angle times as much.
    const double slope = height / width * std::exp(-0.5), degrees = 360 * (1 - 1 / std::hypot(1, slope));
    for (const auto& f : found) {
        const double sign = f["kind"] == "dart" ? 1 : -1;
        CHECK(f["degrees"].get<double>() == Approx(sign * degrees).epsilon(0.1));
        if (sign > 0) CHECK(std::hypot(f["point"][0].get<double>(), f["point"][2].get<double>()) < 0.02);
    }
    CHECK(found[0]["kind"] != found[1]["kind"]);
}

TEST_CASE("cut: lines and panels that cannot be used are refused in a sentence, and nothing is written") {
    const TempFolder folder;
    const std::string surface = folder / "ball.obj", out = folder / "out.json";
    write_file(surface, obj_text(ball(radius)));
    const nlohmann::json top{{"name", "top"}, {"plane", {{"point", {0, 1.1, 0}}, {"normal", {0, 1, 0}}}}};
    const nlohmann::json cap{{"name", "cap"}, {"inside", {0, 1.3, 0}}}, rest{{"name", "rest"}, {"inside", {0, 0.7, 0}}};
    const auto refusal = [&](const std::vector<nlohmann::json>& lines, const std::vector<nlohmann::json>& panels) {
        const Run r = run_toile({"cut", surface, "--lines", write_lines(folder, lines, panels), "-o", out});
        CHECK(r.code == 2);
        CHECK_FALSE(std::filesystem::exists(out));
        return r.err;
    };
    CHECK_THAT(refusal({{{"name", "far"}, {"plane", {{"point", {0, 3, 0}}, {"normal", {0, 1, 0}}}}}}, {cap}),
               Contains("line \"far\" does not meet the surface"));
    CHECK_THAT(refusal({{{"name", "flat"}, {"plane", {{"point", {0, 1, 0}}, {"normal", {0, 0, 0}}}}}}, {cap}), Contains("a direction"));
    CHECK_THAT(refusal({{{"name", "both"}, {"points", {{0, 1, 0}, {1, 1, 0}}}, {"plane", top["plane"]}}}, {cap}), Contains("either \"points\" or \"plane\""));
    CHECK_THAT(refusal({{{"name", "dot"}, {"points", {{0, 1.25, 0}, {0, 1.25, 0}}}}}, {cap}), Contains("line \"dot\"") && Contains("one point of the surface"));
    CHECK_THAT(refusal({{{"name", "through"}, {"points", {{0, 1.25, 0}, {0, 0.75, 0}}}}}, {cap}), Contains("line \"through\"") && Contains("no way along the surface"));
    CHECK_THAT(refusal({top}, {cap, {{"name", "same"}, {"inside", {0.05, 1.3, 0}}}}), Contains("\"cap\" and \"same\" lie in one piece"));
    CHECK_THAT(refusal({top}, {cap, cap}), Contains("a name that no other panel has"));
    CHECK_THAT(refusal({top, {{"name", "low"}, {"plane", {{"point", {0, 0.9, 0}}, {"normal", {0, 1, 0}}}}}}, {{{"name", "belt"}, {"inside", {0, 1, 1}}}}),
               Contains("\"belt\" cannot be flattened: it has a hole"));
    CHECK_THAT(refusal({}, {cap}), Contains("lines"));
    CHECK(run_toile({"cut", surface, "--lines", write_lines(folder, {top}, {cap, rest}), "-o", out, "--report", folder / "r.json"}).code == 0);
    CHECK(run_toile({"cut", surface, "--lines", folder / "none.json", "-o", out}).code == 2);
    CHECK(run_toile({"cut", surface, "--lines", folder / "lines.json", "-o", folder / "out.txt"}).code == 1);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Panels that are not flat at rest, from file to drape.
#include "draping/cloth.h"
#include "draping/rest/consistency.h"
#include "io/read_garment.h"
#include "io/read_pattern.h"
#include "io/write_file.h"
#include "src/drape_input.h"
#include "tests/src/run.h"
#include "tests/support/curved_cloth.h"
#include "tests/support/obj_text.h"
#include "tests/support/surfaces.h"
#include "tests/support/temp_folder.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace toile;
using namespace toile::test;
using Catch::Matchers::Contains;

namespace {

constexpr double radius = 0.115; // m, of the crown
constexpr int rings = 10;

/// Half a sphere whose rim starts at +x and runs by -z.
TriMesh dome() {
    const FlatMesh flat = disc(rings, 0, 1);
    TriMesh mesh{{}, flat.triangles};
    for (const Vec2& p : flat.points) {
        const double r = p.norm(), angle = EIGEN_PI / 2 * r;
        const Vec2 out = r > 0 ? Vec2(std::sin(angle) / r * p) : Vec2(Vec2::Zero());
        mesh.points.push_back(radius * Vec3(out.x(), std::cos(angle), -out.y()));
    }
    return mesh;
}

const nlohmann::json properties{{"units_in_meter", 100}, {"curvature_coords", "relative"}, {"normalized_edge_loops", true}};

/// A moulded crown sewn to a flat band in two parts; returns the pattern's file.
std::string hat(const TempFolder& folder) {
    const TriMesh crown = dome();
    const int first = int(crown.points.size()) - 6 * rings + 1, half = first + 3 * rings;
    write_file(folder / "crown.obj", obj_text(crown));
    const double w = 100 * 6 * rings * radius * std::sin(EIGEN_PI / (6 * rings)), h = 5;
    const auto strip = [&](double z, double turn) {
        nlohmann::json panel{{"translation", {0, 149, z}}, {"rotation", {0, turn, 0}}, {"edges", nlohmann::json::array()}};
        panel["vertices"] = {{-w / 2, -h}, {w / 2, -h}, {w / 2, 0}, {-w / 2, 0}};
        for (int e = 0; e < 4; ++e) panel["edges"].push_back({{"endpoints", {e, (e + 1) % 4}}});
        return panel;
    };
    nlohmann::json pattern{{"properties", properties}}, companion{{"toile", 1}};
    pattern["pattern"]["panels"] = {{"front", strip(14, 0)}, {"back", strip(-14, 180)}};
    pattern["pattern"]["stitches"] = {{{{"panel", "front"}, {"edge", 1}}, {{"panel", "back"}, {"edge", 3}}},
                                      {{{"panel", "front"}, {"edge", 3}}, {{"panel", "back"}, {"edge", 1}}}};
    companion["panels"]["crown"] = {{"rest_mesh", "crown.obj"},
                                    {"edges", {{{"from", first}, {"to", half}}, {{"from", half}, {"to", first}}}},
                                    {"translation", {0, 150, 0}}};
    const auto seam = [&](const char* panel, int edge) {
        return nlohmann::json{{"a", {{"panel", panel}, {"edge", 2}}},
                              {"b", {{"panel", "crown"}, {"edge", edge}, {"from", 1}, {"to", 0}}}};
    };
    companion["seams"] = {seam("front", 1), seam("back", 0)};
    write_file(folder / "hat.json", pattern.dump());
    write_file(folder / "hat.toile.json", companion.dump());
    return folder / "hat.json";
}

/// A head without a face.
std::string head(const TempFolder& folder) {
    TriMesh body = ellipsoid(Vec3(0.11, 0.11, 0.11), 32, 20);
    for (Vec3& p : body.points) p.y() = 1.5 + (p.y() > 0 ? 1 : 3.5) * p.y();
    write_file(folder / "head.obj", obj_text(body));
    return folder / "head.obj";
}

} // namespace

TEST_CASE("a moulded crown is sewn to a flat band, sample opposite point, and keeps its shape on a head") {
    const TempFolder folder;
    const std::string pattern = hat(folder), out = folder / "out.obj";
    const Run run = run_toile({"drape", pattern, "--avatar", head(folder), "--edge-length", "20mm", "-o", out, "--report", folder / "r.json"});
    CAPTURE(run.err);
    REQUIRE(run.code == 0);
    const auto report = nlohmann::json::parse(read_file(folder / "r.json", 1 << 20));
    CHECK(report["seam_gap_max"] == 0.0);
    CHECK(report["intersections"]["cloth_avatar"] == 0);
    CHECK(report["warnings"].empty());
    CHECK(report["strain"]["principal"]["max"] < 0.01);
    const ReadGarment garment = read_garment(out);
    double low = 10, high = 0; // m: radii of the crown about the middle of the sphere that its top lies on
    const auto& names = garment.garment.panel_names;
    const int crown = int(std::find(names.begin(), names.end(), "crown") - names.begin());
    double top = 0;
    for (const Vec3& p : garment.x) top = std::max(top, p.y());
    for (std::size_t v = 0; v < garment.garment.uv.size(); ++v) {
        if (garment.garment.panel_of_vertex[v] != crown) continue;
        const double r = (garment.x[garment.garment.node_of_vertex[v]] - Vec3(0, top - radius, 0)).norm();
        low = std::min(low, r), high = std::max(high, r);
    }
    CHECK(low > 0.97 * radius);
    CHECK(high < 1.03 * radius);
}

TEST_CASE("who cannot take a rest mesh says so") {
    const TempFolder folder;
    const std::string pattern = hat(folder), body = head(folder), out = folder / "out.obj";
    const Run yarns = run_toile({"drape", pattern, "--avatar", body, "--method", "inextensible", "-o", out});
    CHECK(yarns.code == 2);
    CHECK_THAT(yarns.err, Contains("panel crown keeps the triangles of") && Contains("--method"));
    const Run flat = run_toile({"flat", pattern, "-o", folder / "hat.svg"});
    CHECK(flat.code == 2);
    CHECK_THAT(flat.err, Contains("panel \"crown\" has a rest mesh"));
    const Run again = run_toile({"drape", pattern, "--avatar", body, "--from", body, "-o", out});
    CHECK(again.code == 2);
    CHECK_THAT(again.err, Contains("panel crown has a rest mesh"));
    write_file(folder / "fit.json", "{}");
    const Run fit = run_toile({"fit", pattern, "--avatar", body, "--spec", folder / "fit.json", "-o", folder / "fitted.json"});
    CHECK(fit.code == 2);
    CHECK_THAT(fit.err, Contains("panel crown keeps the triangles of") && Contains("flat panels"));
    CHECK(run_toile({"check", pattern}).code == 0);

    std::string companion = read_file(folder / "hat.toile.json", 1 << 20);
    const std::string whole = "\"from\":1,\"panel\":\"crown\",\"to\":0";
    companion.replace(companion.find(whole), whole.size(), "\"from\":1,\"panel\":\"crown\",\"to\":0.013");
    write_file(folder / "hat.toile.json", companion);
    const Run between = run_toile({"drape", pattern, "--avatar", body, "-o", out});
    CHECK(between.code == 2);
    CHECK_THAT(between.err, Contains("has no point at 0.013") && Contains("crown"));
}

TEST_CASE("a ball without seams is a pattern of one panel, at rest as a sphere") {
    const TempFolder folder;
    const TriMesh ball = ellipsoid(Vec3(0.037, 0.037, 0.037), 24, 14);
    write_file(folder / "ball.obj", obj_text(ball));
    nlohmann::json empty{{"properties", properties}};
    empty["pattern"] = {{"panels", nlohmann::json::object()}, {"stitches", nlohmann::json::array()}};
    write_file(folder / "baseball.json", empty.dump());
    write_file(folder / "baseball.toile.json", R"({"toile": 1, "panels": {"ball": {"rest_mesh": "ball.obj"}}})");
    const Pattern pattern = read_pattern(folder / "baseball.json");
    std::vector<std::string> warnings;
    sound_pattern(folder / "baseball.json", warnings);
    CHECK(warnings.empty());
    const DrapeInput input = input_of(pattern, "leather", 0.005);
    const StagedLevel& level = input.staging.levels.back();
    const Sheet sheet = make_sheet(level.garment, input.fabrics);
    double most = 0;
    for (const RestCurvature& c : sheet.curved) most += c.most;
    CHECK(most > 0);
    CHECK(std::abs(sheet_value(sheet, level.placed)) < 1e-10 * most); // nothing is frozen in

    const std::vector<double> defects = angle_defects(measured(ball.triangles, ball.points));
    double sum = 0;
    for (const double d : defects) sum += d;
    CHECK(sum == Approx(4 * EIGEN_PI).epsilon(1e-12));
}

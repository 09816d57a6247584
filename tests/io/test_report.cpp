// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/hash.h"
#include "io/report.h"
#include "tests/support/schema.h"
#include "tests/support/skirt.h"

#include <catch2/catch.hpp>

#include <nlohmann/json.hpp>

#include <limits>

using namespace toile;

namespace {

TriMesh tube(double radius, double low, double high) {
    const auto s = test::make_skirt(24, 1, radius, high, high - low);
    return {s.x, node_triangles(s.garment)};
}

DrapeResult result_of(const test::Skirt& skirt) {
    DrapeResult r;
    r.garment = skirt.garment;
    r.state.positions = skirt.x;
    r.status = DrapeStatus::converged;
    r.residual = 5e-4;
    r.tolerance = 1e-3;
    r.friction = {0.3, 0.25};
    r.barrier = {5e-4, 1e6};
    r.levels = {{0.02, 100, 20, 0, 5, 0.5}, {0.01, 400, 12, 7, 3, 0.7}};
    r.seconds = {{"sew", 0.5}, {"settle", 0.3}, {"settle", 0.4}};
    r.contact.seconds = 0.25;
    r.decisions = {"no contact of cloth with cloth: no two parts come within 3 mm"};
    r.landmarks = {{"left_collar", 1.39, 1.48, Belongs::neck, 0.02}, {"left_armhole", 1.33, 1.41}};
    r.warnings = {"second"};
    return r;
}

std::string complaints(const nlohmann::json& report) {
    static const test::Schema schema("report.schema.json");
    return schema.complaints(report.dump());
}

ReportContext context() {
    ReportContext c;
    Hash hash;
    hash.add("pattern");
    c.input_hash = hash.text();
    c.fabric = "poplin";
    c.blas = "OpenBLAS";
    c.threads = 2;
    c.total_seconds = 1.5;
    c.seconds = {{"read", 0.1}};
    c.decisions = {"the body was read in metres"};
    c.warnings = {"first"};
    c.body_measures.emplace();
    c.body_measures->bust_y = 1.3;
    c.body_measures->waist_y = 0.95;
    c.body_measures->hip_y = 0.8;
    return c;
}

} // namespace

TEST_CASE("a report is valid by the published schema and says what was measured") {
    const auto skirt = test::make_skirt(24, 8, 0.16, 1.0, 0.5);
    const auto r = make_report(result_of(skirt), tube(0.15, 0, 1.7), {}, context());
    CHECK(complaints(r) == "");
    CHECK(r["status"] == "converged");
    CHECK(r["seam_gap_max"] == 0.0);
    CHECK(r["intersections"]["cloth_avatar"] == 0);
    CHECK(r["clearance_min"].get<double>() == Approx(0.01 * std::cos(EIGEN_PI / 48)).epsilon(0.1));
    CHECK(r["ease"]["bust"].is_null());
    CHECK(r["ease"]["hip"]["ease"].get<double>() == Approx(2 * EIGEN_PI * 0.01).epsilon(0.02));
    CHECK(r["seconds"]["settle"].get<double>() == Approx(0.7));
    CHECK(r["seconds"]["total"] == 1.5);
    CHECK(r["seconds"]["contact"] == 0.25);
    CHECK(r["warnings"] == nlohmann::json{"first", "second"});
    CHECK(r["decisions"].size() == 2);
    CHECK(r["landmarks"][0]["belongs"] == "neck");
    CHECK(r["landmarks"][0]["off"] == 0.02);
    CHECK(r["landmarks"][1]["belongs"] == "anywhere");
    CHECK(r["landmarks"][1]["off"].is_null());
    CHECK(r["pieces"] == 1);
    CHECK(r["peak_memory_bytes"].get<double>() > 1e6);
}

TEST_CASE("what cannot be measured is null in a report, not an invalid number") {
    const auto skirt = test::make_skirt(6, 2, 0.16, 1.0, 0.5);
    DrapeResult result = result_of(skirt);
    result.residual = std::numeric_limits<double>::infinity();
    result.status = DrapeStatus::limit;
    ReportContext c = context();
    c.body_measures.reset();
    const std::string text = report_json(result, {}, {}, c);
    const auto r = nlohmann::json::parse(text);
    CHECK(complaints(r) == "");
    CHECK(r["residual"].is_null());
    CHECK(r["clearance_min"].is_null());
    CHECK(r["ease"]["hip"].is_null());
    CHECK(text.back() == '\n');
}

TEST_CASE("the schema refuses a report that lacks, adds or mistypes anything") {
    const auto skirt = test::make_skirt(6, 2, 0.16, 1.0, 0.5);
    const nlohmann::json good = make_report(result_of(skirt), tube(0.15, 0, 1.7), {}, context());
    for (const auto& [key, value] : good.items()) {
        nlohmann::json bad = good;
        bad.erase(key);
        CHECK(complaints(bad) != "");
        bad[key] = std::vector<int>{1};
        CHECK(complaints(bad) != "");
    }
    nlohmann::json bad = good;
    bad["extra"] = 1;
    CHECK(complaints(bad) != "");
    bad = good;
    bad["strain"]["warp"].erase("limit");
    CHECK(complaints(bad) != "");
    for (const char* key : {"belongs", "off"}) {
        bad = good;
        bad["landmarks"][0].erase(key);
        CHECK(complaints(bad) != "");
    }
    bad = good;
    bad["landmarks"][0]["belongs"] = "waist";
    CHECK(complaints(bad) != "");
}

TEST_CASE("the worse of double and float positions is reported when floats are written") {
    // A body so close that rounding the cloth to float pushes it through.
    auto skirt = test::make_skirt(16, 2, 0.1613, 1.0, 0.5);
    TriMesh body{skirt.x, node_triangles(skirt.garment)};
    for (Vec3& p : body.points)
        p = Vec3(p.x() * (1 + 1.5e-8), p.y(), p.z() * (1 + 1.5e-8));
    ReportContext c = context();
    const auto exact = make_report(result_of(skirt), body, {}, c);
    c.written_as_float = true;
    const auto rounded = make_report(result_of(skirt), body, {}, c);
    CHECK(exact["intersections"]["cloth_avatar"] < rounded["intersections"]["cloth_avatar"]);
}

TEST_CASE("the hash is FNV-1a and tells the smallest difference") {
    Hash hash;
    CHECK(hash.text() == "fnv1a64:cbf29ce484222325");
    hash.add("foobar");
    CHECK(hash.text() == "fnv1a64:85944171f73967e8");
    auto skirt = test::make_skirt(4, 2, 0.16, 1.0, 0.5);
    const std::string before = result_hash(skirt.garment, skirt.x);
    CHECK(before == result_hash(skirt.garment, skirt.x));
    skirt.x[3].x() = std::nextafter(skirt.x[3].x(), 1.0);
    CHECK(before != result_hash(skirt.garment, skirt.x));
}

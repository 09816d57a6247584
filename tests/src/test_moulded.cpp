// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_garment.h"
#include "io/write_file.h"
#include "tests/src/run.h"
#include "tests/support/curved_shells.h"
#include "tests/support/obj_text.h"
#include "tests/support/temp_folder.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>

using namespace toile;
using namespace toile::test;
using Catch::Matchers::Contains;

namespace {

constexpr int rings = 8;
constexpr double threshold = 5.087275721655189; // of shell theory, without lateral contraction

std::string cap_file(const TempFolder& folder) {
    const Cloth c = cap(rings, 1);
    const std::string file = folder / "cap.obj";
    write_file(file, obj_text({c.x, c.garment.triangles}));
    return file;
}

/// A fabric with which the cap has this slenderness.
std::string fabric_file(const TempFolder& folder, double lambda) {
    const double k = 1e4, d = k / (std::pow(lambda, 4) * cap_radius * cap_radius);
    const nlohmann::json fabric{{"toile_fabric", 1}, {"name", "shell"}, {"like", "poplin"}, {"stretch_warp", k}, {"stretch_weft", k},
                                {"poisson", 0}, {"shear", k / 2}, {"compression", 1}, {"density", 1}, {"bend_warp", d},
                                {"bend_weft", d}, {"bend_twist", d / 2}, {"bend_poisson", 0}};
    const std::string file = folder / "shell.json";
    write_file(file, fabric.dump());
    return file;
}

nlohmann::json states_of(const std::vector<std::string>& arguments) {
    const Run r = run_toile(arguments);
    CAPTURE(r.err);
    REQUIRE(r.code == 0);
    return nlohmann::json::parse(r.out)["states"];
}

} // namespace

TEST_CASE("rest --moulded lists a cap inside out where shell theory says that it stays so, and not below", "[validation]") {
    const TempFolder folder;
    const std::string cap = cap_file(folder), out = folder / "out.obj", second = folder / "out-2.obj";
    const auto listed = [&](double share) {
        return states_of({"rest", cap, "--moulded", "--fabric", fabric_file(folder, share * threshold), "-o", out, "--all-states", "--json"});
    };
    const auto below = listed(0.95);
    REQUIRE(below.size() == 1);
    CHECK(std::abs(below[0]["energy"].get<double>()) < 1e-10);
    CHECK_FALSE(std::filesystem::exists(second));

    const auto above = listed(1.05);
    REQUIRE(above.size() == 2);
    CHECK(std::abs(above[0]["energy"].get<double>()) < 1e-10);
    CHECK(above[1]["energy"].get<double>() > 1e-3);
    CHECK(above[1]["mirror_of"] == 1);
    CHECK(height(read_garment(out).x, rings) == Approx(0.05).epsilon(1e-6));
    CHECK(height(read_garment(second).x, rings) < -0.03);
}

TEST_CASE("rest lists both states of a cap by its edges and hinges alone") {
    const TempFolder folder;
    const std::string cap = cap_file(folder);
    // Equilateral, with lengths of weight w and angles of 1: modulus 4 w / (sqrt(3) edge^2), D = sqrt(3) / 2, nu = 1/3 (lambda 5.53).
    const double edge = 1.0 / rings, balanced = std::pow(5.534, 4) * cap_radius * cap_radius * 0.375 * edge * edge;
    CHECK(states_of({"rest", cap, "--length-weight", std::to_string(0.6 * balanced), "--json"}).size() == 1);
    const auto both = states_of({"rest", cap, "--length-weight", std::to_string(1.6 * balanced), "--json"});
    REQUIRE(both.size() == 2);
    CHECK(both[1]["mirror_of"] == 1);
}

TEST_CASE("rest --moulded: what goes with other forms, and meshes that cannot be used, are refused") {
    const TempFolder folder;
    const std::string cap = cap_file(folder), flat = folder / "flat.obj";
    CHECK(run_toile({"rest", cap, "--moulded", "--json", "--relax"}).code == 1);
    CHECK(run_toile({"rest", cap, "--moulded", "--json", "--sag-free", "--hold", "1"}).code == 1);
    CHECK(run_toile({"rest", cap, "--moulded", "--rest", folder / "rest.json"}).code == 1);
    write_file(flat, "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    const Run refused = run_toile({"rest", flat, "--moulded", "-o", folder / "out.obj"});
    CHECK(refused.code == 2);
    CHECK_THAT(refused.err, Contains("flat.obj: the triangle of points 1, 2 and 3 has no area"));
    CHECK_FALSE(std::filesystem::exists(folder / "out.obj"));
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/fabric/fabric.h"
#include "io/read_garment.h"
#include "io/write_file.h"
#include "tests/src/run.h"
#include "tests/support/temp_folder.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>

using namespace toile;
using namespace toile::test;
using Catch::Matchers::Contains;

namespace {

// Four triangles round the first point, in a square of side 1.
constexpr const char* four = "v 0 0.1 0\nv 0.5 0 0.5\nv 0.5 0 -0.5\nv -0.5 0 -0.5\nv -0.5 0 0.5\n"
                             "f 1 2 3\nf 1 3 4\nf 1 4 5\nf 1 5 2\n";
/// A flat square whose spokes are `spokes` times as long as its rim would have them.
std::string square(double spokes, double ridge) {
    const nlohmann::json diagonals = {{2, 1, 4}, {3, 1, 5}};
    nlohmann::json data{{"lengths", {{{"along", "borders"}, {"length", 1}}}}, {"angles", nlohmann::json::array()}};
    for (const auto& along : diagonals) {
        data["lengths"].push_back({{"along", along}, {"length", spokes * std::sqrt(0.5)}});
        data["angles"].push_back({{"along", along}, {"angle", ridge}});
    }
    return data.dump();
}

nlohmann::json report_of(const std::vector<std::string>& arguments) {
    const Run r = run_toile(arguments);
    CAPTURE(r.err);
    REQUIRE(r.code == 0);
    return nlohmann::json::parse(r.out);
}

} // namespace

TEST_CASE("rest: what is asked of four triangles, how far it is from fitting, and both states of a cone") {
    const TempFolder folder;
    const std::string shape = folder / "four.obj", data = folder / "data.json", out = folder / "out.obj";
    write_file(shape, four);
    write_file(data, square(1, 30));
    auto r = report_of({"rest", shape, "--data", data, "--length-weight", "1", "-o", out, "--json"});
    CHECK(r["data"]["lengths"] == 8);
    CHECK(r["data"]["angles"] == 4);
    CHECK(r["data"]["rank"] == 9);
    CHECK(r["misfit"]["points"].size() == 1);
    CHECK(r["misfit"]["at"] == 1);
    CHECK(r["states"][0]["energy"].get<double>() == Approx(0.00274135244).epsilon(1e-6));
    CHECK(r["second_opinion"]["difference"].get<double>() < 1e-6);
    CHECK(std::filesystem::exists(out));
    CHECK_FALSE(std::filesystem::exists(folder / "out-2.obj"));

    r = report_of({"rest", shape, "--data", data, "--length-weight", "1000", "--json"});
    CHECK(r["states"][0]["energy"].get<double>() == Approx(0.4253912878).epsilon(1e-6));
    CHECK(r["second_opinion"]["difference"].get<double>() < 1e-6);

    write_file(data, square(1.05, 0));
    r = report_of({"rest", shape, "--data", data, "--length-weight", "1000", "-o", out, "--all-states", "--json"});
    REQUIRE(r["states"].size() >= 2);
    CHECK(r["states"][0]["energy"].get<double>() == Approx(1.3160316331).epsilon(1e-6));
    CHECK(r["states"][0]["mirror_of"] == 2);
    CHECK(r["states"][0]["angle_off_max"].get<double>() == Approx(31.748).margin(1e-3));
    CHECK(std::filesystem::exists(folder / "out-2.obj"));
}

TEST_CASE("rest: relaxed, a shape is at rest in itself; kept, it has what is frozen in") {
    const TempFolder folder;
    const std::string shape = folder / "four.obj", data = folder / "data.json", out = folder / "out.obj", rest = folder / "rest.json";
    write_file(shape, four);
    write_file(data, square(1.05, 0));
    const double kept = report_of({"rest", shape, "--data", data, "--length-weight", "10", "--rest", rest, "--json"})["frozen_energy"];
    CHECK(kept > 0.01);
    const auto again = report_of({"rest", shape, "--data", rest, "--length-weight", "10", "--json"});
    CHECK(again["frozen_energy"].get<double>() == Approx(kept).epsilon(1e-9));

    report_of({"rest", shape, "--data", data, "--length-weight", "10", "--relax", "--rest", rest, "-o", out, "--json"});
    const auto relaxed = report_of({"rest", out, "--data", rest, "--length-weight", "10", "--json"});
    CHECK(relaxed["frozen_energy"].get<double>() < 1e-20);
    CHECK(relaxed["misfit"]["points"].empty());
}

TEST_CASE("rest: lengths of one mesh with the angles of another") {
    const TempFolder folder;
    const std::string shape = folder / "four.obj", flat = folder / "flat.obj", other = folder / "other.obj";
    write_file(shape, four);
    std::string text = four;
    write_file(flat, text.replace(text.find("0.1"), 3, "0.0"));
    auto r = report_of({"rest", shape, "--lengths-of", flat, "--angles-of", flat, "--json"});
    CHECK(r["frozen_energy"].get<double>() < 1e-20);
    CHECK(r["misfit"]["points"].empty());
    r = report_of({"rest", shape, "--angles-of", flat, "--json"});
    CHECK(r["misfit"]["points"].size() == 1);
    write_file(other, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const Run refused = run_toile({"rest", shape, "--angles-of", other, "--json"});
    CHECK(refused.code == 2);
    CHECK_THAT(refused.err, Contains("other.obj: expected the triangles of the shape"));
}

TEST_CASE("rest: data that cannot be used are refused in a sentence") {
    const TempFolder folder;
    const std::string shape = folder / "four.obj", data = folder / "data.json";
    write_file(shape, four);
    const std::vector<std::pair<std::string, std::string>> bad{
        {"[]", "object"},
        {R"({"length": []})", "length"},
        {R"({"lengths": [{"along": [2, 4], "length": 1}]})", "must be joined to point 2 by an edge"},
        {R"({"lengths": [{"along": [1, 9], "length": 1}]})", "point 1"},
        {R"({"lengths": [{"along": [1, 2], "length": -1}]})", "length"},
        {R"({"lengths": [{"along": [1, 2], "length": 1, "scale": 2}]})", "either"},
        {R"({"lengths": [{"along": [1, 2], "length": 10}]})", "no triangle has the lengths prescribed for points 1, 2 and 3"},
        {R"({"angles": [{"along": "some", "angle": 1}]})", "borders"},
        {R"({"angles": [{"along": [1, 2], "angle": 200}]})", "angle"},
    };
    for (const auto& [text, says] : bad) {
        CAPTURE(text);
        write_file(data, text);
        const Run r = run_toile({"rest", shape, "--data", data, "-o", folder / "out.obj"});
        CHECK(r.code == 2);
        CHECK_THAT(r.err, Contains("data.json") && Contains(says));
        CHECK_FALSE(std::filesystem::exists(folder / "out.obj"));
    }
    CHECK(run_toile({"rest", shape}).code == 1);
    CHECK(run_toile({"rest", shape, "--json", "--all-states"}).code == 1);
    CHECK(run_toile({"rest", shape, "-o", folder / "a.stl"}).code == 1);
    CHECK(run_toile({"rest", shape, "--json", "--relax", "--keep-energy"}).code == 1);
    CHECK(run_toile({"rest", shape, "--json", "--fabric", "poplin", "--length-weight", "1"}).code == 1);
    CHECK(run_toile({"rest", folder / "none.obj", "--json"}).code == 2);
}

TEST_CASE("rest: a fabric of one's own weighs as the preset of the same figures does, and is refused as in a drape") {
    const TempFolder folder;
    const std::string shape = folder / "four.obj", data = folder / "data.json", fabric = folder / "mine.json";
    write_file(shape, four);
    write_file(data, square(1.1, 30));
    const auto energy = [&](const std::string& name) {
        const auto r = report_of({"rest", shape, "--data", data, "--fabric", name, "--json"});
        return std::pair(r["weights"]["fabric"].get<std::string>(), r["states"][0]["energy"].get<double>());
    };
    write_file(fabric, R"({"toile_fabric": 1, "name": "mine", "like": "denim"})");
    CHECK(energy(fabric) == std::pair(std::string("mine"), energy("denim").second));
    const Fabric& denim = fabric_preset("denim"); // twice as stiff to bend, which is what most of the energy is of
    write_file(fabric, nlohmann::json{{"toile_fabric", 1}, {"name", "mine"}, {"like", "denim"}, {"bend_warp", 2 * denim.bend_warp},
                                      {"bend_weft", 2 * denim.bend_weft}, {"bend_twist", 2 * denim.bend_twist}}.dump());
    CHECK(energy(fabric).second > 1.5 * energy("denim").second);
    CHECK(energy(fabric).second < 2.1 * energy("denim").second);

    CHECK(run_toile({"rest", shape, "--fabric", fabric, "--report", fabric}).code == 2); // would be written over
    write_file(fabric, R"({"toile_fabric": 1, "name": "mine", "like": "denim", "stretchy": 1})");
    const Run r = run_toile({"rest", shape, "--fabric", fabric, "--json"});
    CHECK(r.code == 2);
    CHECK_THAT(r.err, Contains("mine.json") && Contains("stretchy"));
}

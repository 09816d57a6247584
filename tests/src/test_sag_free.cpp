// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/rest/sag_free.h"
#include "io/prescribed_json.h"
#include "io/read_garment.h"
#include "io/write_file.h"
#include "tests/src/run.h"
#include "tests/support/surfaces.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <numeric>

using namespace toile;
using namespace toile::test;
using Catch::Matchers::Contains;

namespace {

/// A level square sheet of 9 x 9 points with edges of 5 cm, bulged.
std::string sheet(double bulge) {
    std::ostringstream obj;
    obj.precision(17);
    const TriMesh flat = grid(8, 8, 0.05);
    for (const Vec3& p : flat.points)
        obj << "v " << p.x() << ' ' << bulge * std::sin(M_PI * p.x() / 0.4) * std::sin(M_PI * p.y() / 0.4) << ' ' << p.y() << '\n';
    for (const Triangle& t : flat.triangles) obj << "f " << t[0] + 1 << ' ' << t[2] + 1 << ' ' << t[1] + 1 << '\n';
    return obj.str();
}

} // namespace

TEST_CASE("rest sag-free: with what is written the shape is in balance") {
    const TempFolder folder;
    const std::string shape = folder / "bowl.obj", rest = folder / "rest.json", preview = folder / "bowl.png";
    write_file(shape, sheet(-0.1));
    const Run r = run_toile({"rest", shape, "--sag-free", "--hold", "borders", "--fabric", "denim", "--rest", rest, "--preview",
                             preview, "--json"});
    CAPTURE(r.err);
    REQUIRE(r.code == 0);
    const auto report = nlohmann::json::parse(r.out);
    CHECK(report["status"] == "balanced");
    CHECK(report["stable"] == true);
    CHECK(report["residual"]["max"].get<double>() < 1e-9);
    CHECK(report["residual"]["points"].empty());
    CHECK(report["bounds"]["lengths"].empty());
    CHECK(report["bounds"]["angles"].empty());
    CHECK(std::abs(report["length_change"]["max"].get<double>()) < 0.05);
    CHECK(report["angle_change"]["along"].size() == 2);
    CHECK(std::filesystem::exists(preview));
    const std::string dome = folder / "dome.obj"; // denim is too soft to stand up so far
    write_file(dome, sheet(0.1));
    CHECK_THAT(run_toile({"rest", dome, "--sag-free", "--hold", "borders", "--fabric", "denim", "--rest", rest + ".dome"}).out,
               Contains("not stable"));

    const std::string mine = folder / "mine.json";
    write_file(mine, R"({"toile_fabric": 1, "name": "mine", "like": "denim", "density": )" +
                         std::to_string(2 * fabric_preset("denim").density) + "}");
    const Run own = run_toile({"rest", shape, "--sag-free", "--hold", "borders", "--fabric", mine, "--json"});
    REQUIRE(own.code == 0);
    const auto heavy = nlohmann::json::parse(own.out);
    CHECK(heavy["fabric"] == "mine");
    CHECK(heavy["weight"].get<double>() == Approx(2 * report["weight"].get<double>()));

    const ReadGarment read = read_garment(shape);
    Prescribed data = measured(node_triangles(read.garment), read.x);
    std::vector<int> same(read.x.size());
    std::iota(same.begin(), same.end(), 0);
    REQUIRE(read.file_node == same);
    const Fabric& denim = fabric_preset("denim");
    const Points load = weight_of(data.triangles, read.x, denim.density, 9.81);
    const auto unanswered = [&] {
        weigh(data, denim);
        Eigen::VectorXd g = -flat(load);
        PrescribedEnergy(data).add_gradient(read.x, g);
        double most = 0;
        for (int j = 1; j < 8; ++j)
            for (int i = 1; i < 8; ++i) most = std::max(most, g.segment<3>(3 * (9 * j + i)).norm());
        return most;
    };
    CHECK(unanswered() > 1e-3);
    read_prescribed(rest, same, data);
    CHECK(unanswered() < 1e-9);
    double most = 0;
    for (int e = 0; e < data.edges.size(); ++e)
        most = std::max(most, std::abs(data.length[e] / measured(data.triangles, read.x).length[e] - 1));
    CHECK(std::abs(report["length_change"]["max"].get<double>()) == Approx(most).epsilon(1e-9));
}

TEST_CASE("rest sag-free: what cannot be held is told by its worst point and the newtons it lacks") {
    const TempFolder folder;
    const std::string shape = folder / "level.obj", rest = folder / "rest.json", hold = folder / "corners.txt";
    write_file(shape, sheet(0));
    write_file(hold, "1 9\n73, 81\n");
    const Run r = run_toile({"rest", shape, "--sag-free", "--hold", hold, "--angle-change", "0", "--rest", rest, "--json"});
    CHECK(r.code == 3);
    CHECK(one_sentence(r.err));
    const auto report = nlohmann::json::parse(r.out);
    CHECK(report["status"] == "nearest");
    CHECK(report["stable"].is_null());
    CHECK(report["residual"]["points"].size() == 77);
    // Of the sheet's weight an inner point has that of six thirds of a triangle.
    const double lacks = fabric_preset("poplin").density * 9.81 * 0.05 * 0.05;
    CHECK(report["residual"]["max"].get<double>() == Approx(lacks).epsilon(1e-6));
    CHECK_THAT(r.err, Contains("point " + report["residual"]["at"].dump() + " lacks"));
    CHECK(std::filesystem::exists(rest));
    const Run same = run_toile({"rest", shape, "--sag-free", "--hold", "1,9,73,81", "--angle-change", "0", "--rest", rest, "--json"});
    CHECK(same.out == r.out);
}

TEST_CASE("rest sag-free: what cannot be used is refused in a sentence") {
    const TempFolder folder;
    const std::string shape = folder / "dome.obj", numbers = folder / "numbers.txt", rest = folder / "rest.json";
    write_file(shape, sheet(0.1));
    const auto refused = [&](const std::string& hold, int code, const std::string& says) {
        const Run r = run_toile({"rest", shape, "--sag-free", "--hold", hold, "--rest", rest});
        CAPTURE(hold, r.err);
        CHECK(r.code == code);
        CHECK(one_sentence(r.err));
        CHECK_THAT(r.err, Contains(says));
        CHECK_FALSE(std::filesystem::exists(rest));
    };
    refused("1,82", 2, "found 82");
    refused("0", 2, "found 0");
    refused(",", 2, "found none");
    refused("99999999999", 2, "99999999999");
    refused("edges", 2, "edges");
    write_file(numbers, "1 two 3");
    refused(numbers, 2, "found \"two\"");
    write_file(numbers, "");
    refused(numbers, 2, "found none");
    for (const std::vector<std::string>& line : std::vector<std::vector<std::string>>{
             {"rest", shape, "--sag-free", "--rest", rest},
             {"rest", shape, "--hold", "1", "--rest", rest},
             {"rest", shape, "--length-change", "1", "--rest", rest},
             {"rest", shape, "--sag-free", "--hold", "1", "-o", folder / "out.obj"},
             {"rest", shape, "--sag-free", "--hold", "1", "--relax", "--rest", rest},
             {"rest", shape, "--sag-free", "--hold", "1", "--length-change", "80", "--rest", rest},
             {"rest", shape, "--sag-free", "--hold", "1"}}) {
        const Run r = run_toile(line);
        CAPTURE(line, r.err);
        CHECK(r.code == 1);
        CHECK(one_sentence(r.err));
    }
}

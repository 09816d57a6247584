// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_garment.h"
#include "io/write_file.h"
#include "io/write_garment.h"
#include "tests/src/run.h"
#include "tests/support/mesh_cloth.h"
#include "tests/support/random.h"
#include "tests/support/skirt.h"
#include "tests/support/surfaces.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <set>

using namespace toile;
using namespace toile::test;
using Catch::Matchers::Contains;

namespace {

nlohmann::json inspected(const std::string& garment, const std::string& body) {
    return nlohmann::json::parse(run_toile({"inspect", garment, "--avatar", body, "--json"}).out);
}

std::vector<std::string> lines_of(const std::string& path) {
    std::vector<std::string> lines;
    std::istringstream text(read_file(path, 1 << 26));
    for (std::string line; std::getline(text, line);)
        lines.push_back(line);
    return lines;
}

bool starts(const std::string& line, const char* with) {
    return line.starts_with(with);
}

/// A tube about a form of radius 15 cm that is 3 mm in it, as another tool writes it: quads, normals, colours, groups,
/// materials, centimetres without a word of it.
std::string foreign_tube() {
    std::ostringstream s;
    s << "# another tool\r\nmtllib tube.mtl\r\no Tube\r\n";
    const int around = 48, along = 14;
    for (int j = 0; j <= along; ++j)
        for (int i = 0; i < around; ++i) {
            const double phi = 2 * EIGEN_PI * i / around;
            s << "v " << 14.7 * std::cos(phi) << ' ' << 20.0 * j / along - 10 << ' ' << 14.7 * std::sin(phi) << " 1 0.5 0\r\n";
        }
    s << "vt 0 0\r\nvt 1 0\r\nvt 1 1\r\nvt 0 1\r\n";
    for (int i = 0; i < around; ++i) {
        const double phi = 2 * EIGEN_PI * i / around;
        s << "vn " << std::cos(phi) << " 0 " << std::sin(phi) << "\r\n";
    }
    for (int j = 0; j < along; ++j) {
        if (j % 7 == 0) s << "g part" << j / 7 << "\r\nusemtl cloth" << j / 7 << "\r\ns 1\r\n";
        for (int i = 0; i < around; ++i) {
            const int k = (i + 1) % around, a = j * around;
            s << "f " << a + i + 1 << "/1/" << i + 1 << ' ' << a + around + i + 1 << "/4/" << i + 1 << ' '
              << a + around + k + 1 << "/3/" << k + 1 << ' ' << a + k + 1 << "/2/" << k + 1 << "\r\n";
        }
    }
    return s.str();
}

} // namespace

TEST_CASE("untangle moves what crosses and leaves the rest of another tool's file as it was") {
    const TempFolder folder;
    const std::string in = write_text(folder / "tube.obj", foreign_tube());
    write_mesh(folder / "body.obj", ellipsoid({0.15, 0.45, 0.15}, 48, 40));
    const std::string body = folder / "body.obj", out = folder / "out.obj";
    const Run r = run_toile({"untangle", in, "--avatar", body, "-o", out, "--report", folder / "r.json"});
    INFO(r.out << r.err);
    REQUIRE(r.code == 0);
    CHECK_THAT(r.out, Contains("before: ") && Contains("after: 0 pairs with the body, 0 of the cloth") && Contains("moved: "));
    CHECK_THAT(r.err, Contains("centimetres"));
    const auto before = inspected(in, body), after = inspected(out, body);
    CHECK(before["intersections"]["cloth_avatar"] > 100);
    CHECK(before["inside"]["nodes"] > 100);
    CHECK(before["inside"]["depth"].get<double>() == Approx(0.003).epsilon(0.1));
    CHECK(after["intersections"]["cloth_avatar"] == 0);
    CHECK(after["intersections"]["cloth_cloth"] == 0);
    CHECK(after["inside"]["nodes"] == 0);
    CHECK(after["clearance_min"] > 0.04e-3);

    const auto report = nlohmann::json::parse(read_file(folder / "r.json", 1 << 26));
    CHECK(report["status"] == "clear");
    CHECK(report["where"] == "");
    CHECK(report["before"]["intersections"] == before["intersections"]);
    CHECK(report["after"]["intersections"] == after["intersections"]);
    CHECK(report["change"]["displacement"]["max"].get<double>() < 0.01);
    CHECK(report["change"]["edge_length"]["max"].get<double>() < 0.2);

    const auto a = lines_of(in), b = lines_of(out);
    REQUIRE(a.size() == b.size());
    int moved = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        CHECK(starts(a[k], "v ") == starts(b[k], "v "));
        if (starts(a[k], "v ")) {
            CHECK(b[k].ends_with(" 1 0.5 0\r"));
            moved += a[k] != b[k];
        } else if (!starts(a[k], "vn ")) {
            CHECK(a[k] == b[k]);
        }
    }
    CHECK(moved == report["change"]["moved_nodes"].get<int>());
}

TEST_CASE("untangle writes GLB as it was but for positions and normals, and one format as the other") {
    const TempFolder folder;
    auto skirt = make_skirt(16, 8, 0.16, 1.0, 0.5);
    Random random(3);
    for (int k = 0; k < 12; ++k)
        skirt.x[std::size_t(random.in(0, double(skirt.x.size())))] *= 0.9; // into the body
    write_garment(folder / "a.glb", skirt.garment, skirt.x);
    TriMesh form = ellipsoid({0.155, 0.6, 0.155}, 64, 60);
    for (Vec3& p : form.points) p.y() += 0.75;
    write_mesh(folder / "body.obj", form);
    const std::string body = folder / "body.obj";
    REQUIRE(inspected(folder / "a.glb", body)["intersections"]["cloth_avatar"] > 0);
    const Run r = run_toile({"untangle", folder / "a.glb", "--avatar", body, "-o", folder / "b.glb", "-o", folder / "b.obj", "--json"});
    INFO(r.out << r.err);
    REQUIRE(r.code == 0);
    for (const char* name : {"b.glb", "b.obj"}) {
        const auto i = inspected(folder / name, body);
        CHECK(i["intersections"]["cloth_avatar"] == 0);
        CHECK(i["intersections"]["cloth_cloth"] == 0);
        CHECK(i["inside"]["nodes"] == 0);
        CHECK(i["panels"] == 2);
    }
    const ReadGarment was = read_garment(folder / "a.glb"), is = read_garment(folder / "b.glb");
    CHECK(is.garment.triangles == was.garment.triangles);
    CHECK(is.garment.uv == was.garment.uv);
    CHECK(is.garment.panel_names == was.garment.panel_names);
    CHECK(is.garment.node_of_vertex == was.garment.node_of_vertex);
    CHECK(is.x != was.x);
    // What is not positions, normals or their bounds is the same to the byte.
    const std::string a = read_file(folder / "a.glb", 1 << 26), b = read_file(folder / "b.glb", 1 << 26);
    const std::string ja = a.substr(20, *reinterpret_cast<const std::uint32_t*>(a.data() + 12));
    const std::string jb = b.substr(20, *reinterpret_cast<const std::uint32_t*>(b.data() + 12));
    auto left = nlohmann::json::parse(ja), right = nlohmann::json::parse(jb);
    for (auto* j : {&left, &right})
        for (auto& accessor : (*j)["accessors"]) accessor.erase("min"), accessor.erase("max");
    CHECK(left == right);
}

TEST_CASE("untangle says what it could not undo, and writes the best state") {
    const TempFolder folder;
    TriMesh mesh = grid(6, 6, 0.01);
    mesh.triangles.push_back(mesh.triangles[20]); // cloth given twice
    write_mesh(folder / "a.obj", mesh);
    const Run r = run_toile({"untangle", folder / "a.obj", "-o", folder / "b.obj", "--json"});
    CHECK(r.code == 3);
    CHECK(one_sentence(r.err));
    CHECK_THAT(r.err, Contains("tangled") && Contains("1 pairs of cloth and cloth cross at (") && Contains("best state was written"));
    const auto report = nlohmann::json::parse(r.out);
    CHECK(report["status"] == "tangled");
    CHECK(report["after"]["crossings"].size() == 1);
    CHECK(report["after"]["crossings"][0]["pairs"][0] == nlohmann::json({20, 72}));
    CHECK(read_file(folder / "b.obj", 1 << 20) == read_file(folder / "a.obj", 1 << 20));

    mesh = tube(0.29, 0.2, 48, 20);
    write_mesh(folder / "tube.obj", mesh);
    write_mesh(folder / "body.obj", ellipsoid({0.3, 0.5, 0.3}, 30, 20));
    const Run late = run_toile({"untangle", folder / "tube.obj", "--avatar", folder / "body.obj", "-o", folder / "c.obj",
                                "--max-seconds", "0.001s"});
    CHECK(late.code == 3);
    CHECK_THAT(late.err, Contains("limit") && Contains("time limit"));
    CHECK(std::filesystem::exists(folder / "c.obj"));
}

TEST_CASE("a drape shaken by noise comes clear of its body and itself") {
    const TempFolder folder;
    const std::string body = folder / "form.obj";
    REQUIRE(run_toile({"form", "-o", body}).code == 0);
    const std::string pattern = std::string(TOILE_SOURCE_DIR) + "/examples/tee.json";
    REQUIRE(run_toile({"drape", pattern, "-o", folder / "tee.obj", "--edge-length", "25mm", "--quiet"}).code == 0);
    ReadGarment tee = read_garment(folder / "tee.obj");
    REQUIRE(inspected(folder / "tee.obj", body)["intersections"]["cloth_avatar"] == 0);
    Random random(29);
    for (Vec3& p : tee.x)
        p += random.vec3(0.014);
    write_garment(folder / "shaken.obj", tee.garment, tee.x);
    const auto before = inspected(folder / "shaken.obj", body);
    CHECK(before["intersections"]["cloth_avatar"] > 100);
    CHECK(before["intersections"]["cloth_cloth"] > 24);
    const Run r = run_toile({"untangle", folder / "shaken.obj", "--avatar", body, "-o", folder / "a.obj"});
    INFO(r.out << r.err);
    CHECK(r.code == 0);
    const auto after = inspected(folder / "a.obj", body);
    CHECK(after["intersections"]["cloth_avatar"] == 0);
    CHECK(after["intersections"]["cloth_cloth"] == 0);
    CHECK(after["inside"]["nodes"] == 0);
}

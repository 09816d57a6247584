// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/solid.h"
#include "io/read_avatar.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_data.h"

#include <catch2/catch.hpp>

#include <cstring>
#include <fstream>
#include <functional>
#include <sstream>

using namespace toile;

namespace {

/// A box as tall as a person: the smallest body there is. Its volume is 0.204 m3.
TriMesh person() { return test::box(Vec3(-0.2, 0, -0.15), Vec3(0.2, 1.7, 0.15)); }
constexpr double person_volume = 0.4 * 1.7 * 0.3;

std::string as_obj(const TriMesh& mesh, double scale = 1) {
    std::ostringstream out;
    out.precision(17);
    for (const Vec3& p : mesh.points)
        out << "v " << scale * p.x() << " " << scale * p.y() << " " << scale * p.z() << "\n";
    for (const Triangle& t : mesh.triangles) out << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
    return out.str();
}

std::string as_ply(const TriMesh& mesh) {
    std::ostringstream out;
    out << "ply\nformat ascii 1.0\nelement vertex " << mesh.points.size()
        << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << mesh.triangles.size()
        << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (const Vec3& p : mesh.points) out << p.x() << " " << p.y() << " " << p.z() << "\n";
    for (const Triangle& t : mesh.triangles) out << "3 " << t[0] << " " << t[1] << " " << t[2] << "\n";
    return out.str();
}

template <class T> void put(std::string& bytes, T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes.append(raw, sizeof(T));
}

std::string as_stl(const TriMesh& mesh) {
    std::string bytes(80, ' ');
    put(bytes, std::uint32_t(mesh.triangles.size()));
    for (const Triangle& t : mesh.triangles) {
        for (int i = 0; i < 3; ++i) put(bytes, 0.0f);
        for (int corner : t)
            for (int i = 0; i < 3; ++i) put(bytes, float(mesh.points[corner][i]));
        put(bytes, std::uint16_t(0));
    }
    return bytes;
}

/// Every triangle with points of its own, as a file for flat shading has them; moved by its node.
std::string as_glb(const TriMesh& mesh) {
    std::string positions;
    Vec3 low = mesh.points[0], high = low;
    for (const Triangle& t : mesh.triangles)
        for (int corner : t)
            for (int i = 0; i < 3; ++i) put(positions, float(mesh.points[corner][i]));
    for (const Vec3& p : mesh.points) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    std::ostringstream text;
    text << R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)"
         << R"("nodes":[{"mesh":0,"translation":[0,1,0]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
         << R"("buffers":[{"byteLength":)" << positions.size() << R"(}],"bufferViews":[{"buffer":0,"byteLength":)"
         << positions.size() << R"(}],"accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":)"
         << 3 * mesh.triangles.size() << R"(,"min":[)" << low.x() << "," << low.y() << "," << low.z() << R"(],"max":[)"
         << high.x() << "," << high.y() << "," << high.z() << "]}]}";
    std::string json = text.str();
    json.resize((json.size() + 3) / 4 * 4, ' ');
    std::string bytes = "glTF";
    put(bytes, std::uint32_t(2));
    put(bytes, std::uint32_t(12 + 8 + json.size() + 8 + positions.size()));
    put(bytes, std::uint32_t(json.size()));
    bytes += "JSON" + json;
    put(bytes, std::uint32_t(positions.size()));
    bytes += std::string("BIN\0", 4) + positions;
    return bytes;
}

std::string as_dae(const TriMesh& mesh) {
    std::ostringstream out;
    out << R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">)"
        << R"(<asset><unit meter="1"/><up_axis>Y_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>)"
        << R"(<source id="p"><float_array id="pa" count=")" << 3 * mesh.points.size() << "\">";
    for (const Vec3& p : mesh.points) out << p.x() << " " << p.y() << " " << p.z() << " ";
    out << R"(</float_array><technique_common><accessor source="#pa" count=")" << mesh.points.size()
        << R"(" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>)"
        << R"(</accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>)"
        << R"(<triangles count=")" << mesh.triangles.size() << R"("><input semantic="VERTEX" source="#v" offset="0"/><p>)";
    for (const Triangle& t : mesh.triangles) out << t[0] << " " << t[1] << " " << t[2] << " ";
    out << R"(</p></triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s">)"
        << R"(<node><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes><scene>)"
        << R"(<instance_visual_scene url="#s"/></scene></COLLADA>)";
    return out.str();
}

std::string write(const test::TempFolder& folder, const std::string& name, const std::string& bytes) {
    std::ofstream(folder / name, std::ios::binary) << bytes;
    return folder / name;
}

std::string message_of(const std::function<void()>& call) {
    try {
        call();
    } catch (const InputError& error) {
        return error.what();
    }
    return "nothing was refused";
}

bool noted(const ReadAvatar& avatar, const std::string& words) {
    for (const std::string& note : avatar.notes)
        if (note.find(words) != std::string::npos) return true;
    return false;
}

using Catch::Matchers::Contains;

} // namespace

TEST_CASE("the same body is read from every format", "[read_avatar]") {
    const test::TempFolder folder;
    const TriMesh mesh = person();
    const std::string name = GENERATE("a.obj", "a.PLY", "a.stl", "a.glb", "a.dae");
    const std::string bytes = name == "a.obj"   ? as_obj(mesh)
                              : name == "a.PLY" ? as_ply(mesh)
                              : name == "a.stl" ? as_stl(mesh)
                              : name == "a.glb" ? as_glb(mesh)
                                                : as_dae(mesh);
    const std::string path = write(folder, name, bytes);
    INFO(path);
    const ReadAvatar avatar = read_avatar(path);
    CHECK(avatar.body.points.size() == 8);
    CHECK(avatar.body.triangles.size() == 12);
    CHECK(volume(avatar.body) == Approx(person_volume));
    CHECK(noted(avatar, "metres, y up, 1.700 m tall"));
    double floor = 1e9;
    for (const Vec3& p : avatar.body.points) floor = std::min(floor, p.y());
    const bool moved_by_its_node = path.ends_with(".glb");
    CHECK(floor == Approx(moved_by_its_node ? 1 : 0).margin(1e-6));
}

TEST_CASE("an OBJ keeps its order and its precision", "[read_avatar]") {
    const test::TempFolder folder;
    TriMesh mesh = person();
    mesh.points[3].x() += 1e-12;
    const ReadAvatar avatar = read_avatar(write(folder, "a.obj", as_obj(mesh)));
    CHECK(avatar.body.points == mesh.points);
    CHECK(avatar.body.triangles == mesh.triangles);
}

TEST_CASE("OBJ faces may be quads, count backwards and name textures", "[read_avatar]") {
    const test::TempFolder folder;
    const std::string text = "# a box\r\nmtllib x.mtl\no body\nv -0.2 0 -0.1 1 1 1\nv 0.2 0 -0.1\nv -.2 1.7 -.1\nv 0.2 1.7 -0.1\r\n"
                             "v -0.2 0 0.1\nv 0.2 0 0.1\nv -0.2 1.7 0.1\nv +0.2 1.7 1e-1\nvt 0 0\nvn 0 0 1\n"
                             "f 1/1/1 5/1/1 7/1/1 3/1/1\nf 2//1 4//1 8//1 6//1\nf -8 -7 -3 -4\nf 3 7 8 4\nf 1/1 3/1 4/1 2/1\nf 5 6 8 7\n";
    const ReadAvatar avatar = read_avatar(write(folder, "a.obj", text));
    CHECK(avatar.body.points.size() == 8);
    CHECK(avatar.body.triangles.size() == 12);
    CHECK(volume(avatar.body) == Approx(0.4 * 1.7 * 0.2));
    CHECK(noted(avatar, "6 quads split"));
}

TEST_CASE("unit and up axis are told by the size", "[read_avatar]") {
    const test::TempFolder folder;
    const auto [scale, name] = GENERATE(table<double, std::string>(
        {{1, "in metres"}, {10, "in decimetres"}, {100, "in centimetres"}, {1000, "in millimetres"}}));
    const ReadAvatar y_up = read_avatar(write(folder, "y.obj", as_obj(person(), scale)));
    CHECK(noted(y_up, name));
    CHECK(volume(y_up.body) == Approx(person_volume));

    TriMesh turned = person();
    for (Vec3& p : turned.points) p = Vec3(p.x(), -p.z(), p.y()); // z up, the front toward -y
    const ReadAvatar z_up = read_avatar(write(folder, "z.obj", as_obj(turned, scale)));
    CHECK(noted(z_up, "z up"));
    for (size_t i = 0; i < 8; ++i) CHECK((z_up.body.points[i] - person().points[i]).norm() < 1e-12);
}

TEST_CASE("what is turned inside out is turned back", "[read_avatar]") {
    const test::TempFolder folder;
    TriMesh mesh = person();
    for (Triangle& t : mesh.triangles) std::swap(t[0], t[1]);
    const ReadAvatar avatar = read_avatar(write(folder, "a.obj", as_obj(mesh)));
    CHECK(volume(avatar.body) == Approx(person_volume));
    CHECK(noted(avatar, "12 triangles turned"));
}

TEST_CASE("a leak is refused with its place, or closed when asked", "[read_avatar]") {
    const test::TempFolder folder;
    TriMesh mesh = person();
    mesh.triangles.erase(mesh.triangles.begin() + 6, mesh.triangles.begin() + 8); // the top
    const std::string path = write(folder, "a.obj", as_obj(mesh));
    const std::string message = message_of([&] { read_avatar(path); });
    CHECK_THAT(message, Contains("not closed: 1 hole with 4 open edges"));
    CHECK_THAT(message, Contains("140.0 cm around"));
    CHECK_THAT(message, Contains("y 1.700"));

    const ReadAvatar avatar = read_avatar(path, {.repair = true});
    CHECK(volume(avatar.body) == Approx(person_volume));
    CHECK(border_loops(avatar.body).empty());
    CHECK(noted(avatar, "hole of 140.0 cm around closed"));

    mesh.triangles.erase(mesh.triangles.begin(), mesh.triangles.begin() + 2); // a side: 4.0 m round the two
    CHECK_THAT(message_of([&] { read_avatar(write(folder, "b.obj", as_obj(mesh)), {.repair = true}); }),
               Contains("too large to be closed"));
}

TEST_CASE("triangles without area and points without faces go", "[read_avatar]") {
    const test::TempFolder folder;
    std::string text = as_obj(person());
    text += "v 5 5 5\nf 1 1 2\nf 3 4 4\n";
    const ReadAvatar avatar = read_avatar(write(folder, "a.obj", text));
    CHECK(avatar.body.points == person().points);
    CHECK(avatar.body.triangles == person().triangles);
    CHECK(noted(avatar, "1 point without a face left out"));
}

TEST_CASE("what is no body is refused in a sentence", "[read_avatar]") {
    const test::TempFolder folder;
    const auto refusal = [&](const std::string& name, const std::string& bytes) {
        return message_of([&] { read_avatar(write(folder, name, bytes)); });
    };
    CHECK_THAT(message_of([&] { read_avatar(folder / "none.obj"); }), Contains("no such file"));
    CHECK_THAT(message_of([&] { read_avatar(folder.path()); }), Contains("avatars are read from"));
    CHECK_THAT(refusal("a.txt", "v 0 0 0"), Contains("avatars are read from .obj"));
    CHECK_THAT(refusal("a.obj", ""), Contains("is empty"));
    CHECK_THAT(refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), Contains("no triangles"));
    CHECK_THAT(refusal("a.obj", "Dear reader,\nthis is a letter.\n"), Contains("no triangles"));
    CHECK_THAT(refusal("a.obj", "v 0 zero 0\n"), Contains("line 1: \"zero\" is not a coordinate"));
    CHECK_THAT(refusal("a.obj", "v 0 0\n"), Contains("line 1"));
    CHECK_THAT(refusal("a.obj", "v 0 0 0\nf 1 2 3\n"), Contains("line 2: the face names point \"2\""));
    CHECK_THAT(refusal("a.obj", "v 0 0 0\nf 0 1 1\n"), Contains("\"0\""));
    CHECK_THAT(refusal("a.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), Contains("point 1 is not finite"));
    CHECK_THAT(refusal("a.obj", "v 1e308 -1e308 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), Contains("tall"));
    CHECK_THAT(refusal("a.obj", as_obj(person(), 0.01)), Contains("0.0170 units tall"));
    CHECK_THAT(refusal("a.obj", as_obj(person(), 1e5)), Contains("units tall"));
    CHECK_THAT(refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 3 2\n"), Contains("no volume"));
    CHECK_THAT(refusal("a.ply", "solid nothing"), Contains("not a mesh in the format that its name says"));
    CHECK_THAT(refusal("a.glb", "glTF but not quite"), Contains("not a mesh"));
    CHECK_THAT(refusal("a.stl", "solid nothing\nendsolid nothing\n"), Contains("a.stl"));
    CHECK_THAT(refusal("a.dae", "<COLLADA></COLLADA>"), Contains("a.dae"));
    CHECK_THAT(refusal("cut.glb", as_glb(person()).substr(0, 300)), Contains("not a mesh"));
    CHECK_THAT(refusal("cut.stl", as_stl(person()).substr(0, 300)), Contains("cut.stl"));
    const std::string path = write(folder, "a.obj", as_obj(person()));
    CHECK_THAT(message_of([&] { read_avatar(path, {.repair = false, .max_bytes = 100}); }), Contains("at most 100 bytes"));
}

TEST_CASE("real bodies are read and measured", "[read_avatar]") {
    struct Known {
        const char* file;
        size_t points, triangles;
        double height, bust, waist, hip;
    };
    // Girths: as published with the body (mean_all), else as measured here and compared by eye.
    const Known bodies[] = {
        {"mean_all.obj", 23752, 47500, 1.720, 0.998, 0.843, 1.035},
        {"mean_all_apart.obj", 23752, 47500, 1.714, 0.998, 0.843, 1.050},
        {"mean_female.obj", 23752, 47500, 1.662, 0.966, 0.798, 1.049},
        {"mean_male.obj", 23752, 47500, 1.789, 1.021, 0.889, 1.030},
        {"f_smpl_average_A40.obj", 6890, 13776, 1.658, 0.960, 0.82, 1.046},
        {"f_smpl_template.obj", 6890, 13776, 1.658, 0.960, 0.82, 1.046},
        {"m_smpl_average_A40.obj", 6890, 13776, 1.791, 1.049, 0.925, 1.030},
        {"mh_female_young_average.obj", 13380, 26756, 1.590, 0.839, 0.652, 0.947},
        {"mh_male_young_average.obj", 13380, 26756, 1.730, 0.934, 0.746, 0.947},
    };
    for (const Known& known : bodies) {
        const auto path = test::test_data(std::string("bodies/") + known.file);
        if (!path) return;
        INFO(*path);
        const ReadAvatar avatar = read_avatar(*path);
        CHECK(avatar.body.points.size() == known.points);
        CHECK(avatar.body.triangles.size() == known.triangles);
        CHECK(border_loops(avatar.body).empty());
        const BodyMeasures m = measure_body(avatar.body);
        CHECK(m.height == Approx(known.height).epsilon(1e-3));
        CHECK(m.bust == Approx(known.bust).epsilon(0.012));
        CHECK(m.waist == Approx(known.waist).epsilon(0.012));
        CHECK(m.hip == Approx(known.hip).epsilon(0.012));
        double floor = 1e9;
        for (const Vec3& p : avatar.body.points) floor = std::min(floor, p.y());
        const auto share = [&](double y) { return (y - floor) / m.height; };
        CHECK(share(m.crotch_y) == Approx(0.465).margin(0.025));
        CHECK((share(m.hip_y) > 0.46 && share(m.hip_y) < 0.52));
        CHECK((share(m.waist_y) > 0.60 && share(m.waist_y) < 0.66));
        CHECK((share(m.bust_y) > 0.70 && share(m.bust_y) < 0.77));
        CHECK((share(m.neck_y) > 0.84 && share(m.neck_y) < 0.885));
        CHECK(volume({smoothed_toward_core(avatar.body, 0.01), avatar.body.triangles}) ==
              Approx(0.3 * volume(avatar.body)).epsilon(0.25));
    }
}

TEST_CASE("a real body with open mouth and eyes is refused, and repaired when asked", "[read_avatar]") {
    const auto path = test::test_data("cipc/wm2_15k.obj");
    if (!path) return;
    CHECK_THAT(message_of([&] { read_avatar(*path); }), Contains("not closed: 3 holes with 124 open edges"));
    const ReadAvatar avatar = read_avatar(*path, {.repair = true});
    CHECK(noted(avatar, "z up"));
    CHECK(border_loops(avatar.body).empty());
    CHECK(measure_body(avatar.body).hip == Approx(0.764).epsilon(0.01));
}

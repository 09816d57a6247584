// SPDX-License-Identifier: GPL-3.0-or-later
// What a drape can be given beside a pattern and a body: staged meshes, pins, elastics, hooks that stay.
#include "geometry/memory.h"
#include "io/read_garment.h"
#include "io/write_file.h"
#include "tests/src/run.h"
#include "tests/support/schema.h"
#include "tests/support/test_data.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <csignal>
#include <filesystem>

using namespace toile;
using namespace toile::test;
using Catch::Contains;

namespace {

const std::string skirt = TOILE_SOURCE_DIR "/examples/skirt.json";

/// A panel of `columns` x `rows` cells, 0.8 m wide and 0.4 m high, as OBJ text; its nodes run row by row from the
/// bottom. `across` is where its flat lies.
std::string grid(const std::string& name, int columns, int rows, double z, double across, int first) {
    std::ostringstream out;
    const double side = z > 0 ? 1 : -1; // seen from outside, the other panel runs the other way
    for (int j = 0; j <= rows; ++j)
        for (int i = 0; i <= columns; ++i) {
            const double u = 0.8 * i / columns, v = 0.4 * j / rows;
            out << "v " << side * (u - 0.4) << ' ' << 0.3 + v << ' ' << z << "\nvt " << across + u << ' ' << v
                << '\n';
        }
    out << "g " << name << '\n';
    const auto corner = [&](int i, int j) {
        const std::string n = std::to_string(first + j * (columns + 1) + i + 1);
        return ' ' + n + '/' + n;
    };
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i)
            out << 'f' << corner(i, j) << corner(i + 1, j) << corner(i + 1, j + 1) << "\nf" << corner(i, j)
                << corner(i + 1, j + 1) << corner(i, j + 1) << '\n';
    return out.str();
}

/// Two panels before and behind the legs. The back has fewer rows: most nodes of the front's sides are sewn to the
/// inside of its edges.
std::string staged_skirt() {
    constexpr int columns = 8, front_rows = 8, back_rows = 6;
    const int first = (columns + 1) * (front_rows + 1);
    std::ostringstream out;
    out << grid("front", columns, front_rows, 0.18, 0, 0)
        << grid("back", columns, back_rows, -0.18, 0.9, first);
    const auto front = [&](int i, int j) { return j * (columns + 1) + i; };
    const auto back = [&](int i, int j) { return first + j * (columns + 1) + i; };
    for (const int side : {0, columns})
        for (int j = 0; j <= front_rows; ++j) {
            const double at = double(j) * back_rows / front_rows;
            const int below = std::min(int(at), back_rows - 1);
            out << "stitch " << front(side, j) << ' ' << back(columns - side, below) << ' '
                << back(columns - side, below + 1) << ' ' << at - below << '\n';
        }
    return out.str();
}

/// The middles of the upper sides held: the loop of a panel's border runs from its lower left along the bottom.
const char* pins_at_the_top = R"({"toile": 1, "fabric": "linen", "pins": [
  {"panel": "front", "edge": 0, "from": 0.624, "to": 0.71},
  {"panel": "back", "edge": 0, "from": 0.624, "to": 0.71}]})";

nlohmann::json drape(std::vector<std::string> arguments, int code = 0) {
    arguments.insert(arguments.begin(), "drape");
    arguments.insert(arguments.end(), {"--json"});
    const Run r = run_toile(arguments);
    INFO(r.err);
    REQUIRE(r.code == code);
    CHECK(Schema("report.schema.json").complaints(r.out) == "");
    return nlohmann::json::parse(r.out);
}

/// The first decision that has the words.
std::string decision(const nlohmann::json& report, const std::string& words) {
    for (const auto& d : report["decisions"])
        if (d.get<std::string>().find(words) != std::string::npos) return d;
    return "";
}

/// small.json: the skirt of the examples, in poplin, made narrower by `share`.
void write_narrow_skirt(const TempFolder& folder, double share) {
    nlohmann::json pattern = nlohmann::json::parse(read_file(skirt, 1 << 20));
    for (auto& panel : pattern["pattern"]["panels"])
        for (auto& vertex : panel["vertices"])
            vertex[0] = share * vertex[0].get<double>();
    write_text(folder / "small.json", pattern.dump());
    write_text(folder / "small.toile.json", R"({"toile": 1, "fabric": "poplin"})");
}

} // namespace

TEST_CASE("a garment drapes in a fabric of one's own, and says what its method makes of the curves") {
    const TempFolder folder;
    const std::string tee = TOILE_SOURCE_DIR "/examples/tee.json", own = folder / "own.json";
    const auto fabric = [&](double last) {
        write_text(own, R"({"toile_fabric": 1, "name": "interlock", "like": "jersey",
                            "stretch_warp": [[0, 0], [0.05, 6], [0.1, )" + std::to_string(last) + R"(]]})");
    };
    fabric(25);
    const auto first = drape({tee, "--edge-length", "60mm", "--fabric", own});
    CHECK(first["status"] == "converged");
    CHECK(first["fabric"] == "interlock");
    CHECK(first["stretch_curves"][0]["warp"] == nlohmann::json::parse("[[0.0, 0.0], [0.05, 6.0], [0.1, 25.0]]"));
    CHECK(decision(first, "stretch of interlock") == "the stretch of interlock follows its measured curves");
    fabric(20);
    const auto second = drape({tee, "--edge-length", "60mm", "--fabric", own, "--method", "springs-implicit"});
    CHECK(second["input_hash"] != first["input_hash"]);
    CHECK_THAT(decision(second, "stretch curves of interlock"),
               Contains("were replaced by their secants at 10 % of stretch: 200 N/m along the warp, 32"));
    write_text(own, R"({"toile_fabric": 1, "name": "interlock", "like": "jersey", "stretch_warp": [[0, 0]]})");
    const Run r = run_toile({"drape", tee, "--fabric", own, "-o", folder / "a.obj"});
    CHECK(r.code == 2);
    CHECK_THAT(r.err, Contains("own.json") && Contains("a stretch curve has 1 points"));
    CHECK(!std::filesystem::exists(folder / "a.obj"));
}

TEST_CASE("a staged mesh drapes as it is, with pins from its companion") {
    const TempFolder folder;
    write_text(folder / "stage.obj", staged_skirt());
    write_text(folder / "stage.toile.json", pins_at_the_top);
    const auto report = drape({folder / "stage.obj", "-o", folder / "a.obj"});
    CHECK(report["status"] == "converged");
    CHECK(report["fabric"] == "linen");
    CHECK(report["levels"].size() == 1);
    CHECK(report["vertices"] == 81 + 63);
    CHECK(report["triangles"] == 2 * 64 + 2 * 48);
    CHECK(report["pieces"] == 1);
    CHECK(report["intersections"]["cloth_cloth"] == 0);
    CHECK(report["seam_gap_max"] < 1e-5); // stitches to the inside of an edge stay springs
    CHECK_THAT(decision(report, "inside of an edge"), Contains("12 stitches"));
    CHECK_THAT(decision(report, "pinned"), Contains("6 nodes"));

    // Pinned nodes are where they were, and the rest is not.
    const ReadGarment g = read_garment(folder / "a.obj");
    CHECK((g.x[g.garment.node_of_vertex[76]] - Vec3(0, 0.7, 0.18)).norm() < 1e-12);
    CHECK(std::abs(g.x[g.garment.node_of_vertex[4]].z() - 0.18) > 1e-3);
    const auto seen = nlohmann::json::parse(run_toile({"inspect", folder / "a.obj", "--json"}).out);
    CHECK(seen["intersections"]["cloth_cloth"] == 0);
}

TEST_CASE("what a companion cannot say of a staged mesh is refused in a sentence") {
    const TempFolder folder;
    write_text(folder / "stage.obj", staged_skirt());
    for (const char* companion :
         {R"({"toile": 1, "panels": {"front": {"grain": 45}}})", R"({"toile": 1, "panels": {"sleeve": {}}})",
          R"({"toile": 1, "seams": [{"a": {"panel": "front", "edge": 0, "to": 0.5},
              "b": {"panel": "back", "edge": 0, "to": 0.5}}]})"}) {
        write_text(folder / "stage.toile.json", companion);
        const Run r = run_toile({"check", folder / "stage.obj"});
        CHECK(r.code == 2);
        CHECK(one_sentence(r.err));
        CHECK_THAT(r.err, Contains("stage.toile.json"));
    }
}

TEST_CASE("check says what a staged mesh is, flat refuses it") {
    const TempFolder folder;
    write_text(folder / "stage.obj", staged_skirt());
    const Run r = run_toile({"check", folder / "stage.obj"});
    CHECK(r.code == 0);
    CHECK_THAT(r.out, Contains("panel front") && Contains("the seam of panels front and back") &&
                          Contains("2 panels, 18 stitches, 12 of them to the inside of an edge"));
    const auto json = nlohmann::json::parse(run_toile({"check", folder / "stage.obj", "--json"}).out);
    CHECK(json["seams"][0]["stitches"] == 18);
    const Run flat = run_toile({"flat", folder / "stage.obj", "-o", folder / "a.svg"});
    CHECK(flat.code == 2);
    CHECK(one_sentence(flat.err));
    CHECK_THAT(flat.err, Contains("staged mesh"));
}

TEST_CASE("an elastic waist is drawn in and keeps the skirt up, and its cloth keeps its limits") {
    const TempFolder folder;
    // Cut wide enough to fall off, at every height of the hips.
    nlohmann::json pattern = nlohmann::json::parse(read_file(skirt, 1 << 20));
    for (auto& panel : pattern["pattern"]["panels"])
        for (auto& vertex : panel["vertices"])
            vertex[0] = 1.4 * vertex[0].get<double>();
    write_text(folder / "wide.json", pattern.dump());
    write_text(folder / "wide.toile.json", R"({"toile": 1, "fabric": "poplin"})");
    const auto fallen =
        drape({folder / "wide.json", "--edge-length", "60mm", "-o", folder / "fallen.obj"}, 3);
    CHECK(fallen["status"] == "slid_off");
    CHECK(fallen["levels"].back()["iterations"] < 300); // it is not followed to the floor
    CHECK_THAT(fallen["where"].get<std::string>(), Contains("lower_interface") && Contains("slid"));
    const auto finer = drape({folder / "wide.json", "--edge-length", "15mm", "-o", folder / "finer.obj"}, 3);
    CHECK(finer["status"] == "slid_off");
    CHECK(finer["levels"][1]["iterations"] < 50); // nor on a level that is not the last,
    CHECK(finer["levels"][2]["iterations"] < 20); // and no more on those after it

    for (auto& panel : pattern["pattern"]["panels"])
        for (auto& edge : panel["edges"]) edge.erase("label");
    write_text(folder / "bare.json", pattern.dump());
    write_text(folder / "bare.toile.json", R"({"toile": 1, "fabric": "poplin"})");
    const auto bare = drape({folder / "bare.json", "--edge-length", "60mm", "-o", folder / "bare.obj"}, 3);
    CHECK(bare["status"] == "slid_off");
    CHECK_THAT(bare["where"].get<std::string>(), Contains("no labelled edge") && Contains("slid down"));

    write_text(folder / "wide.toile.json", R"({"toile": 1, "fabric": "poplin",
        "elastics": [{"label": "lower_interface", "ratio": 0.7, "stiffness": 30}]})");
    const auto report = drape({folder / "wide.json", "--edge-length", "40mm", "-o", folder / "a.obj"});
    CHECK(report["status"] == "converged");
    CHECK_THAT(decision(report, "elastic bands"), Contains("pull with up to"));
    CHECK(report["strain"]["warp"]["max"] <= report["strain"]["warp"]["limit"]);
    CHECK(report["strain"]["weft"]["max"] <= report["strain"]["weft"]["limit"]);
    CHECK(report["intersections"]["cloth_avatar"] == 0);
}

TEST_CASE("hooks that are to be held stay on, by the file's label or by a plain word") {
    for (const char* word : {"waist", "lower_interface"}) {
        const auto report = drape({skirt, "--edge-length", "60mm", "--hold", word});
        CHECK(report["status"] == "converged");
        CHECK_THAT(decision(report, "hooks"), Contains("held") && Contains("to the end, as asked"));
    }
    const TempFolder folder;
    const Run r = run_toile({"drape", skirt, "--hold", "collar", "--report", folder / "a.json"});
    CHECK(r.code == 2);
    CHECK(one_sentence(r.err));
    CHECK_THAT(r.err, Contains("collar") && Contains("lower_interface"));
}

TEST_CASE("a skirt that is too small says so, where, and how much is missing") {
    const TempFolder folder;
    write_narrow_skirt(folder, 0.9);
    const auto report = drape({folder / "small.json", "--edge-length", "20mm", "-o", folder / "a.obj"}, 3);
    CHECK(report["status"] == "too_small");
    const std::string where = report["where"];
    CHECK_THAT(where, Contains("panel \"") && Contains("cm are missing"));
    // A waist of 73 cm, made narrower and stretched by 3 %, half a millimetre off one of 72.
    CHECK(std::stod(where.substr(where.find("allows; ") + 8)) == Approx(72 + 2 * EIGEN_PI * 0.05 - 0.9 * 73 * 1.03).margin(0.9));
    CHECK(read_garment(folder / "a.obj").x.size() == report["nodes"].get<std::size_t>());
}

TEST_CASE("a skirt that is a little too small comes to rest, beyond the limits of its fabric") {
    const TempFolder folder;
    write_narrow_skirt(folder, 0.98);
    const auto report = drape({folder / "small.json", "--edge-length", "60mm"}, 3);
    CHECK(report["status"] == "too_small");
    CHECK(report["residual"] <= 1e-3);
    CHECK(report["strain"]["weft"]["max"] > report["strain"]["weft"]["limit"]);
}

TEST_CASE("a seam that cannot close ends the drape with its name, its gap and what is in the way") {
    const TempFolder folder;
    // Two strips far before and behind the body, too short to meet round it, each with cloth enough to be slack.
    std::string pattern = skirt_pattern(8, 50);
    write_text(folder / "strips.json", pattern);
    const auto report = drape({folder / "strips.json", "--edge-length", "40mm", "-o", folder / "a.obj"}, 3);
    CHECK((report["status"] == "stalled" || report["status"] == "too_small"));
    const std::string where = report["where"];
    CHECK_THAT(where, Contains("front.1") && Contains("back.3") || Contains("front.3") && Contains("back.1"));
    CHECK_THAT(where, Contains("mm are left between") && Contains("the body is between them at"));
    CHECK(report["seam_gap_max"] > 0.05);
    CHECK(report["pieces"] == 2);
    CHECK(report["intersections"]["cloth_avatar"] == 0);
}

TEST_CASE("an edited pattern drapes from the earlier result in less work than from scratch") {
    const TempFolder folder;
    const auto first = drape({skirt, "--edge-length", "30mm", "-o", folder / "a.obj"});
    REQUIRE(first["status"] == "converged");
    // The edit: 3 cm longer.
    nlohmann::json pattern = nlohmann::json::parse(read_file(skirt, 1 << 20));
    for (auto& panel : pattern["pattern"]["panels"]) {
        double hem = INFINITY;
        for (const auto& vertex : panel["vertices"])
            hem = std::min(hem, vertex[1].get<double>());
        for (auto& vertex : panel["vertices"])
            if (vertex[1].get<double>() < hem + 1) vertex[1] = vertex[1].get<double>() - 3;
    }
    write_text(folder / "longer.json", pattern.dump());
    write_text(folder / "longer.toile.json", R"({"toile": 1, "fabric": "wool"})");
    const auto scratch = drape({folder / "longer.json", "--edge-length", "30mm"});
    const auto again = drape({folder / "longer.json", "--edge-length", "30mm", "--from", folder / "a.obj"});
    CHECK(again["status"] == "converged");
    CHECK(again["levels"].size() == 1);
    CHECK_THAT(decision(again, "earlier drape"), Contains("one level"));
    int work = 0;
    for (const auto& level : scratch["levels"])
        work += level["iterations"].get<int>();
    CHECK(again["levels"][0]["iterations"].get<int>() < work);
    CHECK(again["intersections"]["cloth_avatar"] == 0);
    CHECK(again["intersections"]["cloth_cloth"] == 0);
}

namespace {

/// Raises a signal when the progress line says that the second level settles.
class Interrupting : public std::stringbuf {
protected:
    std::streamsize xsputn(const char* text, std::streamsize count) override {
        if (!raised_ && std::string(text, std::size_t(count)).find("settle  level 2") != std::string::npos) {
            raised_ = true;
            std::raise(SIGINT);
        }
        return std::stringbuf::xsputn(text, count);
    }

private:
    bool raised_ = false;
};

} // namespace

TEST_CASE("Ctrl-C writes the state reached and says so") {
    const TempFolder folder;
    Interrupting buffer;
    std::ostream err(&buffer);
    std::ostringstream out;
    const int code = run_command_line({"drape", skirt, "--edge-length", "30mm", "-o", folder / "a.obj", "--report",
                                       folder / "a.json"},
                                      {out, err, true});
    CHECK(code == 3);
    CHECK_THAT(buffer.str(), Contains("toile: stopped by a signal; the state reached was written"));
    const std::string text = read_file(folder / "a.json", 1 << 24);
    CHECK(Schema("report.schema.json").complaints(text) == "");
    const auto report = nlohmann::json::parse(text);
    CHECK(report["status"] == "limit");
    CHECK_THAT(report["where"].get<std::string>(), Contains("signal"));
    CHECK(read_garment(folder / "a.obj").x.size() == report["nodes"].get<std::size_t>());
}

TEST_CASE("a time limit ends a drape with the state reached, and durations need a unit") {
    const TempFolder folder;
    const auto report = drape({skirt, "--edge-length", "20mm", "--max-seconds", "0.5s", "-o", folder / "a.obj"}, 3);
    CHECK(report["status"] == "limit");
    CHECK_THAT(report["where"].get<std::string>(), Contains("time limit") && Contains("stage"));
    CHECK(read_garment(folder / "a.obj").x.size() == report["nodes"].get<std::size_t>());
    for (const char* wrong : {"5", "soon", "5 parsecs", "-1s", "inf"}) {
        const Run r = run_toile({"drape", skirt, "--max-seconds", wrong, "-o", folder / "b.obj"});
        CHECK(r.code == 1);
        CHECK(one_sentence(r.err));
    }
}

TEST_CASE("a memory limit ends a drape before it is exceeded, and sizes need a unit") {
    const TempFolder folder;
    const auto limit = [](double bytes) { return std::to_string(bytes / 1e6) + "MB"; };
#ifdef __SANITIZE_ADDRESS__
    constexpr double room = 200e6; // of which the sanitizer takes more than half
#else
    constexpr double room = 90e6;
#endif
    // Room for the coarse levels: the fine one is not begun, and they are written.
    const auto coarse = drape({skirt, "--edge-length", "10mm", "--max-memory", limit(memory_use().now + room), "-o",
                               folder / "a.obj", "-o", folder / "a.glb"},
                              3);
    CHECK(coarse["status"] == "limit");
    CHECK_THAT(coarse["where"].get<std::string>(), Contains("memory limit of") && Contains("level 3 would have taken") &&
                                                       Contains("level 2 of 3"));
    CHECK(coarse["seam_gap_max"] == 0.0);
    CHECK(coarse["intersections"]["cloth_avatar"] == 0);
    CHECK(read_garment(folder / "a.obj").x.size() == coarse["nodes"].get<std::size_t>());
    CHECK(read_garment(folder / "a.glb").garment.triangles.size() == coarse["triangles"].get<std::size_t>());
    // No room at all: the garment as it was placed, seams open.
    write_text(folder / "stage.obj", staged_skirt());
    const auto placed = drape({folder / "stage.obj", "--max-memory", "1MB", "-o", folder / "c.obj"}, 3);
    CHECK_THAT(placed["where"].get<std::string>(), Contains("memory limit of 1 MB") && Contains("level 1 would have taken"));
    CHECK(placed["seam_gap_max"] > 0.1);
    CHECK(placed["residual"].is_null());
    CHECK(read_garment(folder / "c.obj").x.size() == placed["nodes"].get<std::size_t>());
    // Not even for the flat mesh.
    const Run fine = run_toile({"drape", skirt, "--edge-length", "2mm", "--max-memory", "20MB", "-o", folder / "b.obj"});
    CHECK(fine.code == 2);
    CHECK(one_sentence(fine.err));
    CHECK_THAT(fine.err, Contains("triangles") && Contains("--max-memory"));
    for (const char* wrong : {"500", "lots", "500mb", "5kB", "-1GB", "0.5MB", "inf"}) {
        const Run r = run_toile({"drape", skirt, "--max-memory", wrong, "-o", folder / "b.obj"});
        CHECK(r.code == 1);
        CHECK(one_sentence(r.err));
    }
    CHECK_FALSE(std::filesystem::exists(folder / "b.obj"));
}

TEST_CASE("a dress staged by another program is draped as it came") {
    const auto stage = test_data("cipc/dress_knife/stage.obj"), body = test_data("cipc/wm2_15k.obj");
    if (!stage || !body) return;
    const TempFolder folder;
    // All of it takes minutes; this sees that sewing starts, and that what is written has every vertex.
    const auto report = drape({*stage, "--avatar", *body, "--repair-avatar", "--max-seconds", "5s", "-o",
                               folder / "a.obj"},
                              3);
    CHECK(report["status"] == "limit");
    CHECK(report["vertices"] == 15656);
    CHECK_THAT(decision(report, "left out"), Contains("two corners of a triangle"));
    CHECK(report["intersections"]["cloth_avatar"] == 0);
}

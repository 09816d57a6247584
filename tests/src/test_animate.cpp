// SPDX-License-Identifier: GPL-3.0-or-later
// A garment let go, by the command: what the frames it writes hold to.
#include "io/read_garment.h"
#include "io/write_garment.h"
#include "tests/src/run.h"
#include "tests/support/khronos.h"
#include "tests/support/read_cache.h"
#include "tests/support/schema.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <filesystem>
#include <numbers>

using namespace toile;
using namespace toile::test;
using Catch::Contains;

namespace {

const std::string skirt = TOILE_SOURCE_DIR "/examples/skirt.json";

constexpr int columns = 2, rows = 20;
constexpr double cell = 0.05, length = rows * cell, gravity = 9.81;
constexpr double plane = 0.75; // m before the body's middle: near enough to be seen to be y up

/// Share of the strip's mass at a node.
double mass(int node) {
    const int i = node % (columns + 1), j = node / (columns + 1);
    return (i == 0 || i == columns ? 0.5 : 1) * (j == 0 || j == rows ? 0.5 : 1) / (columns * rows);
}

/// A strip of cloth clear of the body, held along its upper edge, whose cloth is `across(s)` off its plane and `up(s)` above its
/// lower end, s (m) from that.
template <class Across, class Up>
std::string hung_strip(const TempFolder& folder, Across across, Up up) {
    std::ostringstream obj;
    for (int j = 0; j <= rows; ++j)
        for (int i = 0; i <= columns; ++i)
            obj << "v " << i * cell << ' ' << 0.5 + up(j * cell) << ' ' << plane + across(j * cell) << "\nvt " << i * cell << ' '
                << j * cell << '\n';
    obj << "g strip\n";
    const auto corner = [&](int i, int j) {
        const std::string n = std::to_string(j * (columns + 1) + i + 1);
        return ' ' + n + '/' + n;
    };
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i)
            obj << 'f' << corner(i, j) << corner(i + 1, j) << corner(i + 1, j + 1) << "\nf" << corner(i, j)
                << corner(i + 1, j + 1) << corner(i, j + 1) << '\n';
    // The border runs along the bottom and up the right side first.
    write_text(folder / "strip.toile.json",
               R"({"toile": 1, "fabric": "poplin", "pins": [{"panel": "strip", "edge": 0, "from": 0.4999, "to": 0.5456}]})");
    return write_text(folder / "strip.obj", obj.str());
}

nlohmann::json animate(const std::vector<std::string>& words) {
    std::vector<std::string> all{"drape"};
    all.insert(all.end(), words.begin(), words.end());
    all.push_back("--json");
    const Run r = run_toile(all);
    INFO(r.err);
    REQUIRE(r.code == 0);
    CHECK(Schema("report.schema.json").complaints(r.out) == "");
    return nlohmann::json::parse(r.out);
}

/// The sum over the strip of mass times f(place).
template <class F>
double over(const Points& x, F f) {
    double sum = 0;
    for (int i = 0; i < int(x.size()); ++i) sum += mass(i) * f(i, x[std::size_t(i)]);
    return sum;
}

/// Kinetic energy and that of the height above hanging straight down, by mass, in every frame but the first and the last.
std::vector<double> energies(const std::vector<Points>& frames, double rate) {
    std::vector<double> all;
    for (std::size_t k = 1; k + 1 < frames.size(); ++k) {
        const double low = over(frames[k], [&](int i, const Vec3&) { return 0.5 + length - (rows - i / (columns + 1)) * cell; });
        all.push_back(over(frames[k], [&](int i, const Vec3& p) {
            const Vec3 v = 0.5 * rate * (frames[k + 1][std::size_t(i)] - frames[k - 1][std::size_t(i)]);
            return 0.5 * v.squaredNorm() + gravity * p.y();
        }) - gravity * low);
    }
    return all;
}

} // namespace

TEST_CASE("a hanging strip swings in the frames as theory says", "[animate]") {
    // A chain's lowest swing, J_0(2 w sqrt(s / g)) with s from its lower end; implicit steps of h lose w^2 h / 2 of it per second.
    const double w = 0.5 * 2.404825558 * std::sqrt(gravity / length);
    const auto shape = [&](double s) { return std::cyl_bessel_j(0, 2 * w * std::sqrt(s / gravity)); };
    const TempFolder folder;
    const std::string strip = hung_strip(folder, [&](double s) { return 0.02 * shape(s); }, [](double s) { return s; });
    for (const std::string method : {"springs-explicit", "springs-implicit", "equilibrium"}) {
        INFO(method);
        const auto report = animate({strip, "--method", method, "--animate", "3s", "--fps", "30", "--air-damping", "0", "-o",
                                     folder / "a.obj"});
        CHECK(report["status"] == "animated");
        CHECK(report["motion"]["frames"] == 91);
        CHECK(report["motion"]["duration"] == 3.0);
        CHECK(report["motion"]["slowed"] == 0);
        const double h = report["motion"]["time_step"];
        CHECK(h * report["motion"]["steps_per_frame"].get<int>() == Approx(1.0 / 30).epsilon(1e-12));
        const std::vector<Points> frames = read_pc2(folder / "a.pc2", 30).frames;
        REQUIRE(frames.size() == 91);
        std::vector<double> swing, zeros;
        for (const Points& x : frames)
            swing.push_back(over(x, [&](int i, const Vec3& p) { return shape(i / (columns + 1) * cell) * (p.z() - plane); }));
        for (std::size_t k = 0; k + 1 < swing.size(); ++k)
            if (swing[k] * swing[k + 1] <= 0) zeros.push_back((double(k) + swing[k] / (swing[k] - swing[k + 1])) / 30);
        REQUIRE(zeros.size() == 4);
        const double period = 2 * (zeros[3] - zeros[0]) / 3;
        CHECK(period == Approx(2 * std::numbers::pi / w).epsilon(0.02));
        const auto widest = [&](double begin, double end) { // through three frames
            double most = 0;
            for (std::size_t k = std::size_t(begin * 30) + 1; k < std::size_t(end * 30); ++k) most = std::max(most, std::abs(swing[k]));
            return most;
        };
        const double left = widest(zeros[2], zeros[3]) / widest(zeros[0], zeros[1]);
        const double expected = method == "springs-explicit" ? 1 : std::exp(-0.5 * w * w * h * period);
        CHECK(left == Approx(expected).epsilon(0.01));
    }
}

TEST_CASE("a wide swing keeps its energy by explicit steps and only loses by implicit ones", "[animate]") {
    const TempFolder folder;
    const double angle = 0.5;
    const std::string strip = hung_strip(folder, [&](double s) { return (length - s) * std::sin(angle); },
                                         [&](double s) { return length - (length - s) * std::cos(angle); });
    const double start = gravity * 0.5 * length * (1 - std::cos(angle));
    for (const std::string method : {"springs-explicit", "springs-implicit"}) {
        INFO(method);
        animate({strip, "--method", method, "--animate", "2s", "--fps", "240", "--air-damping", "0", "-o", folder / "a.obj"});
        const std::vector<double> energy = energies(read_pc2(folder / "a.pc2", 240).frames, 240);
        REQUIRE(energy.size() == 479);
        double least = start, highest_step = 0;
        for (const double e : energy) {
            highest_step = std::max(highest_step, e - least);
            least = std::min(least, e);
        }
        INFO(energy.back() / start << ' ' << least / start << ' ' << highest_step / start);
        if (method == "springs-explicit") {
            CHECK(*std::max_element(energy.begin(), energy.end()) < 1.05 * start);
            CHECK(least > 0.95 * start);
        } else {
            CHECK(highest_step < 0.01 * start); // what the cloth's stretch gives back
            CHECK(energy.back() < 0.95 * start);
        }
    }
    // Air takes that share of the momentum per second, and of a swing's energy, half of which is of motion, the same.
    animate({strip, "--method", "springs-explicit", "--animate", "1s", "--fps", "240", "--air-damping", "2", "-o", folder / "a.obj"});
    const double left = energies(read_pc2(folder / "a.pc2", 240).frames, 240).back() / start;
    CHECK(left > 0.7 * std::exp(-2));
    CHECK(left < 1.4 * std::exp(-2));
}

TEST_CASE("triangles swing alike by either second derivative, and the report says by which", "[animate]") {
    const TempFolder folder;
    const std::string strip = hung_strip(folder, [](double s) { return 0.3 * (length - s); },
                                         [](double s) { return length - std::sqrt(0.91) * (length - s); });
    const auto swing = [&](const std::vector<std::string>& how) {
        std::vector<std::string> words{strip, "--method", "triangles", "--animate", "0.5s", "-o", folder / "a.obj"};
        words.insert(words.end(), how.begin(), how.end());
        const auto report = animate(words);
        return std::pair(report, read_pc2(folder / "a.pc2", 24).frames.back());
    };
    const auto [projected, p] = swing({"--hessian", "projected"});
    const auto [exact, e] = swing({"--hessian", "exact"});
    double apart = 0;
    for (std::size_t i = 0; i < p.size(); ++i) apart = std::max(apart, (p[i] - e[i]).norm());
    CHECK(apart > 1e-7);
    CHECK(apart < 0.01 * length);
    CHECK(exact["input_hash"] != projected["input_hash"]);
    CHECK_THAT(exact["decisions"].dump(), Contains("solved with the exact second derivative of its energy"));
    CHECK_THAT(projected["decisions"].dump(), Contains("solved with a positive semidefinite second derivative of its energy"));
}

TEST_CASE("an animated skirt: caches, GLB, report and garment agree, for any number of threads", "[animate]") {
    const TempFolder folder;
    const auto run = [&](const std::string& name, const std::string& threads) {
        return animate({skirt, "--edge-length", "60mm", "--method", "springs-implicit", "--animate", "0.25s", "-o",
                        folder / (name + ".obj"), "-o", folder / (name + ".glb"), "--preview", folder / (name + ".png"),
                        "--threads", threads});
    };
    const auto report = run("a", "1");
    CHECK(report["status"] == "animated");
    CHECK(report["contact"]["response"] == "impulse");
    CHECK(report["contact"]["guarantee"] == "no_crossing");
    CHECK(report["intersections"]["cloth_avatar"] == 0);
    CHECK(report["intersections"]["cloth_cloth"] == 0);
    CHECK(report["seam_gap_max"] == 0.0);
    CHECK(report["motion"]["frames"] == 7);
    CHECK(report["motion"]["air_damping"] == 1.0);
    bool told = false;
    for (const auto& d : report["decisions"]) told = told || d.get<std::string>().find("7 frames at 24 per second") != std::string::npos;
    CHECK(told);

    const ReadGarment garment = read_garment(folder / "a.obj");
    const ReadFrames pc2 = read_pc2(folder / "a.pc2", 24), mdd = read_mdd(folder / "a.mdd");
    CHECK(farthest(pc2.frames, mdd.frames) == 0);
    REQUIRE(pc2.frames.size() == 7);
    const Points end = rounded_to_float(garment.x);
    CHECK(farthest({pc2.frames.back()}, {end}) == 0);
    double fell = 0;
    for (std::size_t i = 0; i < end.size(); ++i) fell += (pc2.frames[0][i].y() - end[i].y()) / double(end.size());
    CHECK(fell > 0.005);
    // Let go from rest: in the first frame's time no point falls by more than a free one.
    for (std::size_t i = 0; i < end.size(); ++i)
        CHECK(pc2.frames[0][i].y() - pc2.frames[1][i].y() < 0.5 * gravity / (24 * 24) * 1.06); // implicit: n (n + 1) h^2 / 2
    const PlayedGlb played = GlbFile(folder / "a.glb").play();
    REQUIRE(played.vertices.frames.size() == 7);
    for (std::size_t k = 0; k < 7; ++k) {
        CHECK(played.vertices.times[k] == Approx(double(k) / 24));
        double off = 0;
        for (std::size_t v = 0; v < played.node.size(); ++v)
            off = std::max(off, (played.vertices.frames[k][v] - pc2.frames[k][std::size_t(played.node[v])]).norm());
        CHECK(off < 2e-7);
    }
    if (const auto accepted = khronos_accepts(folder / "a.glb")) CHECK(*accepted);

    const auto second = run("b", "2");
    CHECK(second["result_hash"] == report["result_hash"]);
    CHECK(second["input_hash"] == report["input_hash"]);
    for (const char* ending : {".pc2", ".mdd", ".glb"})
        CHECK(read_file(folder / ("a" + std::string(ending)), 1 << 26) == read_file(folder / ("b" + std::string(ending)), 1 << 26));
}

TEST_CASE("an animation that is stopped or blows up writes the frames it has and says so", "[animate]") {
    const TempFolder folder;
    const std::string strip = hung_strip(folder, [](double) { return 0; }, [](double s) { return s; });
    const Run r = run_toile({"drape", strip, "--method", "springs-explicit", "--time-step", "20ms", "--animate", "1s", "-o",
                             folder / "a.obj", "--json"});
    CHECK(r.code == 3);
    const auto report = nlohmann::json::parse(r.out);
    CHECK(report["status"] == "stalled");
    CHECK_THAT(report["where"].get<std::string>(), Contains("blew up") && Contains("of 1 s"));
    CHECK(read_pc2(folder / "a.pc2", 24).frames.size() == report["motion"]["frames"].get<std::size_t>());
    CHECK(report["motion"]["frames"] < 25);

    const Run stopped = run_toile({"drape", skirt, "--edge-length", "40mm", "--animate", "60s", "--max-seconds", "2s", "-o",
                                   folder / "b.obj", "--json"});
    CHECK(stopped.code == 3);
    const auto short_report = nlohmann::json::parse(stopped.out);
    CHECK(short_report["status"] == "limit");
    CHECK_THAT(short_report["where"].get<std::string>(), Contains("time limit"));
    CHECK(farthest({read_pc2(folder / "b.pc2", 24).frames.back()}, {rounded_to_float(read_garment(folder / "b.obj").x)}) == 0);
    CHECK(Schema("report.schema.json").complaints(stopped.out) == "");

    // Not even sewn.
    CHECK(run_toile({"drape", skirt, "--edge-length", "40mm", "--animate", "1s", "--max-seconds", "1ms", "-o", folder / "c.obj",
                     "-o", folder / "c.glb", "--quiet"})
              .code == 3);
    CHECK(read_pc2(folder / "c.pc2", 24).frames.size() == 1);
    CHECK(farthest(read_mdd(folder / "c.mdd").frames, {rounded_to_float(read_garment(folder / "c.obj").x)}) == 0);
}

TEST_CASE("animations that cannot be are refused in a sentence", "[animate]") {
    const TempFolder folder;
    const std::string out = folder / "a.obj";
    for (const std::vector<std::string>& wrong : std::vector<std::vector<std::string>>{
             {"--animate", "0s", "-o", out},
             {"--animate", "-1s", "-o", out},
             {"--animate", "3", "-o", out},
             {"--animate", "1s", "--fps", "0", "-o", out},
             {"--animate", "1s", "--fps", "nan", "-o", out},
             {"--animate", "10ms", "-o", out},
             {"--animate", "1s", "--json"},
             {"--animate", "1s", "--contact", "barrier", "-o", out},
             {"--animate", "1s", "--air-damping", "-1", "-o", out},
             {"--animate", "1s", "--avatar-sequence", "frames", "-o", out},
             {"--avatar-sequence", "frames", "--fps", "24", "-o", folder / "a.glb"},
             {"--fps", "25", "-o", out},
             {"--air-damping", "2", "-o", out}}) {
        std::vector<std::string> words{"drape", skirt};
        words.insert(words.end(), wrong.begin(), wrong.end());
        const Run r = run_toile(words);
        INFO(r.err);
        CHECK(r.code == 1);
        CHECK(one_sentence(r.err));
    }
    const auto refused = [&](std::vector<std::string> words) {
        words.insert(words.begin(), {"drape", skirt, "--edge-length", "40mm", "--animate"});
        const Run r = run_toile(words);
        CHECK(r.code == 2);
        CHECK(one_sentence(r.err));
        CHECK(std::filesystem::is_empty(folder.path()));
        return r.err;
    };
    CHECK_THAT(refused({"3600s", "--fps", "1000", "-o", out}), Contains("3600001 frames") && Contains("memory"));
    CHECK_THAT(refused({"100s", "--fps", "1000", "-o", folder / "a.glb"}), Contains("GLB"));
    CHECK_THAT(refused({"1s", "-o", folder / "missing/a.obj"}), Contains("cannot write"));
    std::filesystem::create_directory(folder / "b.pc2");
    const Run r = run_toile({"drape", skirt, "--animate", "1s", "-o", folder / "b.obj"});
    CHECK(r.code == 2);
    CHECK_THAT(r.err, Contains("b.pc2") && Contains("folder"));
}

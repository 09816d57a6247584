// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/write_file.h"
#include "io/write_garment.h"
#include "src/drape_input.h"
#include "src/quantity.h"
#include "src/pipeline.h"
#include "src/progress.h"
#include "tests/src/run.h"
#include "tests/support/skirt.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <csignal>
#include <filesystem>
#include <limits>

using namespace toile;
using namespace toile::test;
using Catch::Contains;

TEST_CASE("lengths take units and need them") {
    CHECK(parse_length("10mm") == Approx(0.01));
    CHECK(parse_length("1cm") == Approx(0.01));
    CHECK(parse_length("0.01m") == Approx(0.01));
    CHECK(parse_length("1.68m") == Approx(1.68));
    for (const char* bad : {"", "10", "mm", "10ft", "1e999m", "nanm", "10 mm", "10mmm", "1,5cm"})
        CHECK_THROWS_AS(parse_length(bad), CommandLineError);
    CHECK(show_length(0.01) == "10 mm");
    CHECK(show_length(1.68) == "1.68 m");
}

TEST_CASE("sizes take units and need them") {
    CHECK(parse_size("500MB") == 5e8);
    CHECK(parse_size("1MiB") == 1048576);
    CHECK(parse_size("1.5GB") == 1.5e9);
    CHECK(parse_size("2GiB") == 2147483648.0);
    for (const char* bad : {"", "500", "GB", "5TB", "5 GB", "5gb"})
        CHECK_THROWS_AS(parse_size(bad), CommandLineError);
    CHECK(show_size(5e8) == "500 MB");
}

TEST_CASE("a command line that cannot be used has exit code 1 and one sentence") {
    const std::vector<std::vector<std::string>> lines = {
        {},
        {"sew"},
        {"drape"},
        {"drape", "a.json"},
        {"drape", "a.json", "-o", "a.fbx"},
        {"drape", "a.json", "-o"},
        {"drape", "a.json", "b.json", "-o", "a.obj"},
        {"drape", "a.json", "-o", "a.obj", "--edge-length", "10"},
        {"drape", "a.json", "-o", "a.obj", "--edge-length", "-10mm"},
        {"drape", "a.json", "-o", "a.obj", "--edge-length", "10km"},
        {"drape", "a.json", "-o", "a.obj", "--edge-length", "1m"},
        {"drape", "a.json", "-o", "a.obj", "--clearance", "0.5"},
        {"drape", "a.json", "-o", "a.obj", "--friction", "-0.1"},
        {"drape", "a.json", "-o", "a.obj", "--cloth-friction", "much"},
        {"drape", "a.json", "-o", "a.obj", "--tolerance", "0"},
        {"drape", "a.json", "-o", "a.obj", "--tolerance", "small"},
        {"drape", "a.json", "-o", "a.obj", "--fabric", "tweed"},
        {"drape", "a.json", "-o", "a.obj", "--unit", "inch"},
        {"drape", "a.json", "-o", "a.obj", "--up", "x"},
        {"drape", "a.json", "-o", "a.obj", "--threads", "-1"},
        {"drape", "a.json", "-o", "a.obj", "--height", "9m"},
        {"drape", "a.json", "-o", "a.obj", "--repair-avatar"},
        {"drape", "a.json", "-o", "a.obj", "--no-such-option"},
        {"form"},
        {"form", "-o", "a.stl"},
        {"form", "--bust", "90", "-o", "a.obj"},
        {"flat", "a.json"},
        {"flat", "a.json", "-o", "a.png"},
        {"compare", "a.obj"},
        {"inspect"},
        {"untangle"},
        {"untangle", "a.obj"},
        {"untangle", "a.obj", "-o", "b.stl"},
        {"untangle", "a.obj", "-o", "b.obj", "--clearance", "1"},
        {"untangle", "a.obj", "-o", "b.obj", "--repair-avatar"},
    };
    for (const auto& line : lines) {
        const Run r = run_toile(line);
        INFO(Catch::StringMaker<std::vector<std::string>>::convert(line) << " said " << r.err);
        CHECK(r.code == 1);
        CHECK(one_sentence(r.err));
        CHECK(r.out.empty());
    }
    CHECK_THAT(run_toile({"drape", "a.json", "-o", "a.obj", "--edge-length", "10"}).err,
               Contains("10mm") && Contains("--edge-length"));
    CHECK_THAT(run_toile({"sew"}).err, Contains("'sew'") && Contains("drape"));
    CHECK_THAT(run_toile({"drape", "a.json", "-o", "a.obj", "--fabric", "tweed"}).err, Contains("poplin"));
}

TEST_CASE("help and version are made, not errors") {
    const Run version = run_toile({"--version"});
    CHECK(version.code == 0);
    CHECK_THAT(version.out, Contains("toile " TOILE_VERSION) && Contains("BLAS ") && Contains("CHOLMOD") &&
                                Contains("CGAL"));
    CHECK(version.err.empty());
    const Run help = run_toile({"--help"});
    CHECK(help.code == 0);
    for (const char* command : {"drape", "check", "flat", "form", "inspect", "untangle", "compare", "rest"})
        CHECK_THAT(help.out, Contains(command));
    CHECK_THAT(run_toile({"drape", "--help"}).out, Contains("--edge-length") && Contains("poplin denim"));
}

TEST_CASE("levels go from 40 to 80 mm down to the edge length") {
    for (const double edge : {0.001, 0.005, 0.0075, 0.01, 0.0199, 0.02, 0.021, 0.04, 0.1}) {
        const double coarsest = edge * std::pow(2, levels_for(edge) - 1);
        CHECK(coarsest >= 0.04 - 1e-9);
        CHECK((coarsest < 0.08 || levels_for(edge) == 1));
    }
    CHECK(levels_for(0.01) == 3);
}

TEST_CASE("check prints both lengths and the ease of every seam, and what is wrong") {
    const TempFolder folder;
    const std::string good = write_text(folder / "skirt.json", skirt_pattern());
    const Run r = run_toile({"check", good});
    CHECK(r.code == 0);
    CHECK_THAT(r.out, Contains("500.0 mm     500.0 mm     0.0 %") && Contains("2 seams, 0 errors"));
    const auto json = nlohmann::json::parse(run_toile({"check", good, "--json"}).out);
    REQUIRE(json["seams"].size() == 2);
    CHECK(json["seams"][0]["a"].get<double>() == Approx(0.5));
    CHECK(json["issues"].empty());

    std::string text = skirt_pattern();
    text.replace(text.find("[30,50]"), 7, "[-20,-20]");
    const Run bad = run_toile({"check", write_text(folder / "bad.json", text)});
    CHECK(bad.code == 2);
    CHECK_THAT(bad.out, Contains("error: ") && Contains("front"));
    CHECK_FALSE(
        nlohmann::json::parse(run_toile({"check", folder / "bad.json", "--json"}).out)["issues"].empty());
}

TEST_CASE("flat draws the pattern") {
    const TempFolder folder;
    const Run r =
        run_toile({"flat", write_text(folder / "skirt.json", skirt_pattern()), "-o", folder / "skirt.svg"});
    CHECK(r.code == 0);
    const std::string svg = read_file(folder / "skirt.svg", 1 << 24);
    CHECK_THAT(svg, Contains("<svg") && Contains("front") && Contains("back"));
}

TEST_CASE("inspect and compare speak of written garments in both formats") {
    const TempFolder folder;
    const auto skirt = make_skirt(12, 8, 0.16, 1.0, 0.5);
    auto moved = skirt;
    for (Vec3& p : moved.x)
        p.y() += 0.003;
    write_garment(folder / "a.obj", skirt.garment, skirt.x);
    write_garment(folder / "b.glb", moved.garment, moved.x);

    const auto json =
        nlohmann::json::parse(run_toile({"compare", folder / "a.obj", folder / "b.glb", "--json"}).out);
    CHECK(json["same_triangles"] == true);
    CHECK(json["rms"].get<double>() == Approx(0.003).epsilon(1e-4));
    CHECK(json["max"].get<double>() == Approx(0.003).epsilon(1e-4));
    CHECK_THAT(run_toile({"compare", folder / "a.obj", folder / "b.glb"}).out,
               Contains("RMS 3.0000 mm") && Contains("max 3.0000 mm"));

    for (const char* name : {"a.obj", "b.glb"}) {
        const Run r = run_toile({"inspect", folder / name, "--fabric", "poplin", "--json"});
        CHECK(r.code == 0);
        const auto i = nlohmann::json::parse(r.out);
        CHECK(i["panels"] == 2);
        CHECK(i["pieces"] == 1);
        CHECK(i["border_loops"] == 2);
        CHECK(i["nodes"] == skirt.garment.node_count);
        CHECK(i["seam_gap_max"] == 0.0);
        CHECK(i["intersections"]["cloth_cloth"] == 0);
        CHECK_FALSE(i.contains("clearance_min"));
        CHECK(i["strain"]["warp"]["limit"].get<double>() > 0);
        // A circle of 12 chords to each half is shorter than its arc by 1/6 (pi / 24)^2.
        CHECK(i["strain"]["weft"]["mean"].get<double>() == Approx(-0.00286).epsilon(0.02));
        CHECK_THAT(run_toile({"inspect", folder / name}).out,
                   Contains("seams: closed") && Contains("1 connected piece"));
    }
}

TEST_CASE("progress says stage, level, residual, share done and time left") {
    CHECK(progress_text({"settle", 1, 3, 3.2e-2, 0.645, 12.2}) ==
          "settle  level 2 of 3  residual 3.2e-02  64 %  13 s left");
    const double unknown = std::numeric_limits<double>::infinity();
    CHECK(progress_text({"place", 0, 1, unknown, 0, unknown}) == "place  0 %");
    CHECK_THAT(progress_text({"sew", 0, 1, unknown, 0.5, 150}), Contains("3 min left"));
    std::ostringstream err;
    {
        ProgressLine hidden(err, false);
        hidden.show({"sew", 0, 1, unknown, 0.5, 1});
    }
    CHECK(err.str().empty());
    {
        ProgressLine shown(err, true);
        shown.show({"sew", 0, 1, unknown, 0.5, 1});
    }
    CHECK_THAT(err.str(), Catch::StartsWith("\r\033[Ksew") && Catch::EndsWith("\r\033[K"));
}

TEST_CASE("the first Ctrl-C is remembered") {
    const Interrupt interrupt;
    CHECK_FALSE(interrupt.asked());
    std::raise(SIGINT);
    CHECK(interrupt.asked());
}

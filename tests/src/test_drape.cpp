// SPDX-License-Identifier: GPL-3.0-or-later
// From a pattern file to draped files, by the command.
#include "io/read_garment.h"
#include "io/write_file.h"
#include "src/pipeline.h"
#include "tests/src/run.h"
#include "tests/support/khronos.h"
#include "tests/support/schema.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>

using namespace toile;
using namespace toile::test;
using Catch::Contains;

namespace {

const std::string tee = TOILE_SOURCE_DIR "/examples/tee.json";

nlohmann::json load_json(const std::string& path) {
    return nlohmann::json::parse(read_file(path, 1 << 24));
}

nlohmann::json inspection(const std::string& garment, const std::string& body) {
    return nlohmann::json::parse(
        run_toile({"inspect", garment, "--avatar", body, "--fabric", "jersey", "--json"}).out);
}

double warp_max(const nlohmann::json& figures) {
    return figures["strain"]["warp"]["max"];
}

/// What every file of a garment must be, by a look at the file alone.
void require_sound(const nlohmann::json& i) {
    CHECK(i["intersections"]["cloth_avatar"] == 0);
    CHECK(i["intersections"]["cloth_cloth"] == 0);
    CHECK(i["seam_gap_max"] == 0.0);
    CHECK(i["pieces"] == 1);
    CHECK(i["border_loops"] == 4); // neck, hem, two sleeves
    CHECK(i["turned_edges"] == 0);
    CHECK(i["clearance_min"].get<double>() >= 1e-5);
    CHECK(i["strain"]["warp"]["max"] <= i["strain"]["warp"]["limit"]);
    CHECK(i["strain"]["weft"]["max"] <= i["strain"]["weft"]["limit"]);
}

} // namespace

TEST_CASE("one command makes a garment, its report and its picture, and they agree") {
    const TempFolder folder;
    REQUIRE(run_toile({"form", "-o", folder / "form.obj", "--quiet"}).code == 0);
    const Run r =
        run_toile({"drape", tee, "--edge-length", "60mm", "-o", folder / "a.obj", "-o", folder / "a.glb",
                   "--report", folder / "a.json", "--preview", folder / "a.png", "--threads", "1"});
    INFO(r.err);
    REQUIRE(r.code == 0);
    CHECK_THAT(r.out, Contains("converged") && Contains("seams: closed") && Contains("a.mtl"));
    CHECK(read_file(folder / "a.png", 1 << 26).substr(1, 3) == "PNG");

    const nlohmann::json report = load_json(folder / "a.json");
    CHECK(Schema("report.schema.json").complaints(report.dump()) == "");
    CHECK(report["status"] == "converged");
    CHECK(report["residual"] <= report["tolerance"]);
    CHECK(report["threads"] == 1);
    CHECK(report["cloth_friction"] == 0.3);
    const auto says_so = [](const nlohmann::json& d) {
        return d.get<std::string>().find("of cloth on cloth with coefficient 0.3") != std::string::npos;
    };
    CHECK(std::any_of(report["decisions"].begin(), report["decisions"].end(), says_so));
    CHECK(report["stretch_curves"].size() == 1); // the tee is of jersey
    CHECK(report["stretch_curves"][0]["fabric"] == "jersey");
    CHECK(report["stretch_curves"][0]["weft"][0] == nlohmann::json{0.0, 0.0});
    CHECK(report["stretch_curves"][0]["weft"].back()[0] == 0.5);
    CHECK_THAT(report["blas"].get<std::string>(), Contains("OpenBLAS"));
    CHECK(report["ease"]["bust"]["ease"].get<double>() > 0);
    CHECK(report["seconds"]["total"].get<double>() >= report["seconds"]["sew"].get<double>());
    CHECK(report["seconds"]["total"].get<double>() > report["seconds"]["contact"].get<double>());
    CHECK(report["seconds"]["contact"].get<double>() > 0);

    const nlohmann::json obj = inspection(folder / "a.obj", folder / "form.obj");
    const nlohmann::json glb = inspection(folder / "a.glb", folder / "form.obj");
    require_sound(obj);
    require_sound(glb);
    for (const char* key : {"vertices", "nodes", "triangles", "pieces"}) {
        CHECK(obj[key] == report[key]);
        CHECK(glb[key] == report[key]);
    }
    CHECK(warp_max(obj) == Approx(warp_max(report)).margin(1e-12));
    CHECK(warp_max(glb) == Approx(warp_max(report)).margin(1e-5));
    if (const auto accepted = khronos_accepts(folder / "a.glb")) CHECK(*accepted);

    // The same bytes for another number of threads.
    REQUIRE(run_toile({"drape", tee, "--edge-length", "60mm", "-o", folder / "b.glb", "--report",
                       folder / "b.json", "--threads", "2", "--quiet"})
                .code == 0);
    CHECK(read_file(folder / "a.glb", 1 << 26) == read_file(folder / "b.glb", 1 << 26));
    const nlohmann::json second = load_json(folder / "b.json");
    CHECK(second["result_hash"] == report["result_hash"]);
    CHECK(second["input_hash"] == report["input_hash"]);

    // What it is started from is input as well.
    const Run again =
        run_toile({"drape", tee, "--edge-length", "60mm", "--from", folder / "a.obj", "--json"});
    INFO(again.err);
    REQUIRE(again.code == 0);
    const auto restarted = nlohmann::json::parse(again.out);
    CHECK(Schema("report.schema.json").complaints(again.out) == "");
    CHECK(restarted["input_hash"] != report["input_hash"]);
}

TEST_CASE("a drape that is stopped writes the state reached and says so") {
    const TempFolder folder;
    bool stop = false;
    int calls = 0;
    DrapeJob job;
    job.pattern = tee;
    job.edge_length = 0.06;
    job.garments = {folder / "a.obj"};
    job.report = folder / "a.json";
    job.drape.progress = [&](const DrapeProgress&) { return !(stop = ++calls > 20); };
    job.interrupted = [&] { return stop; };
    CHECK(run_job(job).result.status == DrapeStatus::limit);
    const nlohmann::json report = load_json(folder / "a.json");
    CHECK(Schema("report.schema.json").complaints(report.dump()) == "");
    CHECK(report["status"] == "limit");
    CHECK_THAT(report["where"].get<std::string>(), Contains("stopped"));
    CHECK(read_garment(folder / "a.obj").x.size() == report["nodes"].get<std::size_t>());
}

TEST_CASE("every response to contact drapes, and the report says what it promised") {
    const struct {
        const char* name;
        const char* guarantee;
        bool clean;
    } responses[] = {{"constraint", "no_node_in_body", false},
                     {"penalty", "none", false},
                     {"impulse", "no_crossing", true},
                     {"rigid", "no_crossing", true}};
    for (const auto& response : responses) {
        INFO(response.name);
        const Run r = run_toile({"drape", tee, "--edge-length", "60mm", "--contact", response.name, "--max-seconds",
                                 "20s", "--friction", "0.35", "--cloth-friction", "0.2", "--json"});
        const nlohmann::json report = nlohmann::json::parse(r.out);
        INFO(report["where"].get<std::string>());
        CHECK(Schema("report.schema.json").complaints(r.out) == "");
        CHECK(report["contact"]["response"] == response.name);
        CHECK(report["contact"]["guarantee"] == response.guarantee);
        CHECK(report["friction"] == 0.35);
        CHECK(report["cloth_friction"] == 0.2);
        CHECK(report["seam_gap_max"] == 0.0);
        const int crossings = report["intersections"]["cloth_avatar"].get<int>() +
                              report["intersections"]["cloth_cloth"].get<int>();
        if (response.clean) CHECK(crossings == 0);
        if (crossings > 0) CHECK(report["status"] != "converged");
        CHECK(r.code == (report["status"] == "converged" ? 0 : 3));
    }
    CHECK(run_toile({"drape", tee, "--contact", "rubber", "--json"}).code == 1);
}

TEST_CASE("every method drapes, says what it is, and what it did not reach", "[methods]") {
    const Schema schema("report.schema.json");
    for (const Method method : all_methods()) {
        const std::string name = to_string(method);
        INFO(name);
        const Run r = run_toile({"drape", tee, "--edge-length", "60mm", "--method", name, "--max-seconds", "12s", "--json"});
        const auto report = nlohmann::json::parse(r.out);
        CHECK(schema.complaints(r.out) == "");
        CHECK(report["method"] == name);
        CHECK(report["contact"]["response"] == "barrier");
        CHECK(r.code == (report["status"] == "converged" ? 0 : 3));
        if (report["contact"]["guarantee"] == "no_crossing") CHECK(report["intersections"]["cloth_avatar"] == 0);
        bool told = false;
        for (const auto& sentence : report["decisions"])
            told = told || sentence.get<std::string>().find("method \"" + name) != std::string::npos;
        CHECK(told == (method != Method::equilibrium));
    }
}

TEST_CASE("methods that find rest by Newton's steps converge with the barrier", "[methods]") {
    for (const Method method : all_methods()) {
        if (!settles(method)) continue;
        const std::string name = to_string(method);
        INFO(name);
        const Run r = run_toile({"drape", tee, "--edge-length", "60mm", "--method", name, "--max-seconds", "60s", "--json"});
        const auto report = nlohmann::json::parse(r.out);
        INFO(report["where"].get<std::string>());
        CHECK(r.code == 0);
        CHECK(report["status"] == "converged");
        CHECK(report["contact"]["guarantee"] == "no_crossing");
        CHECK(report["intersections"]["cloth_avatar"] == 0);
        CHECK(report["intersections"]["cloth_cloth"] == 0);
    }
}

TEST_CASE("steps in time that are too long end a drape in a sentence", "[methods]") {
    const Run r = run_toile({"drape", tee, "--edge-length", "60mm", "--method", "springs-explicit", "--time-step", "20ms",
                             "--max-seconds", "20s", "--json"});
    CHECK(r.code == 3);
    const auto report = nlohmann::json::parse(r.out);
    CHECK(report["status"] == "stalled");
    CHECK_THAT(report["where"].get<std::string>(), Contains("blew up") && Contains("stable"));
}

TEST_CASE("options that a method would ignore are refused", "[methods]") {
    for (const std::vector<std::string>& wrong : std::vector<std::vector<std::string>>{
             {"--method", "felt"},
             {"--method", "triangles", "--time-step", "1ms"},
             {"--time-step", "1ms"},
             {"--sweep", "from-top"},
             {"--method", "springs-implicit", "--limit", "stretch"},
             {"--method", "springs-limited", "--sweep", "somehow"},
             {"--hessian", "exact"},
             {"--damping-time", "1ms"},
             {"--method", "xpbd", "--contact", "impulse", "--damping-time", "1ms"},
             {"--method", "triangles", "--damping-time", "1ms"},
             {"--method", "triangles", "--contact", "impulse", "--damping-time", "2s"},
             {"--method", "triangles", "--contact", "impulse", "--damping-time", "-1s"},
             {"--method", "springs-implicit", "--contact", "impulse", "--hessian", "exact"},
             {"--method", "triangles", "--hessian", "exact"},
             {"--method", "triangles", "--contact", "impulse", "--hessian", "rounded"},
             {"--method", "springs-limited", "--avatar-sequence", "frames"}}) {
        std::vector<std::string> words{"drape", tee, "--json"};
        words.insert(words.end(), wrong.begin(), wrong.end());
        const Run r = run_toile(words);
        INFO(r.err);
        CHECK(r.code == 1);
        CHECK(one_sentence(r.err));
    }
}

TEST_CASE("a drape to an accuracy says what it decided and is as near as it says") {
    const TempFolder folder;
    const Run r = run_toile({"drape", tee, "--accuracy", "5mm", "-o", folder / "a.obj", "--report", folder / "a.json"});
    INFO(r.err);
    REQUIRE(r.code == 0);
    CHECK_THAT(r.out, Contains("accuracy: about"));
    const nlohmann::json report = load_json(folder / "a.json"), a = report["accuracy"];
    CHECK(Schema("report.schema.json").complaints(report.dump()) == "");
    CHECK(a["asked"] == 0.005);
    CHECK(a["met"] == true);
    CHECK(a["estimate"].get<double>() <= 0.005);
    REQUIRE(a["meshes"].size() >= 2);
    CHECK(a["meshes"][0]["difference"].is_null());
    CHECK(a["meshes"][1]["difference"].get<double>() > 0);
    CHECK(a["residual"].get<double>() <= 0.0005);
    CHECK(a["decisions"].size() >= 4);

    const double edge = a["meshes"].back()["edge_length"];
    const std::string half = std::to_string(500 * edge) + "mm";
    REQUIRE(run_toile({"drape", tee, "--edge-length", half, "--from", folder / "a.obj", "-o", folder / "b.obj"}).code == 0);
    const Run compared = run_toile({"compare", folder / "a.obj", folder / "b.obj", "--json"});
    CHECK(nlohmann::json::parse(compared.out)["rms"].get<double>() < 0.005);
}

TEST_CASE("a drape may be as accurate in its strains as asked") {
    const TempFolder folder;
    const Run r = run_toile({"drape", tee, "--accuracy", "1%", "-o", folder / "a.obj", "--report", folder / "a.json"});
    INFO(r.err);
    REQUIRE(r.code == 0);
    CHECK_THAT(r.out, Contains("% of strain"));
    const nlohmann::json report = load_json(folder / "a.json"), a = report["accuracy"];
    CHECK(Schema("report.schema.json").complaints(report.dump()) == "");
    CHECK(a["of"] == "strain");
    CHECK(a["asked"] == 0.01);
    CHECK(a["met"] == true);
    CHECK(a["estimate"].get<double>() <= 0.01);
    REQUIRE(a["meshes"].size() >= 2);
    CHECK(a["meshes"][1]["difference"].get<double>() > 1e-4);
}

TEST_CASE("a drape may be as accurate as a time allows") {
    const TempFolder folder;
    const Run r = run_toile({"drape", tee, "--accuracy", "12s", "-o", folder / "a.obj", "--report", folder / "a.json"});
    INFO(r.err);
    const nlohmann::json report = load_json(folder / "a.json"), a = report["accuracy"];
    CHECK(Schema("report.schema.json").complaints(report.dump()) == "");
    CHECK(a["asked"].is_null());
    CHECK(a["budget"] == 12);
    if (r.code == 0) // a busy machine may not even be done with the first mesh
        CHECK(a["met"] == true);
    else
        CHECK(report["status"] == "limit");
}

TEST_CASE("what a drape to an accuracy chooses cannot be asked for as well") {
    const auto refusal = [](std::vector<std::string> more) {
        more.insert(more.begin(), {"drape", tee, "--accuracy", "2mm", "--report", "never.json"});
        const Run r = run_toile(more);
        CHECK(r.code != 0);
        CHECK(one_sentence(r.err));
        return r.err;
    };
    CHECK_THAT(refusal({"--edge-length", "20mm"}), Contains("--edge-length"));
    CHECK_THAT(refusal({"--method", "triangles"}), Contains("--method"));
    CHECK_THAT(refusal({"--contact", "penalty"}), Contains("--contact"));
    CHECK_THAT(refusal({"--animate", "1s", "-o", "never.obj"}), Contains("--animate"));
    CHECK_THAT(refusal({"--from", "never.obj"}), Contains("--from"));
    for (const char* what : {"5", "2kg", "0.1s", "1m", "50%", "0%", "x%"}) {
        const Run r = run_toile({"drape", tee, "--accuracy", what, "--report", "never.json"});
        CHECK(r.code == 1);
        CHECK(one_sentence(r.err));
        CHECK_THAT(r.err, Contains("--accuracy"));
    }
}

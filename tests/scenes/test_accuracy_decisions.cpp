// SPDX-License-Identifier: GPL-3.0-or-later
// What a drape to an accuracy decides by itself, forced the other way: no decision may cost more than the accuracy asked for.
#include "draping/carry_drape.h"
#include "draping/compare.h"
#include "draping/drape_to_accuracy.h"
#include "draping/strain_difference.h"
#include "io/read_avatar.h"
#include "sewing/avatar.h"
#include "sewing/form.h"
#include "src/drape_input.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_data.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <fstream>
#include <numeric>

using namespace toile;

namespace {

/// A pattern on a body.
struct Dressed {
    Pattern pattern;
    DrapeInput input;
    TriMesh body;
    DrapeOptions how;

    Dressed(const std::string& file, const std::string& fabric, TriMesh b) : body(std::move(b)) {
        std::vector<std::string> warnings;
        pattern = sound_pattern(file, warnings);
        input = input_of(pattern, fabric, 0.04);
    }
    AccuracyOptions options(double asked) const { // m
        AccuracyOptions o;
        o.asked = asked;
        o.mesh = [this](double edge, const PlaceFactor& size) { return stage(pattern, flat_of(pattern, edge, false, size)); };
        return o;
    }
    DrapeResult drape(const AccuracyOptions& o) const { return drape_to_accuracy(o, {body, smoothed_toward_core(body, 0.01)}, input.fabrics, how); }
};

Dressed tee() { return {TOILE_SOURCE_DIR "/examples/tee.json", "", make_form({})}; }

/// A cloth of 60 by 40 cm over a body, held by its four corners.
Dressed awning(const std::string& fabric, TriMesh body) {
    const test::TempFolder folder;
    std::ofstream(folder / "awning.json") << R"({"pattern": {"panels": {"sheet": {"translation": [-30, 250, -20], "rotation": [90, 0, 0],
        "vertices": [[0, 0], [0, 40], [60, 40], [60, 0]],
        "edges": [{"endpoints": [0, 1]}, {"endpoints": [1, 2]}, {"endpoints": [2, 3]}, {"endpoints": [3, 0]}]}},
        "stitches": [], "panel_order": ["sheet"]}, "properties": {"curvature_coords": "relative", "normalize_panel_translation": false,
        "units_in_meter": 100, "normalized_edge_loops": true}})";
    std::ofstream(folder / "awning.toile.json") << R"({"toile": 1, "pins": [{"panel": "sheet", "edge": 0, "from": 0, "to": 0.1},
        {"panel": "sheet", "edge": 0, "from": 0.9, "to": 1}, {"panel": "sheet", "edge": 2, "from": 0, "to": 0.1},
        {"panel": "sheet", "edge": 2, "from": 0.9, "to": 1}]})";
    return {folder / "awning.json", fabric, std::move(body)};
}

const AccuracyDecision* about(const AccuracyReport& r, const std::string& what) {
    const auto found = std::find_if(r.decisions.begin(), r.decisions.end(),
                                    [&](const AccuracyDecision& d) { return d.what.find(what) != std::string::npos; });
    return found == r.decisions.end() ? nullptr : &*found;
}

const AccuracyDecision* about_itself(const AccuracyReport& r) { return about(r, "contact of the cloth with itself is left out"); }
const AccuracyDecision* about_friction(const AccuracyReport& r) { return about(r, "friction is left out"); }
const AccuracyDecision* about_method(const AccuracyReport& r) { return about(r, "are settled by projective"); }

} // namespace

TEST_CASE("iterations to the end change a drape to an accuracy by less than a tenth of what it was asked for") {
    constexpr double asked = 5e-3;
    const Dressed worn = tee();
    const DrapeResult chosen = worn.drape(worn.options(asked));
    REQUIRE(chosen.status == DrapeStatus::converged);
    REQUIRE(chosen.accuracy->met);
    AccuracyOptions o = worn.options(asked);
    o.ends_early = false;
    const DrapeResult other = worn.drape(o);
    CHECK(other.residual <= 1e-3);
    CHECK(chosen.residual > 1e-3);
    CHECK(compare(surface(chosen), surface(other)).rms < 0.1 * asked);
}

TEST_CASE("equal triangles everywhere change a drape to an accuracy by less than it was asked for") {
    constexpr double asked = 2.5e-3;
    const Dressed worn = tee();
    const DrapeResult chosen = worn.drape(worn.options(asked));
    REQUIRE(chosen.status == DrapeStatus::converged);
    REQUIRE(chosen.accuracy->met);
    REQUIRE(chosen.accuracy->meshes.size() >= 3); // the first two are not graded
    AccuracyOptions o = worn.options(asked);
    o.graded = false;
    const DrapeResult other = worn.drape(o);
    REQUIRE(other.accuracy->meshes.back().edge_length == Approx(chosen.accuracy->meshes.back().edge_length).epsilon(0.01));
    CHECK(chosen.garment.uv.size() < 0.8 * other.garment.uv.size());
    CHECK(compare(surface(chosen), surface(other)).rms < asked);
}

TEST_CASE("cloth that is missing on the first mesh of a drape to an accuracy is looked for again at half its edge length") {
    const Dressed worn(TOILE_SOURCE_DIR "/examples/tee.json", "denim", make_form({}));
    AccuracyOptions o = worn.options(5e-3);
    o.finest = 0.04;
    CHECK(worn.drape(o).status == DrapeStatus::too_small); // its neckline, by triangles that cannot lie round the neck
    o.finest = 0.02;
    const DrapeResult r = worn.drape(o);
    CHECK(r.status == DrapeStatus::converged);
    CHECK(r.accuracy->meshes.size() == 2);
    CHECK(about(*r.accuracy, "a first mesh")->taken_back);
    CHECK(about(*r.accuracy, "too coarse to tell that cloth is missing"));
}

TEST_CASE("contact of the cloth with itself that is left out changes a drape to an accuracy by less than a tenth of what it was asked for") {
    constexpr double asked = 5e-3;
    const auto pattern = test::test_data("garmentcode/pencil_skirt_specification.json"), body = test::test_data("bodies/mean_female.obj");
    if (!pattern || !body) return;
    const Dressed skirt(*pattern, "jersey", read_avatar(*body).body);
    AccuracyOptions o = skirt.options(asked);
    const DrapeResult chosen = skirt.drape(o);
    REQUIRE(chosen.status == DrapeStatus::converged);
    REQUIRE(about_itself(*chosen.accuracy));
    CHECK_FALSE(about_itself(*chosen.accuracy)->taken_back);
    o.leaves_out_self_contact = false;
    const DrapeResult other = skirt.drape(o);
    CHECK_FALSE(about_itself(*other.accuracy));
    CHECK(compare(surface(chosen), surface(other)).rms < 0.1 * asked);
}

TEST_CASE("contact of the cloth with itself comes back into a drape to an accuracy where cloth comes near itself") {
    const auto pattern = test::test_data("garmentcode/pencil_skirt_specification.json"), body = test::test_data("bodies/mean_female.obj");
    if (!pattern || !body) return;
    Dressed skirt(*pattern, "jersey", read_avatar(*body).body);
    AccuracyOptions o = skirt.options(1e-4);
    o.finest = 0.02;
    skirt.how.clearance = 1e-2; // farther than finer triangles at the corner of two patches are from each other
    const DrapeResult chosen = skirt.drape(o);
    REQUIRE(chosen.status == DrapeStatus::converged);
    REQUIRE(about_itself(*chosen.accuracy));
    CHECK(about_itself(*chosen.accuracy)->taken_back);
    CHECK(chosen.accuracy->decisions[about_itself(*chosen.accuracy) - chosen.accuracy->decisions.data() + 1].what.find("is modelled from the mesh of 20 mm on") !=
          std::string::npos);
    o.leaves_out_self_contact = false;
    const DrapeResult other = skirt.drape(o);
    CHECK(chosen.state.positions == other.state.positions);
}

TEST_CASE("friction that is left out changes a drape to an accuracy by less than a tenth of what it was asked for") {
    constexpr double asked = 2e-3;
    const Dressed cloth = awning("jersey", make_form({}));
    AccuracyOptions o = cloth.options(asked);
    o.lighter_method = false;
    const DrapeResult chosen = cloth.drape(o);
    REQUIRE(chosen.status == DrapeStatus::converged);
    REQUIRE(about_friction(*chosen.accuracy));
    CHECK_FALSE(about_friction(*chosen.accuracy)->taken_back);
    CHECK(chosen.friction.body == 0);
    o.leaves_out_friction = false;
    const DrapeResult other = cloth.drape(o);
    CHECK_FALSE(about_friction(*other.accuracy));
    CHECK(other.friction.body > 0);
    CHECK(compare(surface(chosen), surface(other)).rms < 0.1 * asked);
}

TEST_CASE("friction comes back into a drape to an accuracy where cloth comes to touch something") {
    const TriMesh form = make_form({});
    Dressed cloth = awning("jersey", form);
    AccuracyOptions o = cloth.options(1e-4);
    o.finest = 0.04;
    o.lighter_method = false;
    const DrapeResult first = cloth.drape(o);
    REQUIRE(first.status == DrapeStatus::converged);
    // A form that the first mesh stays clear of, and a finer one does not.
    o.finest = 0.01;
    const DrapeResult finer = cloth.drape(o);
    const auto gap = [&](const DrapeResult& r) { return clearance_min(node_triangles(r.garment), r.state.positions, cloth.body); };
    INFO(gap(first) << " and " << gap(finer));
    REQUIRE(gap(finer) < gap(first) - 3e-4);
    const double up = gap(first) - cloth.how.clearance - 3e-4;
    for (Vec3& p : cloth.body.points) p.y() += up;
    const DrapeResult chosen = cloth.drape(o);
    REQUIRE(chosen.status == DrapeStatus::converged);
    REQUIRE(about_friction(*chosen.accuracy));
    CHECK(about_friction(*chosen.accuracy)->taken_back);
    CHECK(chosen.friction.body > 0);
    CHECK(about(*chosen.accuracy, "friction is modelled from the mesh of"));
}

TEST_CASE("a lighter method changes a drape to an accuracy by less than half of what it was asked for") {
    constexpr double asked = 5e-3;
    const Dressed cloth = awning("poplin", make_form({}));
    AccuracyOptions o = cloth.options(asked);
    const DrapeResult chosen = cloth.drape(o);
    REQUIRE(chosen.status == DrapeStatus::converged);
    REQUIRE(about_method(*chosen.accuracy));
    CHECK_FALSE(about_method(*chosen.accuracy)->taken_back);
    CHECK(chosen.method == Method::projective);
    o.lighter_method = false;
    const DrapeResult other = cloth.drape(o);
    CHECK(other.method == Method::equilibrium);
    CHECK(compare(surface(chosen), surface(other)).rms < 0.5 * asked);
}

TEST_CASE("a lighter method that stretches cloth beyond its limits is taken back") {
    Dressed cloth = awning("poplin", make_form({}));
    AccuracyOptions o = cloth.options(5e-3);
    const auto most = [&](const DrapeResult& r) { return measure_strain(r.garment, r.state.positions, cloth.input.fabrics).warp.max; };
    const DrapeResult light = cloth.drape(o);
    REQUIRE(light.method == Method::projective);
    o.finest = 0.04;
    const DrapeResult coarse = cloth.drape(o);
    INFO(most(coarse) << " and " << most(light));
    REQUIRE(most(light) > 1.1 * most(coarse)); // finer triangles show the corners better
    for (Fabric& f : cloth.input.fabrics) f.limit_warp = (most(light) + most(coarse)) / 2;
    o.finest = 2e-3;
    const DrapeResult chosen = cloth.drape(o);
    REQUIRE(chosen.status == DrapeStatus::converged);
    REQUIRE(about_method(*chosen.accuracy));
    CHECK(about_method(*chosen.accuracy)->taken_back);
    CHECK(chosen.method == Method::equilibrium);
    CHECK(most(chosen) <= cloth.input.fabrics[0].limit_warp);
}

TEST_CASE("cloth that starts out flat in the air sags on the coarse levels, not on the last") {
    const Dressed cloth = awning("poplin", make_form({}));
    const DrapeInput input = input_of(cloth.pattern, "poplin", 0.01);
    const DrapeResult hung = drape(input.staging, {cloth.body, smoothed_toward_core(cloth.body, 0.01)}, input.fabrics, cloth.how);
    REQUIRE(hung.status == DrapeStatus::converged);
    REQUIRE(hung.levels.size() == 3);
    for (const LevelReport& level : hung.levels) CHECK(level.iterations > 3);
    DrapeOptions flat = cloth.how; // there is no seam, so that what is placed are the nodes
    flat.from = input.staging.levels.back().placed;
    const DrapeResult at_once = drape(input.staging, {cloth.body, smoothed_toward_core(cloth.body, 0.01)}, input.fabrics, flat);
    REQUIRE(at_once.status == DrapeStatus::converged);
    CHECK(compare(surface(hung), surface(at_once)).rms < 1e-4);
}

TEST_CASE("a drape to an accuracy of strain comes as near as asked") {
    constexpr double asked = 0.01;
    const Dressed worn = tee();
    AccuracyOptions o = worn.options(asked);
    o.of = AccuracyOf::strain;
    const DrapeResult chosen = worn.drape(o);
    REQUIRE(chosen.status == DrapeStatus::converged);
    REQUIRE(chosen.accuracy->met);
    REQUIRE(chosen.accuracy->meshes.size() >= 2);
    // The same drape continued at half the edge length.
    DrapeOptions on = worn.how;
    const Staging half = o.mesh(chosen.accuracy->meshes.back().edge_length / 2, {});
    std::vector<int> same(chosen.garment.panel_names.size());
    std::iota(same.begin(), same.end(), 0);
    on.from = carry_drape(chosen.garment, chosen.state.positions, close_seams(half.levels.back().garment), same);
    const DrapeResult finer = drape(half, {worn.body, smoothed_toward_core(worn.body, 0.01)}, worn.input.fabrics, on);
    REQUIRE(finer.status == DrapeStatus::converged);
    CHECK(strain_difference(chosen.garment, chosen.state.positions, finer.garment, finer.state.positions) < asked);
}

TEST_CASE("a budget of time is spent on finer meshes, and one that does not fit is not begun") {
    const Dressed worn = tee();
    AccuracyOptions o = worn.options(0);
    o.finest = 0.028;
    o.budget = 1e6;
    const DrapeResult ample = worn.drape(o);
    REQUIRE(ample.status == DrapeStatus::converged);
    CHECK(ample.accuracy->met);
    CHECK_FALSE(ample.accuracy->asked);
    REQUIRE(ample.accuracy->meshes.size() == 2);
    CHECK(ample.accuracy->meshes[1].edge_length == Approx(0.028));
    CHECK(*ample.accuracy->estimate > 0);

    o.budget = 1.2 * ample.accuracy->meshes[0].seconds; // one of half as many again takes longer than a fifth of it
    const DrapeResult scant = worn.drape(o);
    CHECK(scant.accuracy->meshes.size() <= 1);
    CHECK_FALSE(scant.accuracy->estimate);

    o.budget = 1e-3;
    const DrapeResult none = worn.drape(o);
    CHECK(none.status == DrapeStatus::limit);
    CHECK_FALSE(none.accuracy->met);
}

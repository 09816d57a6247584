// SPDX-License-Identifier: GPL-3.0-or-later
// What a drape to an accuracy decides by itself, forced the other way: no decision may cost more than the accuracy asked for.
#include "draping/compare.h"
#include "draping/drape_to_accuracy.h"
#include "sewing/avatar.h"
#include "sewing/form.h"
#include "src/drape_input.h"

#include <catch2/catch.hpp>

using namespace toile;

namespace {

struct Tee {
    Pattern pattern;
    DrapeInput input;
    TriMesh form = make_form({});

    Tee() {
        std::vector<std::string> warnings;
        pattern = sound_pattern(TOILE_SOURCE_DIR "/examples/tee.json", warnings);
        input = input_of(pattern, "", 0.04);
    }
    AccuracyOptions options(double asked) const { // m
        AccuracyOptions o;
        o.asked = asked;
        o.mesh = [this](double edge, const PlaceFactor& size) { return stage(pattern, flat_of(pattern, edge, false, size)); };
        return o;
    }
    DrapeResult drape(const AccuracyOptions& o) const { return drape_to_accuracy(o, {form, smoothed_toward_core(form, 0.01)}, input.fabrics, {}); }
};

} // namespace

TEST_CASE("iterations to the end change a drape to an accuracy by less than a tenth of what it was asked for") {
    constexpr double asked = 5e-3;
    const Tee tee;
    const DrapeResult chosen = tee.drape(tee.options(asked));
    REQUIRE(chosen.status == DrapeStatus::converged);
    REQUIRE(chosen.accuracy->met);
    AccuracyOptions o = tee.options(asked);
    o.ends_early = false;
    const DrapeResult other = tee.drape(o);
    CHECK(other.residual <= 1e-3);
    CHECK(chosen.residual > 1e-3);
    CHECK(compare(surface(chosen), surface(other)).rms < 0.1 * asked);
}

TEST_CASE("equal triangles everywhere change a drape to an accuracy by less than it was asked for") {
    constexpr double asked = 2.5e-3;
    const Tee tee;
    const DrapeResult chosen = tee.drape(tee.options(asked));
    REQUIRE(chosen.status == DrapeStatus::converged);
    REQUIRE(chosen.accuracy->met);
    REQUIRE(chosen.accuracy->meshes.size() >= 3); // the first two are not graded
    AccuracyOptions o = tee.options(asked);
    o.graded = false;
    const DrapeResult other = tee.drape(o);
    REQUIRE(other.accuracy->meshes.back().edge_length == Approx(chosen.accuracy->meshes.back().edge_length).epsilon(0.01));
    CHECK(chosen.garment.uv.size() < 0.8 * other.garment.uv.size());
    CHECK(compare(surface(chosen), surface(other)).rms < asked);
}

TEST_CASE("a budget of time is spent on finer meshes, and one that does not fit is not begun") {
    const Tee tee;
    AccuracyOptions o = tee.options(0);
    o.finest = 0.028;
    o.budget = 1e6;
    const DrapeResult ample = tee.drape(o);
    REQUIRE(ample.status == DrapeStatus::converged);
    CHECK(ample.accuracy->met);
    CHECK_FALSE(ample.accuracy->asked);
    REQUIRE(ample.accuracy->meshes.size() == 2);
    CHECK(ample.accuracy->meshes[1].edge_length == Approx(0.028));
    CHECK(*ample.accuracy->estimate > 0);

    o.budget = 1.2 * ample.accuracy->meshes[0].seconds; // one of half as many again takes longer than a fifth of it
    const DrapeResult scant = tee.drape(o);
    CHECK(scant.accuracy->meshes.size() <= 1);
    CHECK_FALSE(scant.accuracy->estimate);

    o.budget = 1e-3;
    const DrapeResult none = tee.drape(o);
    CHECK(none.status == DrapeStatus::limit);
    CHECK_FALSE(none.accuracy->met);
}

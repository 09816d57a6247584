// SPDX-License-Identifier: GPL-3.0-or-later
// How a drape follows its pattern, on the skirt and the tee of examples/.
#include "draping/fit/adjoint.h"
#include "draping/fit/fit.h"
#include "tests/support/fit_scene.h"

#include <catch2/catch.hpp>

#include <numeric>

using namespace toile;
using namespace toile::test;

namespace {

std::vector<Alteration> of_the_skirt(const Pattern& p) {
    return {{"hem, right front", lengthen_edge(p, 0, 0), -0.03, 0.03},
            {"hem, middle", {{{0, 0, 0}, {0, 1}}}, -0.03, 0.03},
            {"hem, curve", {{{0, 0, 1}, {0, 1}}}, -0.03, 0.03},
            {"dart", widen_dart(p, 0, 4), -0.01, 0.01},
            {"side seam", move_seam(p, 2), -0.03, 0.03},
            {"back hip", move_edge(p, 1, 2), -0.03, 0.03}};
}

std::vector<Alteration> of_the_tee(const Pattern& p) {
    return {{"hem, corner", {{{0, 0, 0}, {0, 1}}}, -0.03, 0.03},
            {"shoulder", lengthen_edge(p, 0, 3), -0.03, 0.03},
            {"neck, curve", {{{0, 4, 1}, {0, 1}}}, -0.03, 0.03},
            {"back side", move_edge(p, 1, 0), -0.03, 0.03},
            {"side seam", move_seam(p, 0), -0.03, 0.03},
            {"sleeve head", {{{2, 1, 2}, {1, 0}}}, -0.03, 0.03}};
}

/// A shape that is not the drape's, and strain beyond less than the cloth has.
std::vector<FitGoal> goals_near(const Garment& garment, const Points& x) {
    Points target = x;
    for (Vec3& p : target) p += Vec3(0.01 * p.y(), 0.01 * std::sin(8 * p.x()), 0);
    StrainGoal strain;
    for (int t = 0; t < int(garment.triangles.size()); ++t) strain.triangles.push_back(t);
    strain.most = 1e-3;
    return {{"shape", shape_goal(garment, target), 1e-3}, {"strain", strain, 1e-3}};
}

/// The example's skirt, its pattern altered, and its drape as drawn.
struct WrongSkirt {
    FitScene scene;
    Eigen::VectorXd wrong = (Eigen::VectorXd(5) << 0.02, -0.015, 0.004, 0.01, -0.01).finished();
    Points target;
    DrapeResult before;

    WrongSkirt() : scene(fit_scene(example_pattern("skirt"), alterations(), 0.04)), target(scene.drape.state.positions) {
        const Pattern begun = altered(example_pattern("skirt"), alterations(), wrong);
        before = drape(stage(begun, moved_flat(scene.moving, begun)), {scene.body, smoothed_toward_core(scene.body, 0.01)},
                       scene.fabrics, scene.options);
        REQUIRE(before.status == DrapeStatus::converged);
    }

    static std::vector<Alteration> alterations() {
        std::vector<Alteration> all = of_the_skirt(example_pattern("skirt"));
        all.erase(all.begin()); // what is left keeps seams equal
        return all;
    }
    AlteredDrape altered_drape() const {
        return AlteredDrape(scene.moving, wrong, before, scene.body, scene.fabrics, scene.options, {1e-7});
    }
};

/// A skirt with elastic along edges, whose front is shrunk a little.
template <class Which> Pattern banded_skirt(double ratio, Which&& has_band) {
    Pattern p = example_pattern("skirt");
    for (int panel = 0; panel < int(p.panels.size()); ++panel)
        for (int e = 0; e < int(p.panels[panel].outline.size()); ++e)
            if (has_band(p.panels[panel].outline[e].label, e)) p.elastics.push_back({{panel, e, 0, 1}, ratio, 20});
    REQUIRE(p.elastics.size() >= 4);
    p.panels[0].shrink = {0.01, 0.02};
    return p;
}

/// Rest lengths of the banded skirt, beside a cut that changes the cloth under the band and one that leaves it.
std::vector<Alteration> of_the_bands(const Pattern& p) {
    std::vector<int> all(p.elastics.size());
    std::iota(all.begin(), all.end(), 0);
    Alteration band{"band", {}, -0.2, 0.02, lengthen_elastics(p, all)}, half{"part of it", {}, -0.1, 0.01, {{0, 1}}};
    Alteration warp{"front, warp", {}, -0.05, 0.05}, weft{"front and back, weft", {}, -0.05, 0.05};
    warp.shrinks = {{0, {0, 1}}};
    weft.shrinks = {{0, {1, 0}}, {1, {0.5, 0}}};
    half.share = warp.share = weft.share = true;
    return {band, half, warp, weft, {"back hip", move_edge(p, 1, 2), -0.03, 0.03}, {"hem", {{{0, 0, 0}, {0, 1}}}, -0.03, 0.03}};
}

/// The adjoint gradient of goals near the drape against central differences of equilibria, the body touched and friction tied.
void check_gradient(const Pattern& pattern, std::vector<Alteration> alterations) {
    const FitScene s = fit_scene(pattern, std::move(alterations), 0.04);
    REQUIRE(s.drape.status == DrapeStatus::converged);
    AlteredDrape drape(s.moving, s.drawn(), s.drape, s.body, s.fabrics, s.options);
    Points x = s.drape.state.positions;
    REQUIRE(drape.anchor(s.drawn(), x).end == SettleEnd::settled);
    const TouchFacts touch = count_touching(drape.problem().contact(), x);
    REQUIRE(touch.body_pairs > 50);
    const auto tied = [](const Tie& t) { return t.force > 0; };
    const std::vector<Tie>& ties = drape.problem().friction.ties;
    REQUIRE(std::count_if(ties.begin(), ties.end(), tied) > 20);

    const std::vector<FitGoal> goals = goals_near(s.drape.garment, x);
    Eigen::VectorXd gradient;
    REQUIRE(fit_gradient(drape, goals, s.drawn(), x, gradient));
    // The membrane has corners where triangles go slack: a difference has to be short.
    constexpr double h = 1e-7;
    for (Eigen::Index k = 0; k < gradient.size(); ++k) {
        double sides[2];
        for (int side = 0; side < 2; ++side) {
            Eigen::VectorXd near = s.drawn();
            near[k] = side == 0 ? -h : h;
            Points y = x;
            REQUIRE(drape.rest(near, y).residual <= 1e-9);
            sides[side] = value(goals, drape.garment_at(near), y);
        }
        INFO(s.moving.alterations[k].name << ": " << gradient[k] << " of " << gradient.norm());
        CHECK(std::abs((sides[1] - sides[0]) / (2 * h) - gradient[k]) < 1e-5 * gradient.norm());
        CHECK(std::abs(gradient[k]) > 1e-3 * gradient.norm());
    }
}

} // namespace

TEST_CASE("the adjoint gradient is that of the drape: skirt and tee, with contact and friction") {
    const Pattern skirt = example_pattern("skirt"), tee = example_pattern("tee");
    check_gradient(skirt, of_the_skirt(skirt));
    check_gradient(tee, of_the_tee(tee));
}

TEST_CASE("the adjoint gradient is that of the drape by rest lengths: elastics and shrunk cloth") {
    const Pattern skirt = banded_skirt(0.97, [](const std::string& label, int) { return label == "lower_interface"; });
    check_gradient(skirt, of_the_bands(skirt));
}

TEST_CASE("an elastic and shrunk cloth are found again from their drape") {
    // In the hem, where a band has nothing but cloth to hold.
    const Pattern pattern = banded_skirt(0.9, [](const std::string&, int edge) { return edge == 0 || edge == 12; });
    std::vector<Alteration> all = of_the_bands(pattern);
    all.resize(4); // without outlines
    all.erase(all.begin() + 1); // part of the band does nearly what the whole does
    const FitScene s = fit_scene(pattern, all, 0.04);
    REQUIRE(s.drape.status == DrapeStatus::converged);
    const Eigen::VectorXd wrong = (Eigen::VectorXd(3) << -0.06, 0.03, -0.02).finished();
    const Pattern begun = altered(pattern, all, wrong);
    const DrapeResult before = drape(stage(begun, moved_flat(s.moving, begun)), {s.body, smoothed_toward_core(s.body, 0.01)}, s.fabrics, s.options);
    REQUIRE(before.status == DrapeStatus::converged);
    AlteredDrape altered_drape(s.moving, wrong, before, s.body, s.fabrics, s.options, {1e-7});
    const Points& target = s.drape.state.positions;
    FitOptions options;
    options.begin = [&](const Eigen::VectorXd&) { return target; };
    const std::vector<FitGoal> goals{{"shape", shape_goal(before.garment, target), 1e-4}};
    const FitResult r = fit(altered_drape, goals, wrong, target, options);
    INFO(r.why);
    INFO(r.amounts.transpose());
    CHECK(r.end == FitEnd::met);
    CHECK(r.optimiser == Optimiser::lbfgs); // no seam is cut otherwise
    CHECK(std::abs(r.amounts[0]) < 2e-3);   // m, of 60 mm
    CHECK(std::abs(r.amounts[1]) < 1e-3);   // of 3 %
    CHECK(std::abs(r.amounts[2]) < 1e-3);   // of 2 %
    CHECK(elastic_segments(pattern.elastics, s.drape.garment).size() > 10);
}

TEST_CASE("a skirt that was altered is found again from its drape") {
    const WrongSkirt w;
    AlteredDrape altered_drape = w.altered_drape();
    FitOptions options;
    options.begin = [&](const Eigen::VectorXd&) { return w.target; };
    const std::vector<FitGoal> goals{{"shape", shape_goal(w.before.garment, w.target), 1e-3}};
    const FitResult r = fit(altered_drape, goals, w.wrong, w.target, options);
    INFO(r.why);
    CHECK(r.end == FitEnd::met);
    CHECK(r.before[0] > 3e-3);
    CHECK(r.after[0] < 1e-3);
    CHECK(r.unequal < 2e-5);
    CHECK(r.amounts.cwiseAbs().maxCoeff() < 0.5 * w.wrong.cwiseAbs().maxCoeff());
    // The same again, to the last bit.
    AlteredDrape twin = w.altered_drape();
    CHECK(fit(twin, goals, w.wrong, w.target, options).amounts == r.amounts);
}

TEST_CASE("a skirt that was altered comes nearer to a surface of other triangles") {
    const WrongSkirt w;
    TriMesh target{w.target, {}}; // every triangle as three
    for (const auto& [a, b, c] : node_triangles(w.before.garment)) {
        const int m = int(target.points.size());
        target.points.push_back((w.target[a] + w.target[b] + w.target[c]) / 3);
        target.triangles.insert(target.triangles.end(), {{a, b, m}, {b, c, m}, {c, a, m}});
    }
    AlteredDrape altered_drape = w.altered_drape();
    const std::vector<FitGoal> goals{{"surface", surface_goal(w.before.garment, target), 1e-3}};
    FitOptions options;
    options.begin = [&, x = w.before.state.positions](const Eigen::VectorXd& amounts) mutable {
        altered_drape.draw_to(target, amounts, x);
        return x;
    };
    const FitResult r = fit(altered_drape, goals, w.wrong, w.before.state.positions, options);
    INFO(r.why);
    CHECK(r.before[0] > 5e-3);
    CHECK(r.after[0] < 0.75 * r.before[0]); // folds that fall otherwise are the rest
    CHECK(r.unequal < 2e-5);
}

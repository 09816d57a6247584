// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/fit/altered_drape.h"

#include "draping/fit/rest_force.h"
#include "draping/hooks.h"
#include "draping/settle_level.h"
#include "geometry/foot.h"
#include "patterns/shrink.h"

#include <stdexcept>

namespace toile {

namespace {

constexpr double least_area = 0.1;    // of what a triangle has as drawn
constexpr double rest_step = 1e-6;    // m of an alteration: slivers have edges of half a millimetre
constexpr double anchored = 1e-6;     // residual at which friction that follows is taken as it is
constexpr double solved = 1e-13;      // of a right side, in the norm of the preconditioner
constexpr int most_conjugate = 400;
constexpr double pull = 5e3;           // N/m per m2, to the nearest points of a surface: 0.3 mm off for the weight of poplin
constexpr double strongest_pull = 100; // N per m2
constexpr int drawing_rounds = 10;     // after each of which nearest points are found anew,
constexpr int most_drawing = 30;       // of so many iterations at most,
constexpr double drawn = 10;           // or to this residual

} // namespace

AlteredDrape::AlteredDrape(const MovingFlat& moving, const Eigen::VectorXd& amounts, const DrapeResult& drape,
                           const TriMesh& body, const PanelFabrics& fabrics, const DrapeOptions& options,
                           const AlteredOptions& how)
    : moving_(moving), staging_(stage(moving.drawn, moving.flat)), body_(body), fabrics_(fabrics), options_(options), how_(how),
      friction_(drape.friction), garment_(drape.garment), amounts_(amounts) {
    staging_.elastics = pattern_at(amounts).elastics;
    DrapeRun run{.staging = staging_, .avatar = body_, .fabrics = fabrics_, .options = options_};
    run.level = run.levels() - 1;
    for (const Fabric& f : fabrics_) run.density = std::max(run.density, f.density);
    run.garment = garment_;
    run.x = drape.state.positions;
    const std::vector<std::string> labels = labels_of(garment_);
    for (const std::string& word : options_.hold)
        for (const std::string& label : labels_called(word, labels)) run.held.push_back(label);
    run.carried_at = label_heights(garment_, run.x, run.held);
    problem_ = std::make_unique<ClothProblem>(garment_, fabrics_, body_, run.contact_options());
    problem_->gravity = options_.gravity;
    problem_->limit_strain(hard_limit);
    add_fixtures(run, *problem_);
}

Pattern AlteredDrape::pattern_at(const Eigen::VectorXd& amounts) const {
    return altered(moving_.drawn, moving_.alterations, amounts);
}

Garment AlteredDrape::garment_of(const Pattern& pattern) const {
    const int level = int(moving_.flat.levels.size()) - 1;
    const std::vector<Vec2> points = moved_points(moving_, pattern, level);
    if (const int t = collapsed_triangle(moving_, points, level, least_area); t >= 0)
        throw std::invalid_argument("panel " + pattern.panels[garment_.panel_of_triangle[t]].name +
                                    " is altered so far that its cloth would fold over");
    Garment garment = garment_;
    for (std::size_t v = 0; v < points.size(); ++v)
        garment.uv[v] = to_rest(pattern.panels[garment.panel_of_vertex[v]]) * points[v];
    for (std::size_t t = 0; t < garment.triangles.size(); ++t) {
        const Triangle& v = garment.triangles[t];
        garment.rest.edges[t] << garment.uv[v[1]] - garment.uv[v[0]], garment.uv[v[2]] - garment.uv[v[0]];
    }
    return garment;
}

void AlteredDrape::take(const Eigen::VectorXd& amounts) {
    if (amounts == amounts_) return;
    const Pattern pattern = pattern_at(amounts);
    const Garment garment = garment_of(pattern);
    problem_->rest_on(garment, fabrics_);
    problem_->elastics = elastic_segments(pattern.elastics, garment);
    amounts_ = amounts;
}

SettleResult AlteredDrape::rest(const Eigen::VectorXd& amounts, Points& x) {
    take(amounts);
    SettleOptions o;
    o.tolerance = how_.tolerance;
    o.max_iterations = how_.max_iterations;
    o.max_step = std::min(o.max_step, staging_.levels.back().edge_length);
    return settle(*problem_, x, factor_, o);
}

SettleResult AlteredDrape::anchor(const Eigen::VectorXd& amounts, Points& x) {
    take(amounts);
    problem_->rest_here(x, friction_, true);
    SettleOptions o;
    o.tolerance = anchored;
    o.max_iterations = how_.max_iterations;
    settle(*problem_, x, factor_, o);
    problem_->freeze_friction();
    return rest(amounts, x);
}

void AlteredDrape::draw_to(const TriMesh& surface, const Eigen::VectorXd& amounts, Points& x) {
    take(amounts);
    const Bvh tree(triangle_boxes(surface.points, surface.triangles, 0));
    const std::vector<HookSpring> own = problem_->hooks;
    problem_->rest_here(x, {});
    const std::vector<double> area = node_areas(garment_);
    SettleOptions o;
    o.tolerance = drawn;
    o.max_iterations = most_drawing;
    for (int round = 0; round < drawing_rounds; ++round) {
        problem_->hooks = own;
        for (int i = 0; i < int(x.size()); ++i)
            problem_->hooks.push_back({i, foot_on(surface, tree, x[i]).at, Vec3::Ones(), pull * area[i], strongest_pull * area[i]});
        settle(*problem_, x, factor_, o);
    }
    problem_->hooks = own;
}

bool AlteredDrape::solve(const Eigen::VectorXd& amounts, const Points& x, const Eigen::VectorXd& right,
                         Eigen::VectorXd& lambda) {
    take(amounts);
    bool changed = false;
    problem_->touch(x);
    const auto factorised = [&](bool exact) {
        BlockMatrix& h = problem_->hessian(x, exact, changed);
        h.pin(problem_->pinned());
        factor_.analyse(h);
        return factor_.factorise(h);
    };
    if (!factorised(true)) {
        if (!factorised(false)) return false;
        problem_->hessian(x, true, changed).pin(problem_->pinned());
    }
    Eigen::VectorXd r = right, z, p, kp;
    for (int i = 0; i < problem_->points(); ++i)
        if (problem_->pinned()[i]) r.segment<3>(3 * i).setZero();
    lambda.setZero(r.size());
    factor_.solve(r, z);
    p = z;
    double rz = r.dot(z);
    const double stop = solved * solved * rz;
    for (int k = 0; k < most_conjugate && rz > stop; ++k) {
        problem_->multiply(p, kp);
        const double curvature = p.dot(kp);
        if (!(curvature > 0)) return false;
        lambda += rz / curvature * p;
        r -= rz / curvature * kp;
        factor_.solve(r, z);
        const double next = r.dot(z);
        p = z + next / rz * p;
        rz = next;
    }
    return true;
}

Eigen::MatrixXd AlteredDrape::force_slopes(const Eigen::VectorXd& amounts, const Points& x) const {
    const MembraneTangent law = membrane_tangent(garment_at(amounts), fabrics_, x);
    const auto force_at = [&](Eigen::Index k, double by) {
        Eigen::VectorXd near = amounts;
        near[k] += by;
        const Pattern pattern = pattern_at(near);
        const Garment garment = garment_of(pattern);
        Loads loads = *problem_;
        loads.elastics = elastic_segments(pattern.elastics, garment);
        return rest_force(garment, fabrics_, loads, hard_limit, law, x);
    };
    Eigen::MatrixXd slopes(3 * Eigen::Index(x.size()), amounts.size());
    for (Eigen::Index k = 0; k < amounts.size(); ++k)
        slopes.col(k) = (force_at(k, rest_step) - force_at(k, -rest_step)) / (2 * rest_step);
    for (int i = 0; i < problem_->points(); ++i)
        if (problem_->pinned()[i]) slopes.middleRows<3>(3 * i).setZero();
    return slopes;
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/cloth.h"

#include "geometry/disjoint_sets.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace toile {

namespace {

constexpr double friction_rest = 10; // residual below which friction only gives way,
constexpr double friction_off = 1e4; // until the residual is above this again: forces of impacts are no friction
constexpr int renew_every = 8;        // arrivals after which what is lagged is renewed in any case

} // namespace

ContactCloth contact_cloth(const Garment& g) {
    ContactCloth c;
    c.triangles = node_triangles(g);
    c.edges = g.edges.ends;
    c.node_area.assign(g.node_count, 0.0);
    c.node_reach.assign(g.node_count, std::numeric_limits<double>::infinity());
    c.edge_length.assign(g.edges.size(), 0.0);
    c.edge_area.assign(g.edges.size(), 0.0);
    for (std::size_t t = 0; t < c.triangles.size(); ++t) {
        const Mat2& r = g.rest.edges[t];
        const double area = rest_area(r);
        const double length[3] = {(r.col(1) - r.col(0)).norm(), r.col(1).norm(), r.col(0).norm()};
        const double altitude = 2 * area / std::max({length[0], length[1], length[2]});
        for (int k = 0; k < 3; ++k) {
            const int node = c.triangles[t][k], edge = g.edges.of_triangle[t][k];
            c.node_area[node] += area / 3;
            c.node_reach[node] = std::min(c.node_reach[node], altitude);
            c.edge_area[edge] += area / 3;
            c.edge_length[edge] = std::max(c.edge_length[edge], length[k]);
        }
    }
    for (const Stitch& s : g.stitches)
        if (s.r > 0 && s.r < 1) c.sewn_to_edge.push_back({s.a, s.b[0], s.b[1]});
    // Nodes that stitches will merge count as one.
    DisjointSets merged(g.node_count);
    for (const Stitch& s : g.stitches) {
        if (s.r != 0) continue;
        merged.join(s.a, s.b[0]);
    }
    c.group = merged.all();
    return c;
}

TangledCloth tangled_cloth(const Garment& g, double edge_length) {
    ContactCloth cloth = contact_cloth(g);
    return {std::move(cloth.triangles), g.edges, edge_length, std::move(cloth.sewn_to_edge)};
}

std::vector<double> node_masses(const Garment& g, const PanelFabrics& fabrics) {
    std::vector<double> mass(g.node_count, 0.0);
    for (std::size_t t = 0; t < g.triangles.size(); ++t) {
        const double m = fabrics[g.panel_of_triangle[t]].density * rest_area(g.rest.edges[t]) / 3;
        for (int node : g.nodes(int(t))) mass[node] += m;
    }
    return mass;
}

ClothProblem::ClothProblem(const Garment& garment, const PanelFabrics& fabrics, const TriMesh& body,
                           const ContactOptions& contact)
    : NodeProblem(node_masses(garment, fabrics)), sheet_(make_sheet(garment, fabrics)),
      contact_(contact_cloth(garment), body, contact) {
    limits_.swap(sheet_.limits);
}

void ClothProblem::rest_here(const Points& x, const FrictionCoefficients& coefficients, bool at_rest) {
    friction = friction_at(x, coefficients.body);
    cloth_friction = {};
    cloth_friction.coefficient = coefficients.cloth;
    arrivals_ = 0;
    residual_ = renewed_at_ = std::numeric_limits<double>::infinity();
    near_rest_ = rising_ = false;
    trusted_ = at_rest;
}

void ClothProblem::limit_strain(double turn, double tighter) {
    sheet_.limits = limits_;
    for (StrainLimit& limit : sheet_.limits) {
        limit.turn = turn;
        limit.weft = 1 + (1 - tighter) * (limit.weft - 1);
        limit.warp = 1 + (1 - tighter) * (limit.warp - 1);
        limit.shear *= 1 - tighter;
    }
}

void ClothProblem::match_cloth_friction(const Points& x) {
    cloth_forces_ = contact_.cloth_forces(active_);
    match_ties(cloth_friction, cloth_forces_, arrived_at_, x);
    arrived_at_ = x;
}

void ClothProblem::renew_friction(const Points& x) {
    rising_ = false;
    const auto weight = [&](int i) { return 9.81 * node_mass_[i]; };
    if (friction.coefficient > 0) {
        std::vector<double> least(points());
        for (int i = 0; i < points(); ++i) least[i] = weight(i);
        rising_ = renew(friction, x, contact_.body_forces(active_), least, trusted_);
    }
    if (cloth_friction.coefficient > 0) {
        Points force;
        std::vector<double> least;
        for (const PairForce& f : cloth_forces_) {
            force.push_back(f.force);
            double carried = 0;
            for (int k = 0; k < 4; ++k) carried += std::abs(f.weight[k]) * weight(f.point[k]);
            least.push_back(carried);
        }
        rising_ = renew(cloth_friction, x, force, least, trusted_) || rising_;
    }
}

void ClothProblem::adapt_friction(const Points& x) {
    const bool at_rest = residual_ < friction_rest;
    if (friction.coefficient > 0) {
        const Points force = contact_.body_forces(active_);
        for (int i = 0; i < points(); ++i)
            if (friction.ties[i].force > 0) follow(friction, x, i, force[i].norm(), at_rest);
    }
    for (int t = 0; t < int(cloth_friction.ties.size()); ++t) {
        const double press = cloth_forces_[t].force.norm();
        if (cloth_friction.ties[t].force > 0)
            follow(cloth_friction, x, t, press, at_rest);
        else
            cloth_friction.ties[t].force = press;
    }
}

void ClothProblem::take_up_friction(const Points& x) {
    renew_friction(x);
    trusted_ = false;
    Eigen::VectorXd g;
    gradient(x, g);
    take_up(friction, cloth_friction, x, pinned_, g);
}

void ClothProblem::touch(const Points& x) {
    contact_.prepare(x, Eigen::VectorXd::Zero(3 * points()));
    active_ = contact_.active(x);
}

void ClothProblem::arrive(const Points& x) {
    touch(x);
    if (friction.coefficient == 0 && cloth_friction.coefficient == 0) return;
    const Stopwatch::Lap lap(contact_.clock());
    if (cloth_friction.coefficient > 0) match_cloth_friction(x);
    if (trusted_) {
        take_up_friction(x);
        return;
    }
    // Near rest friction only gives way where it is more than contact can answer: less than that is friction
    // too, and forces that follow one another up and down would not come to rest. It grows only where a node would
    // give way for want of it.
    near_rest_ = residual_ < (near_rest_ ? friction_off : friction_rest);
    const bool renew = arrivals_ % renew_every == 0 || residual_ < 0.1 * renewed_at_;
    ++arrivals_;
    if (near_rest_ && !rising_) {
        adapt_friction(x);
    } else if (renew || near_rest_) {
        renewed_at_ = residual_;
        renew_friction(x);
    }
}

double ClothProblem::value(const Points& x) {
    double sum = sheet_value(sheet_, x) + toile::value(*this, node_mass_, x);
    const Stopwatch::Lap lap(contact_.clock());
    if (friction.coefficient > 0) sum += toile::value(friction, x);
    if (cloth_friction.coefficient > 0) sum += toile::value(cloth_friction, x);
    return sum + contact_.value(contact_.active(x));
}

void ClothProblem::gradient(const Points& x, Eigen::VectorXd& g) { gradient_with(active_, x, g); }

void ClothProblem::gradient_with(const std::vector<ActivePair>& active, const Points& x, Eigen::VectorXd& g) const {
    Points sheet(x.size(), Vec3::Zero());
    sheet_gradient(sheet_, x, sheet);
    g = flat(sheet);
    add_gradient(*this, node_mass_, x, g);
    {
        const Stopwatch::Lap lap(contact_.clock());
        if (friction.coefficient > 0) add_gradient(friction, x, g);
        if (cloth_friction.coefficient > 0) add_gradient(cloth_friction, x, g);
        contact_.add_gradient(active, g);
    }
    clear_pinned(g);
}

void ClothProblem::make_pattern() {
    std::vector<std::pair<int, int>> pairs;
    sheet_couplings(sheet_, pairs);
    couplings(*this, pairs);
    contact_.couplings(active_, pairs);
    couplings(cloth_friction, pairs);
    matrix_ = BlockMatrix(points(), pairs);
    sheet_slots(sheet_, matrix_);
    matrix_made_ = true;
}

BlockMatrix& ClothProblem::hessian(const Points& x, bool exact, bool& pattern_changed) {
    for (;;) {
        if (!matrix_made_) {
            make_pattern();
            pattern_changed = true;
        }
        matrix_.set_zero();
        bool complete = contact_.add_hessian(x, active_, exact, matrix_);
        if (cloth_friction.coefficient > 0) complete = add_hessian(cloth_friction, x, exact, matrix_) && complete;
        if (complete) break;
        matrix_made_ = false;
    }
    sheet_hessian(sheet_, x, exact ? HessianKind::exact : HessianKind::projected, matrix_);
    add_hessian(*this, x, matrix_);
    const Stopwatch::Lap lap(contact_.clock());
    if (friction.coefficient > 0) add_hessian(friction, x, exact, matrix_);
    return matrix_;
}

void ClothProblem::multiply(const Eigen::VectorXd& v, Eigen::VectorXd& product) const {
    matrix_.multiply(v, product);
    sheet_beyond_compact(sheet_, v, product);
    for (int i = 0; i < points(); ++i)
        if (pinned_[i]) product.segment<3>(3 * i) = v.segment<3>(3 * i);
}

void ClothProblem::curvature_along(const Points& x, const Eigen::VectorXd& g, const Eigen::VectorXd& d,
                                   Eigen::VectorXd& hd) {
    constexpr double part = 1e-3; // of steps of millimetres: what touches moves by micrometres
    Points near = x;
    flat(near) += part * d;
    gradient_with(contact_.active(near), near, hd);
    hd = (hd - g) / part;
}

double ClothProblem::feasible_step(const Points& x, const Eigen::VectorXd& dx, std::vector<double>* shares) {
    if (contact_.prepare(x, dx)) active_ = contact_.active(x);
    return contact_.feasible_step(x, dx, nullptr, shares ? &blocking_ : nullptr, shares);
}

std::vector<double> ClothProblem::friction_excess(const Points& x) const {
    std::vector<double> excess(points(), 0.0);
    if (friction.coefficient > 0) {
        const Points normal = contact_.body_forces(active_);
        for (int i = 0; i < points(); ++i) {
            const double limit = friction.coefficient * normal[i].norm();
            excess[i] = std::max(0.0, friction_force(friction, x, i).norm() - limit);
        }
    }
    for (int t = 0; t < int(cloth_friction.ties.size()); ++t) {
        const PairForce& f = cloth_forces_[t];
        const double limit = cloth_friction.coefficient * f.force.norm();
        const double over = friction_force(cloth_friction, x, t).norm() - limit;
        if (!(over > 0)) continue;
        for (int k = 0; k < 4; ++k) excess[f.point[k]] += std::abs(f.weight[k]) * over;
    }
    return excess;
}

double ClothProblem::unanswered(const Points&, int i) const { return excess_[i]; }

double ClothProblem::residual(const Points& x, const Eigen::VectorXd& g) {
    excess_ = friction_excess(x);
    return residual_ = NodeProblem::residual(x, g);
}

} // namespace toile

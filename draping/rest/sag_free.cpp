// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/rest/sag_free.h"

#include "draping/algebra/cholesky.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

constexpr double at_bound = 1e-9;   // of the room between the bounds
constexpr double same_weights = 1e-13;
constexpr int most_rounds = 30;
constexpr double give = 1e-12;      // of the largest stiffness: what counts as no resistance

Member length_member(const Prescribed& data, const Points& x, int e, double change) {
    const auto& [a, b] = data.edges.ends[e];
    const Vec3 d = x[b] - x[a];
    const double distance = d.norm(), weight = data.length_weight[e];
    Member m;
    m.count = 2;
    m.nodes = {a, b};
    m.slope[0] = -d / distance;
    m.slope[1] = d / distance;
    m.stiffness = 2 * weight / (distance * distance);
    m.low = tension_of(weight, distance, (1 + change) * distance);
    m.high = tension_of(weight, distance, (1 - change) * distance);
    return m;
}

Member angle_member(const HingeBend& bend, const Points& x, double change) {
    const HingeAngle angle = hinge_angle(bend.nodes, x);
    Member m;
    m.count = 4;
    m.nodes = bend.nodes;
    m.slope = angle.gradient;
    m.stiffness = bend.stiffness;
    m.low = -bend.stiffness * std::min(change, M_PI - angle.value);
    m.high = bend.stiffness * std::min(change, M_PI + angle.value);
    return m;
}

bool is_stable(const Prescribed& rest, const Points& x, const std::vector<char>& held) {
    const PrescribedEnergy energy(rest);
    std::vector<std::pair<int, int>> pairs;
    energy.couplings(pairs);
    BlockMatrix h(int(x.size()), pairs);
    energy.add_hessian(x, HessianKind::exact, h);
    double most = 0;
    for (int k = 0; k < h.rows(); ++k) most = std::max(most, h.values()[h.scalar_columns()[k]]);
    h.add_to_diagonal(Eigen::VectorXd::Constant(h.rows(), give * most));
    h.pin(held);
    Cholesky factor;
    factor.analyse(h);
    return factor.factorise(h);
}

bool bounded(const Member& m, double force) {
    const double room = at_bound * (m.high - m.low);
    return force != 0 && (force <= m.low + room || force >= m.high - room);
}

/// How far the weights of b are from those of a, as a share of them.
double weights_apart(const Prescribed& a, const Prescribed& b) {
    double most = 0;
    for (int e = 0; e < a.edges.size(); ++e) {
        most = std::max(most, std::abs(b.length_weight[e] - a.length_weight[e]) / a.length_weight[e]);
        most = std::max(most, std::abs(b.angle_weight[e] - a.angle_weight[e]) / a.angle_weight[e]);
    }
    return most;
}

} // namespace

double tension_of(double weight, double distance, double length) {
    return 2 * weight / length * (distance / length - 1);
}

double length_for(double weight, double distance, double tension) {
    return 2 * distance / (1 + std::sqrt(std::max(0.0, 1 + 2 * tension * distance / weight)));
}

Points weight_of(const std::vector<Triangle>& triangles, const Points& x, double density, double gravity) {
    Points weight(x.size(), Vec3::Zero());
    for (const Triangle& t : triangles) {
        const double area = (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]).norm() / 2;
        for (const int i : t) weight[i].y() -= density * gravity * area / 3;
    }
    return weight;
}

std::vector<Member> members_of(const Prescribed& data, const Points& x, const SagFreeOptions& options) {
    std::vector<Member> members;
    for (int e = 0; e < data.edges.size(); ++e) members.push_back(length_member(data, x, e, options.length_change));
    for (const Hinge& h : hinges_of(data.edges, data.triangles))
        members.push_back(angle_member({h.nodes, 0, 2 * data.angle_weight[h.edge]}, x, options.angle_change));
    return members;
}

SagFree sag_free(const Prescribed& data, const Points& x, const Points& load, const std::vector<char>& held,
                 const SagFreeOptions& options) {
    SagFree found;
    found.rest = measured(data.triangles, x);
    found.rest.length_weight = data.length_weight;
    found.rest.angle_weight = data.angle_weight;
    const std::vector<Member> all = members_of(found.rest, x, options);
    std::vector<Member> members; // those that resist
    for (const Member& m : all)
        if (m.stiffness > 0) members.push_back(m);
    const Balance b = balance(members, load, held, options.tolerance);
    found.end = b.end;
    found.missing = b.missing;
    found.factorisations = b.factorisations;

    const std::vector<Hinge> hinges = hinges_of(data.edges, data.triangles);
    std::size_t next = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
        if (!(all[k].stiffness > 0)) continue;
        const double force = b.force[next++];
        const bool angle = k >= data.edges.ends.size();
        const int e = angle ? hinges[k - data.edges.ends.size()].edge : int(k);
        if (bounded(all[k], force)) (angle ? found.angle_bounds : found.length_bounds).push_back(e);
        if (angle)
            found.rest.angle[e] -= force / all[k].stiffness;
        else
            found.rest.length[e] = length_for(data.length_weight[e], found.rest.length[e], force);
    }
    for (int i = 0; i < int(x.size()); ++i)
        if (!held[i] && (found.worst < 0 || found.missing[i].norm() > found.missing[found.worst].norm())) found.worst = i;
    found.stable = found.end == BalanceEnd::balanced && is_stable(found.rest, x, held);
    return found;
}

SagFree sag_free(const std::vector<Triangle>& triangles, const Points& x, const Fabric& fabric, const Points& load,
                 const std::vector<char>& held, const SagFreeOptions& options) {
    Prescribed data = measured(triangles, x);
    weigh(data, fabric);
    int factorisations = 0;
    for (int round = 0;; ++round) {
        SagFree found = sag_free(data, x, load, held, options);
        found.factorisations = factorisations += found.factorisations;
        Prescribed next = found.rest;
        if (found.end != BalanceEnd::balanced || impossible_triangle(next) >= 0) return found;
        weigh(next, fabric);
        if (weights_apart(data, next) <= same_weights || round == most_rounds) return found;
        data = std::move(next);
    }
}

} // namespace toile

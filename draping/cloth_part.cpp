// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/cloth_part.h"

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

constexpr double moves = 0.2;          // share of the longest motion from which a node counts as moving,
constexpr int rings = 3;               // with so many round it
constexpr double most_of_all = 0.2;    // of the nodes; a larger part costs more, and what hangs by it has to follow
constexpr int most_iterations = 25;
constexpr double gain = 0.1;           // of the residual, and enough
constexpr double least_residual = 2;   // below which Newton's steps of the whole converge at once
constexpr double step_share = 0.25;    // of the travel, of one step
constexpr double far = 0.7;            // of the travel: a step more could lead beyond it

/// Stitches, hooks and bands that pull at a node which moves, over the nodes of the part.
Loads part_of(const Loads& loads, const std::vector<char>& moving, const std::vector<int>& local) {
    Loads part;
    part.gravity = loads.gravity;
    for (StitchSpring s : loads.stitches) {
        if (!moving[s.a] && !moving[s.b[0]] && !moving[s.b[1]]) continue;
        s.a = local[s.a];
        for (int& b : s.b) b = local[b];
        part.stitches.push_back(s);
    }
    for (HookSpring s : loads.hooks) {
        if (!moving[s.node]) continue;
        s.node = local[s.node];
        part.hooks.push_back(s);
    }
    for (ElasticSegment s : loads.elastics) {
        if (!moving[s.a] && !moving[s.b]) continue;
        s.a = local[s.a];
        s.b = local[s.b];
        part.elastics.push_back(s);
    }
    return part;
}

void mark_pulled(const Loads& loads, const std::vector<char>& moving, std::vector<char>& marked) {
    for (const StitchSpring& s : loads.stitches)
        if (moving[s.a] || moving[s.b[0]] || moving[s.b[1]]) marked[s.a] = marked[s.b[0]] = marked[s.b[1]] = 1;
    for (const ElasticSegment& s : loads.elastics)
        if (moving[s.a] || moving[s.b]) marked[s.a] = marked[s.b] = 1;
}

/// The nodes that the step moved most, and those round them.
std::vector<char> moved_most(const std::vector<Triangle>& triangles, const Eigen::VectorXd& step) {
    const int n = int(step.size() / 3);
    double most = 0;
    for (int i = 0; i < n; ++i) most = std::max(most, step.segment<3>(3 * i).norm());
    std::vector<char> moved(n);
    for (int i = 0; i < n; ++i) moved[i] = step.segment<3>(3 * i).norm() > moves * most;
    for (int k = 0; k < rings; ++k) add_ring(triangles, moved);
    return moved;
}

/// How far a node of the part has gone at most from where the whole has it, m.
double farthest(const ClothPart& part, const Points& whole, const Points& at) {
    double most = 0;
    for (std::size_t k = 0; k < at.size(); ++k) most = std::max(most, (at[k] - whole[part.nodes[k]]).squaredNorm());
    return std::sqrt(most);
}

} // namespace

ClothPart part_of(const ClothProblem& whole, const Points& x, const std::vector<char>& moving, double travel) {
    const Contact& contact = whole.contact();
    const std::vector<char> coupled = coupled_nodes(*whole.sheet(), moving);
    std::vector<char> inside = contact.within_travel(x, moving, travel);
    for (std::size_t i = 0; i < x.size(); ++i) inside[i] = inside[i] || coupled[i];
    mark_pulled(whole, moving, inside);

    ClothPart part;
    std::vector<int> local(x.size(), -1);
    std::vector<double> mass;
    for (int i = 0; i < int(x.size()); ++i) {
        if (!inside[i]) continue;
        local[i] = int(part.nodes.size());
        part.nodes.push_back(i);
        mass.push_back(whole.node_mass()[i]);
    }
    const int n = int(part.nodes.size());
    ContactCloth cloth = part_of(contact.cloth(), local, n);
    for (const int i : part.nodes) cloth.still.push_back(!moving[i]);
    part.problem = std::make_unique<ClothProblem>(
        std::make_unique<SheetEnergy>(part_of(*whole.sheet(), moving, local, n)), mass, std::move(cloth),
        contact.body_within_travel(x, moving, travel), contact.options());
    static_cast<Loads&>(*part.problem) = part_of(static_cast<const Loads&>(whole), moving, local);
    for (int k = 0; k < n; ++k)
        if (!moving[part.nodes[k]] || whole.pinned()[part.nodes[k]]) part.problem->pin(k);
    part.problem->begin_as_part(whole, part.nodes, x);
    return part;
}

int relax_part(ClothProblem& whole, Points& x, const Eigen::VectorXd& step, double residual, double travel,
               const SettleOptions& options) {
    if (residual < least_residual) return 0;
    const std::vector<char> moving = moved_most(whole.contact().cloth().triangles, step);
    if (std::count(moving.begin(), moving.end(), 1) > most_of_all * double(x.size())) return 0;

    const ClothPart part = part_of(whole, x, moving, travel);
    Points at;
    for (const int i : part.nodes) at.push_back(x[i]);
    SettleOptions o;
    o.tolerance = std::max(options.tolerance, gain * residual);
    o.max_iterations = most_iterations;
    o.exact_below = options.exact_below;
    o.time_step = 1e6; // what stands still round it holds it: no mass is needed
    o.max_step = step_share * travel;
    o.progress = [&](int, double) { return farthest(part, x, at) < far * travel; };
    Cholesky factor;
    const SettleResult r = settle(*part.problem, at, factor, o);
    for (std::size_t k = 0; k < at.size(); ++k) x[part.nodes[k]] = at[k];
    whole.end_part(*part.problem, part.nodes, x);
    return r.iterations;
}

} // namespace toile

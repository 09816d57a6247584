// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/contact/cloth_friction.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace toile {

namespace {

constexpr double far_slid = 1e-3;      // m, from which on a tie is anchored anew
constexpr double least_cosine = 0.88;  // of a turn from one state to the next, beyond which a tie begins anew
constexpr double least_sine = 0.03;    // between edges that say how a pair has turned
constexpr int sweeps = 300;

template <class Pair> auto key(const Pair& p) { return std::tie(p.edge_edge, p.point); }

/// Axes that turn with a pair; false for edges that are all but parallel, which hardly press.
bool axes(const Points& x, const Tie& tie, Mat3& m) {
    const auto& p = tie.point;
    const Vec3 along = (tie.edge_edge ? x[p[1]] - x[p[0]] : x[p[2]] - x[p[1]]).normalized();
    const Vec3 across = along.cross((x[p[3]] - (tie.edge_edge ? x[p[2]] : x[p[1]])).normalized());
    if (!(across.norm() > least_sine)) return false;
    const Vec3 normal = across.normalized();
    m << along, normal, along.cross(normal);
    return true;
}

/// How a pair has turned, as far as it can be told; false when it is too much for a tie.
bool turn_of(const Tie& tie, const Points& before, const Points& x, Mat3& turn) {
    Mat3 old, now;
    turn = axes(before, tie, old) && axes(x, tie, now) ? Mat3(now * old.transpose()) : Mat3::Identity();
    return 0.5 * (turn.trace() - 1) > least_cosine;
}

Tie new_tie(const PairForce& f, const Points& x) {
    Tie tie;
    tie.point = f.point;
    tie.weight = f.weight;
    tie.edge_edge = f.edge_edge;
    tie.normal = f.force.normalized();
    tie.place = held_vector(tie, x);
    return tie;
}

Tie gone_on(Tie tie, const Friction& f, const PairForce& now, const Points& before, const Points& x) {
    Mat3 turn;
    if (turn_of(tie, before, x, turn)) {
        tie.place = turn * tie.place;
        tie.normal = turn * tie.normal;
    } else {
        tie.place = held_vector(tie, x);
        tie.normal = now.force.normalized();
    }
    Vec3 u = slide(tie, x);
    if (u.norm() > far_slid) {
        u = dragged(f, u);
        tie.weight = now.weight;
        tie.place = held_vector(tie, x) - u;
    }
    return tie;
}

/// One tie of a take-up.
struct Held {
    const Tie* tie;
    double most;                    ///< N
    std::array<double, 4> weight{}; ///< 0 where a node is pinned
    double squares = 0;             ///< sum of the squared weights
    Vec3 force = Vec3::Zero();

    Vec3 gather(const Eigen::VectorXd& g) const {
        Vec3 sum = Vec3::Zero();
        for (int k = 0; k < 4; ++k) sum += weight[k] * g.segment<3>(3 * tie->point[k]);
        return sum;
    }
    /// The best that it can do while the others stay as they are.
    void relax(Eigen::VectorXd& g) {
        Vec3 next = force + gather(g) / squares;
        next -= next.dot(tie->normal) * tie->normal;
        if (const double size = next.norm(); size > most) next *= most / size;
        for (int k = 0; k < 4; ++k) g.segment<3>(3 * tie->point[k]) -= weight[k] * (next - force);
        force = next;
    }
};

Held held_by(const Friction& f, const Tie& tie, const std::vector<char>& pinned) {
    Held h{&tie, hardest(f, tie)};
    for (int k = 0; k < 4; ++k) {
        if (pinned[tie.point[k]]) continue;
        h.weight[k] = tie.weight[k];
        h.squares += tie.weight[k] * tie.weight[k];
    }
    if (!(h.squares > 0)) h.most = 0;
    return h;
}

} // namespace

void match_ties(Friction& f, const std::vector<PairForce>& forces, const Points& before, const Points& x) {
    std::vector<Tie> ties;
    ties.reserve(forces.size());
    auto old = f.ties.begin();
    for (const PairForce& now : forces) {
        while (old != f.ties.end() && key(*old) < key(now)) ++old;
        const bool same = old != f.ties.end() && key(*old) == key(now);
        ties.push_back(same ? gone_on(*old, f, now, before, x) : new_tie(now, x));
    }
    f.ties = std::move(ties);
}

void sort_ties(Friction& f) {
    std::sort(f.ties.begin(), f.ties.end(), [](const Tie& a, const Tie& b) { return key(a) < key(b); });
}

void take_up(Friction& body, Friction& cloth, const Points& x, const std::vector<char>& pinned, Eigen::VectorXd& g) {
    std::vector<Held> held;
    for (const Friction* f : {&cloth, &body})
        for (const Tie& tie : f->ties) held.push_back(held_by(*f, tie, pinned));
    for (int sweep = 0; sweep < sweeps; ++sweep) // projected Gauss-Seidel
        for (Held& h : held)
            if (h.most > 0) h.relax(g);
    auto h = held.begin();
    for (int t = 0; t < int(cloth.ties.size()); ++t) hold_by(cloth, x, t, (h++)->force);
    for (int t = 0; t < int(body.ties.size()); ++t, ++h) {
        const Vec3 force = h->force + h->gather(g);
        if (!(h->most > 0 && force.norm() > 0)) continue;
        Vec3& normal = body.ties[t].normal;
        const Vec3 along = force.normalized();
        if (std::abs(normal.dot(along)) < 0.5) normal = (normal - normal.dot(along) * along).normalized();
        hold_by(body, x, t, force - force.dot(normal) * normal);
    }
}

} // namespace toile

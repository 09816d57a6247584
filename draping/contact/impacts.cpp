// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/contact/impacts.h"

#include "geometry/exact_contact.h"
#include "geometry/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace toile {

namespace {

constexpr double nearest_share = 0.1; // of a pair's distance, to which pairs may come
constexpr double start_share = 0.5;   // of what they begin with, if that is less
constexpr double keep = 0.01;         // of the rest, lest the search for the time of impact never end

} // namespace

Contact pair_finder(ContactCloth cloth, const TriMesh& body, double reach_body, double reach_cloth, bool self) {
    return Contact(std::move(cloth), body, {{reach_body, 0, 0}, {reach_cloth, 0, 0}, self});
}

StepPairs::StepPairs(Contact& contact, const ResponseStep& step, const ResponseOptions& options, Points& v)
    : contact_(contact), step_(step), options_(options), v_(v), nodes_(int(v.size())),
      body_dx_(step.body_end.size()), body_velocity_(step.body_end.size()), other_(v.size(), Vec3::Zero()) {
    for (std::size_t i = 0; i < body_dx_.size(); ++i) {
        body_dx_[i] = step.body_end[i] - contact.body()[i];
        body_velocity_[i] = body_dx_[i] / step.dt;
        body_moves_ = body_moves_ || !body_dx_[i].isZero(0);
    }
    renew();
}

void StepPairs::renew() {
    dx_ = step_.dt * flat(v_);
    contact_.prepare(step_.x, dx_, body_moves_ ? &body_dx_ : nullptr);
}

std::optional<Impact> StepPairs::impact(int i) const { return impact(i, nearest_share * pair(i).distance); }

std::optional<Impact> StepPairs::impact(int i, double nearest) const {
    const ContactPair p = contact_.pair(i);
    Motion m;
    m.x = contact_.corners(step_.x, p);
    for (int k = 0; k < 4; ++k) m.dx[k] = is_node(p.p[k]) ? Vec3(step_.dt * v_[p.p[k]]) : body_dx_[p.p[k] - nodes_];
    const double start = pair_geometry(m.x, p.edge_edge).d;
    const ToiOptions options{.keep = keep, .min_distance = std::min(nearest, start_share * start)};
    const double t = p.edge_edge ? time_of_impact_edge_edge(m, options) : time_of_impact_point_triangle(m, options);
    if (t >= 1) return {};
    for (int k = 0; k < 4; ++k) m.x[k] += t * m.dx[k];
    return Impact{i, pair_geometry(m.x, p.edge_edge)};
}

bool StepPairs::touches(int i) const {
    const ContactPair p = contact_.pair(i);
    const std::array<Vec3, 4> from = contact_.corners(step_.x, p);
    std::array<Vec3, 4> to;
    for (int k = 0; k < 4; ++k)
        to[k] = is_node(p.p[k]) ? Vec3(from[k] + step_.dt * v_[p.p[k]]) : step_.body_end[p.p[k] - nodes_];
    const PairKind kind = p.edge_edge ? PairKind::edge_edge : PairKind::point_triangle;
    return time_of_contact(kind, from, to, ToiOptions{}).has_value();
}

std::vector<int> StepPairs::reachable() const {
    return contact_.within_reach(step_.x, dx_, body_moves_ ? &body_dx_ : nullptr);
}

PairGeometry StepPairs::geometry(int i) const {
    return pair_geometry(contact_.corners(step_.x, pair(i)), pair(i).edge_edge);
}

std::vector<Impact> StepPairs::impacts() {
    renew();
    const std::vector<int> near = reachable();
    const int n = int(near.size()), chunk = 256, chunks = chunk_count(n, chunk);
    std::vector<std::vector<Impact>> found(chunks);
    parallel_for(n, chunk, [&](int begin, int end) {
        for (int k = begin; k < end; ++k)
            if (const auto hit = impact(near[k])) found[k / chunk].push_back(*hit);
    });
    std::vector<Impact> all;
    for (const auto& f : found) all.insert(all.end(), f.begin(), f.end());
    return all;
}

Vec3 StepPairs::closing(int i, const PairGeometry& g) const {
    Vec3 rate = Vec3::Zero();
    for (int k = 0; k < 4; ++k) rate += g.weight[k] * velocity(pair(i).p[k]);
    return rate;
}

double StepPairs::mobility(int i, const PairGeometry& g) const {
    double sum = 0;
    for (int k = 0; k < 4; ++k) sum += g.weight[k] * g.weight[k] * inverse_mass(pair(i).p[k]);
    return sum;
}

void StepPairs::push(int i, const PairGeometry& g, const Vec3& impulse, bool counts) {
    const ContactPair p = pair(i);
    if (counts && p.with_body) {
        Pushed& pushed = on_body_[{p.p, p.edge_edge}];
        pushed.impulse += impulse;
        pushed.weight = g.weight;
    }
    for (int k = 0; k < 4; ++k) {
        if (!is_node(p.p[k])) continue;
        v_[p.p[k]] += g.weight[k] * inverse_mass(p.p[k]) * impulse;
        if (counts && !p.with_body) other_[p.p[k]] += g.weight[k] * impulse;
    }
}

Vec3 StepPairs::friction(int i, const PairGeometry& g, double along) const {
    const Vec3 rate = closing(i, g), sliding = rate - rate.dot(g.normal) * g.normal;
    const double speed = sliding.norm();
    const double coefficient = pair(i).with_body ? options_.body_friction : options_.cloth_friction;
    if (speed == 0) return Vec3::Zero();
    return -std::min(coefficient * along, speed / mobility(i, g)) / speed * sliding;
}

void StepPairs::note_zone(int node, const Vec3& impulse, int body_point) {
    if (body_point < 0 || impulse.isZero(0)) {
        other_[node] += impulse;
        return;
    }
    Touch t;
    t.point = {node, body_point, body_point, body_point};
    t.weight = {1, -1, 0, 0};
    t.normal = impulse.normalized();
    t.force = impulse / step_.dt;
    t.welded = true;
    welds_.push_back(t);
}

void StepPairs::finish(ResponseDone& done, bool holds) {
    done.other_force.assign(nodes_, Vec3::Zero());
    for (int i = 0; i < nodes_; ++i) done.other_force[i] = other_[i] / step_.dt;
    if (holds) {
        for (const ActivePair& a : near()) {
            const ContactPair p = pair(a.pair);
            if (!p.with_body || a.geometry.d == 0) continue;
            const auto pushed = on_body_.extract({p.p, p.edge_edge});
            const Vec3 force = pushed ? Vec3(pushed.mapped().impulse / step_.dt) : Vec3::Zero();
            done.touches.push_back({p.p, a.geometry.weight, a.geometry.normal, force, p.edge_edge, false});
        }
        done.touches.insert(done.touches.end(), welds_.begin(), welds_.end());
        std::sort(done.touches.begin(), done.touches.end(), before);
    }
    for (const auto& [pair, pushed] : on_body_) // out of reach at the start, or none that holds
        for (int k = 0; k < 4; ++k)
            if (is_node(pair.first[k])) done.other_force[pair.first[k]] += pushed.weight[k] / step_.dt * pushed.impulse;
    contact_.set_body(step_.body_end);
}

} // namespace toile

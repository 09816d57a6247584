// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/contact/impacts.h"

#include "geometry/parallel.h"
#include "geometry/toi.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace toile {

namespace {

constexpr double nearest_share = 0.1; // of a pair's distance, to which pairs may come
constexpr double start_share = 0.5;   // of what they begin with, if that is less
constexpr double keep = 0.01;         // of the rest, lest the search for the time of impact never end

bool on_face(const ContactPair& p, int nodes) { return p.with_body && !p.edge_edge && p.p[0] < nodes; }

} // namespace

Contact pair_finder(ContactCloth cloth, const TriMesh& body, double reach_body, double reach_cloth, bool self) {
    return Contact(std::move(cloth), body, {{reach_body, 0, 0}, {reach_cloth, 0, 0}, self});
}

StepPairs::StepPairs(Contact& contact, const ResponseStep& step, const ResponseOptions& options, Points& v)
    : contact_(contact), step_(step), options_(options), v_(v), nodes_(int(v.size())),
      body_dx_(step.body_end.size()), body_velocity_(step.body_end.size()), touch_(v.size(), Vec3::Zero()),
      other_(v.size(), Vec3::Zero()) {
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
    const ContactPair& p = contact_.pair(i);
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

Vec3 StepPairs::closing(const ContactPair& p, const PairGeometry& g) const {
    Vec3 rate = Vec3::Zero();
    for (int k = 0; k < 4; ++k) rate += g.weight[k] * velocity(p.p[k]);
    return rate;
}

double StepPairs::mobility(const ContactPair& p, const PairGeometry& g) const {
    double sum = 0;
    for (int k = 0; k < 4; ++k) sum += g.weight[k] * g.weight[k] * inverse_mass(p.p[k]);
    return sum;
}

void StepPairs::push(const ContactPair& p, const PairGeometry& g, const Vec3& impulse) {
    Points& record = on_face(p, nodes_) ? touch_ : other_;
    for (int k = 0; k < 4; ++k) {
        if (!is_node(p.p[k])) continue;
        v_[p.p[k]] += g.weight[k] * inverse_mass(p.p[k]) * impulse;
        record[p.p[k]] += g.weight[k] * impulse;
    }
}

void StepPairs::push_with_friction(const ContactPair& p, const PairGeometry& g, double along) {
    const Vec3 rate = closing(p, g), sliding = rate - rate.dot(g.normal) * g.normal;
    const double speed = sliding.norm(), coefficient = p.with_body ? options_.body_friction : options_.cloth_friction;
    Vec3 impulse = along * g.normal;
    if (speed > 0) impulse -= std::min(coefficient * along, speed / mobility(p, g)) / speed * sliding;
    push(p, g, impulse);
}

void StepPairs::finish(ResponseDone& done) {
    done.touch = touches_at(contact_, step_.x);
    done.other_force.assign(nodes_, Vec3::Zero());
    for (int i = 0; i < nodes_; ++i) {
        done.other_force[i] = other_[i] / step_.dt;
        if (done.touch[i].on)
            done.touch[i].force = touch_[i] / step_.dt;
        else
            done.other_force[i] += touch_[i] / step_.dt; // of a face that was out of reach at the start
    }
    contact_.set_body(step_.body_end);
}

std::vector<NodeTouch> touches_at(const Contact& contact, const Points& x) {
    std::vector<NodeTouch> touch(x.size());
    std::vector<double> nearest(x.size(), std::numeric_limits<double>::infinity());
    for (const ActivePair& a : contact.active(x)) {
        const ContactPair& p = contact.pair(a.pair);
        if (!on_face(p, int(x.size())) || a.geometry.d >= nearest[p.p[0]]) continue;
        nearest[p.p[0]] = a.geometry.d;
        NodeTouch& t = touch[p.p[0]];
        t.on = true;
        t.normal = a.geometry.normal;
        for (int k = 0; k < 3; ++k) {
            t.corner[k] = p.p[k + 1] - int(x.size());
            t.weight[k] = -a.geometry.weight[k + 1];
        }
    }
    return touch;
}

} // namespace toile

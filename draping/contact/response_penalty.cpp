// SPDX-License-Identifier: GPL-3.0-or-later
// Penalties: springs and dampers between what is too near. Moore, Wilhelms: Collision Detection and Response for
// Computer Animation, 1988, with a weaker spring on the way out; the shares of a face's corners and of an edge's ends
// are the barycentric coordinates of the place that touches.
#include "draping/contact/response_penalty.h"

#include "draping/contact/impacts.h"
#include "geometry/edges.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace toile {

namespace {

class Penalties final : public Response {
public:
    Penalties(ContactCloth cloth, const TriMesh& body, const ResponseOptions& options)
        : options_(options), triangles_(body.triangles), edges_(make_edges(body.triangles, int(body.points.size()))),
          contact_(pair_finder(std::move(cloth), body, std::max(options.thickness, options.depth), options.thickness,
                               options.self)) {}

    ResponseDone respond(const ResponseStep& step, Points& v) override {
        StepPairs pairs(contact_, step, options_, v);
        ResponseDone done;
        const Normals normals = normals_at(contact_.body());
        for (const auto& [pair, g, overlap] : overlaps(pairs, normals)) {
            if (pairs.mobility(pair, g) == 0) continue;
            push(pairs, step, pair, g, overlap);
            ++done.repulsions;
        }
        pairs.finish(done, false); // springs push nodes about, they hold none
        return done;
    }

    Guarantee guarantee() const override { return Guarantee::none; }
    bool known_at_start() const override { return true; }
    const Points& body() const override { return contact_.body(); }
    const ResponseOptions& options() const override { return options_; }

private:
    struct Normals {
        Points face, edge, point; ///< unit, out of the body
    };
    struct Overlap {
        int pair = 0;
        PairGeometry at;    ///< its normal out of the body
        double overlap = 0; ///< m, by which the pair is too near, or one has passed the other
    };

    Normals normals_at(const Points& body) const {
        Normals n{Points(triangles_.size()), Points(edges_.size(), Vec3::Zero()), Points(body.size(), Vec3::Zero())};
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            const Triangle& k = triangles_[t];
            const Vec3 area = (body[k[1]] - body[k[0]]).cross(body[k[2]] - body[k[0]]);
            n.face[t] = area.normalized();
            for (int c = 0; c < 3; ++c) {
                n.edge[edges_.of_triangle[t][c]] += n.face[t];
                n.point[k[c]] += area;
            }
        }
        for (Points* all : {&n.edge, &n.point})
            for (Vec3& v : *all) v.normalize();
        return n;
    }

    int face_of(std::array<int, 3> corner) const {
        // Pairs name a face by its corners; its edges lead to it.
        std::sort(corner.begin(), corner.end());
        const int e = edge_between(edges_, corner[0], corner[1]);
        for (int k = edges_.first[e]; k < edges_.first[e + 1]; ++k) {
            Triangle t = triangles_[edges_.incident[k]];
            std::sort(t.begin(), t.end());
            if (t == corner) return edges_.incident[k];
        }
        return -1;
    }

    Vec3 out_of_body(const ContactPair& p, const Normals& n, int nodes) const {
        if (p.edge_edge) return n.edge[edge_between(edges_, p.p[2] - nodes, p.p[3] - nodes)];
        if (p.p[0] < nodes) return n.face[face_of({p.p[1] - nodes, p.p[2] - nodes, p.p[3] - nodes})];
        return -n.point[p.p[0] - nodes]; // the point is the first of the pair
    }

    /// Pairs of cloth have no inside: their overlap is what is missing to the thickness. Of the body, every node has the
    /// one nearest face, from either side of it, every edge the nearest edge and every triangle the nearest point,
    /// these within the thickness: a fine body would have springs without number.
    std::vector<Overlap> overlaps(const StepPairs& pairs, const Normals& normals) const {
        const int nodes = contact_.node_count();
        struct Nearest {
            Overlap overlap;
            double distance = 0, upright = 0; ///< the latter: how straight above the face
        };
        std::vector<Overlap> all;
        std::map<std::array<int, 3>, Nearest> on_body; // per node, edge or triangle of the cloth
        for (const ActivePair& a : pairs.near()) {
            const ContactPair p = pairs.pair(a.pair);
            Overlap o{a.pair, a.geometry, p.distance - a.geometry.d};
            if (!p.with_body) {
                if (a.geometry.d > 0) all.push_back(o);
                continue;
            }
            const Vec3 out = out_of_body(p, normals, nodes);
            if (a.geometry.d == 0) o.at.normal = out;
            const double upright = a.geometry.normal.dot(out);
            if (upright < 0) o.at.normal = -o.at.normal;
            o.overlap = options_.thickness - (upright < 0 ? -a.geometry.d : a.geometry.d);
            const bool node = !p.edge_edge && p.p[0] < nodes;
            if (!node && a.geometry.d >= options_.thickness) continue;
            const std::array<int, 3> simplex = node          ? std::array{p.p[0], -1, -1}
                                               : p.edge_edge ? std::array{p.p[0], p.p[1], -1}
                                                             : std::array{p.p[1], p.p[2], p.p[3]};
            const Nearest now{o, a.geometry.d, std::abs(upright)};
            Nearest& best = on_body.try_emplace(simplex, now).first->second;
            if (now.distance < best.distance || (now.distance == best.distance && now.upright > best.upright)) best = now;
        }
        for (const auto& [simplex, nearest] : on_body)
            if (nearest.overlap.overlap > 0) all.push_back(nearest.overlap);
        return all;
    }

    /// Springs and dampers by the velocities at the start of the step: at rest they bear exactly what weighs on them.
    void push(StepPairs& pairs, const ResponseStep& step, int pair, const PairGeometry& g, double overlap) const {
        const ContactPair p = pairs.pair(pair);
        Vec3 rate = Vec3::Zero();
        for (int k = 0; k < 4; ++k)
            rate += g.weight[k] * (pairs.is_node(p.p[k]) ? step.start_velocity[p.p[k]] : pairs.velocity(p.p[k]));
        const double leaving = rate.dot(g.normal);
        const double spring = options_.stiffness * overlap * (leaving > 0 ? options_.separation_share : 1);
        const double force = std::max(0.0, spring - options_.normal_damping * leaving);
        const Vec3 sliding = rate - leaving * g.normal;
        const double speed = sliding.norm(), coefficient = p.with_body ? options_.body_friction : options_.cloth_friction;
        Vec3 total = force * g.normal;
        if (speed > 0) total -= std::min(options_.tangential_damping * speed, coefficient * force) / speed * sliding;
        pairs.push(pair, g, step.dt * total);
    }

    ResponseOptions options_;
    std::vector<Triangle> triangles_;
    EdgeTable edges_;
    Contact contact_;
};

} // namespace

std::unique_ptr<Response> penalty_response(ContactCloth cloth, const TriMesh& body, const ResponseOptions& options) {
    return std::make_unique<Penalties>(std::move(cloth), body, options);
}

} // namespace toile

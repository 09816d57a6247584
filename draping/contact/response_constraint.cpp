// SPDX-License-Identifier: GPL-3.0-or-later
// Constraints: a node that meets a face of the body takes over the face's velocity along its normal. Baraff, Witkin:
// Large Steps in Cloth Simulation, 1998, section 5; the friction is Coulomb's, of the force that holds.
#include "draping/contact/response_constraint.h"

#include "draping/contact/impacts.h"

#include <algorithm>

namespace toile {

namespace {

constexpr double reach_share = 1.25; // of the thickness: farther out a node is free
constexpr int most_faces = 8;        // corrections of a node, which may lie in a corner of several faces,
constexpr double small_share = 1e-3; // until they move it by less than this share of the thickness

class Constraints final : public Response {
public:
    Constraints(ContactCloth cloth, const TriMesh& body, const ResponseOptions& options)
        : options_(options),
          contact_(pair_finder(std::move(cloth), body, reach_share * options.thickness, 0, false)),
          held_(contact_.node_count(), 0) {}

    ResponseDone respond(const ResponseStep& step, Points& v) override {
        StepPairs pairs(contact_, step, options_, v);
        ResponseDone done;
        const std::vector<std::vector<int>> faces = faces_of_nodes(pairs, step);
        for (int i = 0; i < int(v.size()); ++i) {
            const bool holds = step.inverse_mass[i] > 0 && hold(pairs, step.dt, faces[i], held_[i]);
            held_[i] = holds;
            done.held += holds;
            done.unresolved += passes(pairs, faces[i]);
        }
        pairs.finish(done, true);
        // Edges, and points of the body under the cloth, hold nothing.
        std::erase_if(done.touches, [&](const Touch& t) { return t.edge_edge || !pairs.is_node(t.point[0]); });
        return done;
    }

    Guarantee guarantee() const override { return Guarantee::no_node_in_body; }
    const Points& body() const override { return contact_.body(); }
    const ResponseOptions& options() const override { return options_; }

private:
    /// Pairs of each node with the faces that it may meet in the step.
    std::vector<std::vector<int>> faces_of_nodes(StepPairs& pairs, const ResponseStep& step) const {
        std::vector<std::vector<int>> faces(step.x.size());
        for (const int k : pairs.reachable())
            if (const ContactPair p = pairs.pair(k); !p.edge_edge && pairs.is_node(p.p[0])) faces[p.p[0]].push_back(k);
        return faces;
    }

    static bool passes(const StepPairs& pairs, const std::vector<int>& faces) {
        return std::any_of(faces.begin(), faces.end(), [&](int face) { return pairs.touches(face); });
    }

    /// Lets a node pass none of the faces; returns whether one holds it.
    bool hold(StepPairs& pairs, double dt, const std::vector<int>& faces, bool was_held) const {
        bool is_held = false, free = false;
        for (int k = 0; k < most_faces && !free; ++k) {
            free = true;
            for (const int face : faces) {
                PairGeometry at = pairs.geometry(face);
                double room = 0; // m, that the node may still go: it arrives on the face without bouncing
                if (at.d >= options_.thickness * (was_held ? reach_share : 1)) {
                    const auto impact = pairs.impact(face, options_.thickness);
                    if (!impact) continue;
                    room = std::max(0.0, at.d - options_.thickness);
                    at = impact->at;
                }
                const double approach = -pairs.closing(face, at).dot(at.normal) - room / dt;
                if (approach <= 0) continue; // the force would pull
                pairs.push_with_friction(face, at, approach / pairs.mobility(face, at));
                is_held = true;
                free = free && approach * dt < small_share * options_.thickness;
            }
        }
        if (!passes(pairs, faces)) return is_held;
        // A corner that leaves no room: the node stays with the place of the body that it is nearest to.
        const int face = *std::min_element(faces.begin(), faces.end(), [&](int a, int b) {
            return pairs.geometry(a).d < pairs.geometry(b).d;
        });
        const PairGeometry at = pairs.geometry(face);
        pairs.push(face, at, -pairs.closing(face, at) / pairs.mobility(face, at));
        return true;
    }

    ResponseOptions options_;
    Contact contact_;
    std::vector<char> held_; ///< since the step before
};

} // namespace

std::unique_ptr<Response> constraint_response(ContactCloth cloth, const TriMesh& body, const ResponseOptions& options) {
    return std::make_unique<Constraints>(std::move(cloth), body, options);
}

} // namespace toile

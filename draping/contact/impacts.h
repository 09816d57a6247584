// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The pairs of one step of a response: which are near, which meet, and impulses between them.

#include "draping/contact/response.h"

#include <map>
#include <optional>

namespace toile {

/// Contact that lists pairs within `reach_body` and `reach_cloth`; it has no barrier.
Contact pair_finder(ContactCloth cloth, const TriMesh& body, double reach_body, double reach_cloth, bool self);

/// A pair that meets if nothing is done.
struct Impact {
    int pair = 0;
    PairGeometry at; ///< when it does
};

/// The pairs of a step at the velocities `v`, which impulses change.
class StepPairs {
public:
    StepPairs(Contact& contact, const ResponseStep& step, const ResponseOptions& options, Points& v);

    /// Sees to it that the contact's list serves the motion by `v`; to be called after v has changed otherwise.
    void renew();

    /// Pairs nearer than their distance at the start.
    std::vector<ActivePair> near() const { return contact_.active(step_.x); }
    /// Pairs that meet within the step, in the order of the list.
    std::vector<Impact> impacts();
    /// The pair, if it would come nearer than `nearest`, m, or than half of what it begins with.
    std::optional<Impact> impact(int pair, double nearest) const;
    /// The same for a tenth of the pair's distance.
    std::optional<Impact> impact(int pair) const;
    /// Whether the pair touches at all on its way to the places as the step will write them down: without rounding.
    bool touches(int pair) const;
    /// Pairs that may come nearer than their distance, rising.
    std::vector<int> reachable() const;
    PairGeometry geometry(int i) const; ///< at the start

    ContactPair pair(int i) const { return contact_.pair(i); }
    double inverse_mass(int point) const { return point < nodes_ ? step_.inverse_mass[point] : 0; }
    Vec3 velocity(int point) const { return point < nodes_ ? v_[point] : body_velocity_[point - nodes_]; }
    const Points& body_velocity() const { return body_velocity_; }
    bool is_node(int point) const { return point < nodes_; }
    Vec3 place(int point) const { return point < nodes_ ? step_.x[point] : contact_.body()[point - nodes_]; }

    /// Rate of the vector between the nearest points.
    Vec3 closing(int pair, const PairGeometry& g) const;
    /// What an impulse of 1 N s changes of that rate; 0 when neither side can move.
    double mobility(int pair, const PairGeometry& g) const;
    /// An impulse (N s) on the first of the pair and its opposite on the second, shared out by barycentric weights,
    /// as Bridson, Fedkiw and Anderson 2002 do. One that corrects places does not count as force.
    void push(int pair, const PairGeometry& g, const Vec3& impulse, bool counts = true);
    /// What friction makes of an impulse of `along` N s on the normal: Coulomb's law for impulses.
    Vec3 friction(int pair, const PairGeometry& g, double along) const;
    void push_with_friction(int pair, const PairGeometry& g, double along) {
        push(pair, g, along * g.normal + friction(pair, g, along));
    }
    /// Notes what zones did to a node: that it is welded to a point of the body, or moved otherwise (-1).
    void note_zone(int node, const Vec3& impulse, int body_point);

    /// Forces of what was pushed, and the pairs near the body as touches unless springs alone act; the body then is
    /// where the step ends.
    void finish(ResponseDone& done, bool holds);

private:
    Contact& contact_;
    const ResponseStep& step_;
    const ResponseOptions& options_;
    Points& v_;
    int nodes_ = 0;
    Points body_dx_, body_velocity_;
    bool body_moves_ = false;
    Eigen::VectorXd dx_;
    struct Pushed {
        Vec3 impulse = Vec3::Zero(); ///< N s
        std::array<double, 4> weight{};
    };
    std::map<std::pair<std::array<int, 4>, bool>, Pushed> on_body_; ///< by points and kind of a pair: indices change
    std::vector<Touch> welds_;
    Points other_;                ///< N s by node
};

} // namespace toile

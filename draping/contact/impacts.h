// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The pairs of one step of a response: which are near, which meet, and impulses between them.

#include "draping/contact/response.h"

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
    /// Pairs that may come nearer than their distance, rising.
    std::vector<int> reachable() const;
    PairGeometry geometry(int i) const; ///< at the start

    const ContactPair& pair(int i) const { return contact_.pair(i); }
    double inverse_mass(int point) const { return point < nodes_ ? step_.inverse_mass[point] : 0; }
    Vec3 velocity(int point) const { return point < nodes_ ? v_[point] : body_velocity_[point - nodes_]; }
    const Points& body_velocity() const { return body_velocity_; }
    bool is_node(int point) const { return point < nodes_; }
    Vec3 place(int point) const { return point < nodes_ ? step_.x[point] : contact_.body()[point - nodes_]; }

    /// Rate of the vector between the nearest points.
    Vec3 closing(const ContactPair& p, const PairGeometry& g) const;
    /// What an impulse of 1 N s changes of that rate; 0 when neither side can move.
    double mobility(const ContactPair& p, const PairGeometry& g) const;
    /// An impulse (N s) on the first of the pair and its opposite on the second, shared out by barycentric weights,
    /// as Bridson, Fedkiw and Anderson 2002 do.
    void push(const ContactPair& p, const PairGeometry& g, const Vec3& impulse);
    /// Pushes by `along` N s along the normal and by what friction makes of it: Coulomb's law for impulses.
    void push_with_friction(const ContactPair& p, const PairGeometry& g, double along);
    /// Notes that a node was pushed otherwise, as part of its force: by the body's faces or by something else.
    void note(int node, const Vec3& impulse, bool by_face) { (by_face ? touch_ : other_)[node] += impulse; }

    /// Forces of what was pushed, and the touches of the pairs near the body, which then is where the step ends.
    void finish(ResponseDone& done);

private:
    Contact& contact_;
    const ResponseStep& step_;
    const ResponseOptions& options_;
    Points& v_;
    int nodes_ = 0;
    Points body_dx_, body_velocity_;
    bool body_moves_ = false;
    Eigen::VectorXd dx_;
    Points touch_, other_; ///< N s per node, by faces of the body and by all else
};

/// The face under every node: of the pairs within their distance at x those of a node with the body, nearest first.
std::vector<NodeTouch> touches_at(const Contact& contact, const Points& x);

} // namespace toile

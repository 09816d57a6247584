// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Contact of a cloth with itself and with a body: the pairs that can touch, the barrier between them, and the
// longest step that leaves them apart.

#include "draping/contact/barrier.h"
#include "draping/algebra/block_matrix.h"
#include "geometry/bvh.h"
#include "geometry/edges.h"
#include "geometry/stopwatch.h"
#include "geometry/tri_mesh.h"

#include <string>

namespace toile {

struct ContactOptions {
    Barrier body;  ///< between cloth and body
    Barrier cloth; ///< between cloth and itself
    bool self = true; ///< contact of the cloth with itself
};

/// The barriers with which garments are draped: they act below `distance` (m), on cloth of `density` (kg/m2), and are as
/// hard in all as the pressure at half a millimetre is; cloth presses on cloth more lightly than on a body.
ContactOptions barriers_at(double distance, double density);

/// The cloth as contact sees it.
struct ContactCloth {
    std::vector<Triangle> triangles;       ///< over nodes
    std::vector<std::array<int, 2>> edges; ///< over nodes
    std::vector<double> node_area;         ///< m2
    std::vector<double> edge_length;       ///< rest, m
    std::vector<double> edge_area;         ///< m2
    std::vector<double> node_reach;        ///< m, smallest rest altitude of the triangles round a node
    /// Nodes of equal group count as one: the nodes of an open seam that closing will merge.
    std::vector<int> group;
    /// A node and the ends of an edge to whose inside it is sewn: what holds the node and what holds the edge lie
    /// on each other and do not touch.
    std::vector<std::array<int, 3>> sewn_to_edge;
    std::vector<char> still; ///< nodes that never move (1 each, or empty): pairs of theirs alone are not looked for
};

/// Marks the nodes of all triangles that have a marked one.
void add_ring(const std::vector<Triangle>& triangles, std::vector<char>& marked);

/// The cloth of nodes whose `local` number is not negative, over these numbers: what has all its nodes there.
ContactCloth part_of(const ContactCloth& cloth, const std::vector<int>& local, int nodes);

/// A point-triangle or edge-edge pair. Indices below the node count are nodes, others are body points.
struct ContactPair {
    std::array<int, 4> p{};
    bool edge_edge = false;
    bool with_body = false;
    double distance = 0; ///< m, this pair's barrier acts below; at most the barrier's
    double weight = 0;   ///< m2
    double fade = 0;     ///< product of squared rest lengths, for edges
};

/// What the list keeps of a pair: in tight folds millions are within reach of a long step, and all but a few thousand of
/// them never act.
struct ListedPair {
    enum Kind : unsigned { node_triangle, node_body_triangle, body_point_triangle, edge_edge, edge_body_edge };
    unsigned kind : 3;
    unsigned near_in_cloth : 1; ///< too near each other on the cloth for the barrier's full distance
    unsigned first : 28;  ///< node, body point or edge
    unsigned second;      ///< triangle or edge
    float built = 0;      ///< m, distance when the list was made, rounded down
    float distance = 0;   ///< m, below which the barrier acts, rounded up
};

/// The farthest that any point of each node, edge and triangle goes, m; those of a body at rest are empty.
struct Travel {
    std::vector<double> node, edge, triangle, body_point, body_edge, body_triangle;
};

/// A pair within reach of its barrier at some state.
struct ActivePair {
    int pair = 0;
    PairGeometry geometry;
    ParallelFade fade;
};

/// With what a pair of cloth and cloth presses.
struct PairForce {
    std::array<int, 4> point{};
    std::array<double, 4> weight{}; ///< of the nearest places; `weight` times the force acts on each node
    bool edge_edge = false;
    Vec3 force = Vec3::Zero();      ///< N
};

class Contact {
public:
    Contact(ContactCloth cloth, const TriMesh& body, const ContactOptions& options);

    const ContactOptions& options() const { return options_; }
    const ContactCloth& cloth() const { return cloth_; }
    /// New barriers; the next prepare() makes a new list.
    void set_options(const ContactOptions& options);

    /// Moves the body; the caller has made sure that nothing is crossed on the way.
    void set_body(const Points& body);
    const Points& body() const { return body_; }

    /// Makes sure that every pair that the step from x by dx (and of the body by body_dx) can bring into reach is
    /// on the list. Does nothing and returns false while the current list still serves.
    bool prepare(const Points& x, const Eigen::VectorXd& dx, const Points* body_dx = nullptr);

    /// The pairs of the list whose barrier acts at x. Those of the last x asked for are kept, since a solver asks again for
    /// the state that it has stepped to; what is returned is good until the next call.
    const std::vector<ActivePair>& active(const Points& x) const;

    double value(const std::vector<ActivePair>& active) const;
    void add_gradient(const std::vector<ActivePair>& active, Eigen::VectorXd& g) const;
    /// Adds second derivatives; `exact` includes the curvature of the distance, otherwise what is added is
    /// positive semidefinite. False when the matrix lacks a block (nothing of that pair is added).
    bool add_hessian(const Points& x, const std::vector<ActivePair>& active, bool exact, BlockMatrix& h) const;

    /// Blocks that active pairs, and pairs that were near when the list was made, couple.
    void couplings(const std::vector<ActivePair>& active, std::vector<std::pair<int, int>>& pairs) const;

    /// Largest t in [0, 1] for which no pair passes its floor between x and x + t dx (and body + t body_dx).
    /// `blocking`, when given, receives the pair that limits t, -1 when none, and `shares` the least such t of each
    /// node's own pairs, followed, when the body moves, by that of each body point's.
    double feasible_step(const Points& x, const Eigen::VectorXd& dx, const Points* body_dx = nullptr,
                         int* blocking = nullptr, std::vector<double>* shares = nullptr) const;

    /// Pairs of the list, rising, that may come nearer than their distance between x and x + t dx (and body +
    /// t body_dx): those whose longest motions cannot bring them there are left out.
    std::vector<int> within_reach(const Points& x, const Eigen::VectorXd& dx, const Points* body_dx = nullptr) const;

    /// Force of the body's barrier on every node, N.
    Points body_forces(const std::vector<ActivePair>& active) const;

    /// Of every active pair of cloth and cloth that presses, sorted by `edge_edge` and `point`.
    std::vector<PairForce> cloth_forces(const std::vector<ActivePair>& active) const;

    /// Pairs nearer than their floor, or touching: none for a start that the barrier can take.
    std::vector<ContactPair> violations(const Points& x);

    /// Nodes of the cloth (1 each, or empty) whose contact with other cloth is left out: what cannot be taken apart
    /// yet must not keep all the rest from touching.
    void leave_out(std::vector<char> nodes);
    const std::vector<char>& left_out() const { return left_out_; }

    /// Marks every node of cloth (1 each) that nodes which are `moving` (1 each) may come within reach of when none
    /// goes farther than `travel` (m) from x, and theirs and those next to them.
    std::vector<char> within_travel(const Points& x, const std::vector<char>& moving, double travel) const;
    /// The body that they may come within reach of meanwhile, with all triangles round each of its points that matters.
    TriMesh body_within_travel(const Points& x, const std::vector<char>& moving, double travel) const;

    /// Moves nodes of cloth that lie too near each other apart, to twice their floor; returns how many pairs still
    /// are too near. For a start that the barrier cannot take but that crosses nothing.
    int widen(Points& x);

    ContactPair pair(int i) const { return pair(pairs_[i]); }
    /// The four points of a pair, those of the body where it is now.
    std::array<Vec3, 4> corners(const Points& x, const ContactPair& p) const;
    int node_count() const { return nodes_; }

    /// Has the wall time of all of the above; what else is part of contact may take laps of its own.
    Stopwatch& clock() const { return clock_; }

private:
    Vec3 at(const Points& x, int i) const { return i < nodes_ ? x[i] : body_[i - nodes_]; }
    Barrier barrier(const ContactPair& p) const;
    double reach(ListedPair::Kind kind) const;
    std::array<int, 4> points(const ListedPair& p) const;
    std::array<Vec3, 4> corners(const Points& x, const std::array<int, 4>& points) const;
    ContactPair pair(const ListedPair& p) const;
    void find_pairs(const std::vector<char>& moved);
    double limited_distance(const std::array<int, 4>& points) const;
    Travel travel(std::vector<double> distance) const;
    Travel travel_of(const Eigen::VectorXd& dx, const Points* body_dx) const;
    Travel travel_since_built(const Points& x) const;
    bool body_serves(const Points* body_dx) const;
    double slack_for(double step) const;
    bool near_in_cloth(bool edge_edge, const std::array<int, 4>& points) const;
    void make_body_trees();

    mutable Stopwatch clock_;
    ContactCloth cloth_;
    ContactOptions options_;
    int nodes_ = 0;
    std::vector<Triangle> body_triangles_;
    std::vector<std::array<int, 2>> body_edges_;
    std::vector<double> body_area_, body_edge_area_;
    Points body_;
    Bvh body_triangle_tree_, body_edge_tree_, body_point_tree_;
    Bvh cloth_triangle_tree_, cloth_edge_tree_;
    std::vector<std::vector<int>> ring_; ///< groups next to a group, sorted
    std::vector<std::vector<int>> sewn_; ///< groups that stitches to the inside of an edge join to a group, sorted

    std::vector<char> left_out_;
    bool built_ = false;
    std::vector<ListedPair> pairs_;
    mutable std::vector<ActivePair> active_; ///< at active_at_, while the list and the body are what they were
    mutable std::vector<float> apart_;       ///< m, there: no pair of the list is nearer than that
    mutable Points active_at_;
    std::vector<int> triangle_of_node_; ///< one of each node's
    double most_slack_ = 0;             ///< m, beyond the step itself
    bool body_moved_ = false;        ///< since body_built_at_
    bool body_serves_ = true;        ///< no body point has left its slack
    Points built_at_;                ///< where each node was when its pairs were looked for
    std::vector<double> slack_;      ///< how far each node may move from there while the list serves
    std::vector<double> body_slack_; ///< the same for body points
    Points body_built_at_;
};

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/types.h"

namespace toile {

using Box = Eigen::AlignedBox3d;

/// A binary tree of axis-aligned boxes over items (points, edges, triangles). The tree's shape is fixed when
/// it is built; `refit` moves the boxes. Traversal order, and so every result, depends on the input alone.
/// Queries are const and may run on many threads at once. Boxes are finite or empty; an empty box meets
/// nothing.
class Bvh {
public:
    Bvh() = default;
    explicit Bvh(const std::vector<Box>& boxes);

    /// New boxes for the same items. Throws std::invalid_argument when their number differs.
    void refit(const std::vector<Box>& boxes);

    /// Calls visit(item) for every item whose box meets `query` (touching counts).
    template <class Visit> void overlapping(const Box& query, Visit&& visit) const;

    /// Calls visit(item of this, item of other) for every pair of boxes that meet.
    template <class Visit> void overlapping(const Bvh& other, Visit&& visit) const;

    /// Calls visit(i, j), i < j, once for every two items of this tree whose boxes meet.
    template <class Visit> void overlapping_pairs(Visit&& visit) const;

    /// The item nearest to p by `squared_distance(item)`; -1 and nothing called when the tree is empty or
    /// when everything is farther than sqrt(limit). `limit` is reduced to the squared distance found. Of
    /// items equally near the lowest is returned.
    template <class Distance> int nearest(const Vec3& p, double& limit, Distance&& squared_distance) const;

    /// The same for something that lies within `query` (an edge, a triangle).
    template <class Distance> int nearest(const Box& query, double& limit, Distance&& squared_distance) const;

    int size() const { return int(order_.size()); }

    /// Box of everything; empty when there is nothing.
    Box bounds() const { return nodes_.empty() ? Box() : nodes_[0].box; }

private:
    // Depth first, so that a left child follows its parent; one cache line each.
    struct alignas(64) Node {
        Box box;
        int begin = 0, end = 0; ///< items order_[begin, end) below this node
        int right = -1;         ///< right child, -1 for a leaf; the left one is the next node
        bool leaf() const { return right < 0; }
    };
    static constexpr int leaf_size = 4;
    static constexpr int max_depth = 96; ///< of the tree, and so of the stacks of its traversals

    struct Builder;
    std::vector<Node> nodes_;
    std::vector<int> order_;
    std::vector<Box> boxes_; ///< of the items, in the tree's order

    template <class Visit>
    void leaf_pairs(const Node& a, const Bvh& other, const Node& b, Visit& visit) const;
};

/// Boxes of triangles, edges or points, grown by `margin` on every side.
std::vector<Box> triangle_boxes(const Points& p, const std::vector<Triangle>& t, double margin);
std::vector<Box> edge_boxes(const Points& p, const std::vector<std::array<int, 2>>& e, double margin);
std::vector<Box> point_boxes(const Points& p, double margin);

} // namespace toile

#include "geometry/bvh_impl.h"

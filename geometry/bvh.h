// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/types.h"

#include <Eigen/Geometry>

#include <functional>

namespace toile {

using Box = Eigen::AlignedBox3d;

/// A binary tree of axis-aligned boxes over items (points, edges, triangles). The tree's shape is fixed when it
/// is built; `refit` moves the boxes. Traversal order, and so every result, depends on the input alone.
class Bvh {
public:
    Bvh() = default;
    explicit Bvh(const std::vector<Box>& boxes);

    /// New boxes for the same items.
    void refit(const std::vector<Box>& boxes);

    /// Calls visit(item) for every item whose box meets `query`.
    template <class Visit> void overlapping(const Box& query, Visit&& visit) const;

    /// Calls visit(item of this, item of other) for every pair of boxes that meet.
    template <class Visit> void overlapping(const Bvh& other, Visit&& visit) const;

    /// The item nearest to p by `squared_distance(item)`; -1 and nothing called when the tree is empty or when
    /// everything is farther than sqrt(limit). `limit` is reduced to the squared distance found.
    template <class Distance> int nearest(const Vec3& p, double& limit, Distance&& squared_distance) const;

    int size() const { return int(order_.size()); }

private:
    struct Node {
        Box box;
        int begin = 0, end = 0; ///< items order_[begin, end) below this node
        int left = -1, right = -1; ///< children, -1 for a leaf
    };
    std::vector<Node> nodes_;
    std::vector<int> order_;
};

/// Boxes of triangles, edges or points, grown by `margin` on every side.
std::vector<Box> triangle_boxes(const Points& p, const std::vector<Triangle>& t, double margin);
std::vector<Box> edge_boxes(const Points& p, const std::vector<std::array<int, 2>>& e, double margin);

} // namespace toile

#include "geometry/bvh_impl.h"

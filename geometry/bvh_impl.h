// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Traversals of geometry/bvh.h.

#include "geometry/bvh.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace toile {

namespace bvh_detail {

// Plain comparisons without early outs: the branches of Eigen's own tests cost more than they save.
inline bool meet(const Box& a, const Box& b) {
    const Vec3 &al = a.min(), &ah = a.max(), &bl = b.min(), &bh = b.max();
    return (al[0] <= bh[0]) & (bl[0] <= ah[0]) & (al[1] <= bh[1]) & (bl[1] <= ah[1]) & (al[2] <= bh[2]) &
           (bl[2] <= ah[2]);
}

inline double squared_distance(const Box& a, const Box& b) {
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
        const double d = std::max({0.0, a.min()[k] - b.max()[k], b.min()[k] - a.max()[k]});
        sum += d * d;
    }
    return sum;
}

inline double size_of(const Box& b) {
    return (b.max() - b.min()).sum();
}

} // namespace bvh_detail

template <class Visit> void Bvh::overlapping(const Box& query, Visit&& visit) const {
    if (nodes_.empty()) return;
    std::array<int, max_depth> stack;
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const int index = stack[--depth];
        const Node& node = nodes_[index];
        if (!bvh_detail::meet(node.box, query)) continue;
        if (!node.leaf()) {
            stack[depth++] = node.right;
            stack[depth++] = index + 1;
            continue;
        }
        for (int i = node.begin; i < node.end; ++i)
            if (bvh_detail::meet(boxes_[i], query)) visit(order_[i]);
    }
}

template <class Visit>
void Bvh::leaf_pairs(const Node& a, const Bvh& other, const Node& b, Visit& visit) const {
    for (int i = a.begin; i < a.end; ++i) {
        if (!bvh_detail::meet(boxes_[i], b.box)) continue;
        for (int j = b.begin; j < b.end; ++j)
            if (bvh_detail::meet(boxes_[i], other.boxes_[j])) visit(order_[i], other.order_[j]);
    }
}

template <class Visit> void Bvh::overlapping(const Bvh& other, Visit&& visit) const {
    if (nodes_.empty() || other.nodes_.empty()) return;
    std::array<std::array<int, 2>, 2 * max_depth> stack;
    int depth = 0;
    stack[depth++] = {0, 0};
    while (depth > 0) {
        const auto [ia, ib] = stack[--depth];
        const Node &a = nodes_[ia], &b = other.nodes_[ib];
        if (!bvh_detail::meet(a.box, b.box)) continue;
        if (a.leaf() && b.leaf()) {
            leaf_pairs(a, other, b, visit);
        } else if (b.leaf() || (!a.leaf() && bvh_detail::size_of(a.box) >= bvh_detail::size_of(b.box))) {
            stack[depth++] = {a.right, ib};
            stack[depth++] = {ia + 1, ib};
        } else {
            stack[depth++] = {ia, b.right};
            stack[depth++] = {ia, ib + 1};
        }
    }
}

template <class Visit> void Bvh::overlapping_pairs(Visit&& visit) const {
    if (nodes_.empty()) return;
    const auto sorted = [&](int i, int j) { i < j ? visit(i, j) : visit(j, i); };
    std::array<std::array<int, 2>, 3 * max_depth> stack;
    int depth = 0;
    stack[depth++] = {0, 0};
    while (depth > 0) {
        const auto [ia, ib] = stack[--depth];
        const Node &a = nodes_[ia], &b = nodes_[ib];
        if (ia == ib) {
            if (!a.leaf()) {
                stack[depth++] = {a.right, a.right};
                stack[depth++] = {ia + 1, a.right};
                stack[depth++] = {ia + 1, ia + 1};
                continue;
            }
            for (int i = a.begin; i < a.end; ++i)
                for (int j = i + 1; j < a.end; ++j)
                    if (bvh_detail::meet(boxes_[i], boxes_[j])) sorted(order_[i], order_[j]);
            continue;
        }
        if (!bvh_detail::meet(a.box, b.box)) continue;
        if (a.leaf() && b.leaf()) {
            leaf_pairs(a, *this, b, sorted);
        } else if (b.leaf() || (!a.leaf() && bvh_detail::size_of(a.box) >= bvh_detail::size_of(b.box))) {
            stack[depth++] = {a.right, ib};
            stack[depth++] = {ia + 1, ib};
        } else {
            stack[depth++] = {ia, b.right};
            stack[depth++] = {ia, ib + 1};
        }
    }
}

template <class Distance> int Bvh::nearest(const Vec3& p, double& limit, Distance&& squared_distance) const {
    return nearest(Box(p, p), limit, squared_distance);
}

template <class Distance>
int Bvh::nearest(const Box& query, double& limit, Distance&& squared_distance) const {
    if (nodes_.empty()) return -1;
    struct Entry {
        int node;
        double squared;
    };
    std::array<Entry, max_depth> stack;
    int depth = 0, best = -1;
    stack[depth++] = {0, bvh_detail::squared_distance(nodes_[0].box, query)};
    while (depth > 0) {
        const Entry entry = stack[--depth];
        if (entry.squared > limit) continue;
        const Node& node = nodes_[entry.node];
        if (!node.leaf()) {
            Entry near{entry.node + 1, bvh_detail::squared_distance(nodes_[entry.node + 1].box, query)};
            Entry far{node.right, bvh_detail::squared_distance(nodes_[node.right].box, query)};
            if (far.squared < near.squared) std::swap(near, far);
            stack[depth++] = far;
            stack[depth++] = near;
            continue;
        }
        for (int i = node.begin; i < node.end; ++i) {
            const double bound = bvh_detail::squared_distance(boxes_[i], query);
            if (bound > limit || bound == std::numeric_limits<double>::infinity()) continue;
            const double d = squared_distance(order_[i]);
            if (d > limit || (d == limit && best >= 0 && order_[i] > best)) continue;
            limit = d;
            best = order_[i];
        }
    }
    return best;
}

} // namespace toile

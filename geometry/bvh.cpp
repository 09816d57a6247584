// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/bvh.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

namespace toile {

// Splits by the surface area heuristic over bins along the longest axis of the centres: Wald, On fast
// Construction of SAH-based Bounding Volume Hierarchies, 2007.
struct Bvh::Builder {
    struct Item {
        Box box;
        Vec3 centre;
        int index;
    };
    static constexpr int bins = 12;
    static constexpr int sah_depth = 48; ///< below it halves, which bounds the depth

    std::vector<Item> items;
    std::vector<Node>& nodes;

    Builder(const std::vector<Box>& boxes, std::vector<Node>& nodes) : nodes(nodes) {
        items.reserve(boxes.size());
        for (int i = 0; i < int(boxes.size()); ++i) {
            const bool empty = boxes[i].isEmpty();
            items.push_back(
                {boxes[i], empty ? Vec3(Vec3::Zero()) : Vec3(0.5 * (boxes[i].min() + boxes[i].max())), i});
        }
        nodes.reserve(boxes.size());
        if (!items.empty()) build(0, int(items.size()), 0);
    }

    static double half_area(const Box& b) {
        if (b.isEmpty()) return 0;
        const Vec3 d = b.max() - b.min();
        return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
    }

    int build(int begin, int end, int depth) {
        const int index = int(nodes.size());
        nodes.emplace_back();
        nodes[index].begin = begin;
        nodes[index].end = end;
        Box box, centres;
        for (int i = begin; i < end; ++i) {
            box.extend(items[i].box);
            centres.extend(items[i].centre);
        }
        nodes[index].box = box;
        if (end - begin <= leaf_size) return index;
        const int middle = split(begin, end, centres, depth);
        build(begin, middle, depth + 1);
        const int right = build(middle, end, depth + 1);
        nodes[index].right = right;
        return index;
    }

    int split(int begin, int end, const Box& centres, int depth) {
        Eigen::Index axis;
        const double extent = (centres.max() - centres.min()).maxCoeff(&axis);
        if (depth < sah_depth && extent > 0) {
            const int middle = split_by_area(begin, end, int(axis), centres.min()[axis], extent);
            if (middle > begin && middle < end) return middle;
        }
        const int middle = begin + (end - begin) / 2;
        std::nth_element(items.begin() + begin, items.begin() + middle, items.begin() + end,
                         [axis](const Item& a, const Item& b) {
                             return a.centre[axis] != b.centre[axis] ? a.centre[axis] < b.centre[axis]
                                                                     : a.index < b.index;
                         });
        return middle;
    }

    int split_by_area(int begin, int end, int axis, double low, double extent) {
        const double scale = bins / extent;
        const auto bin_of = [&](const Item& item) {
            return std::min(bins - 1, int((item.centre[axis] - low) * scale));
        };
        std::array<Box, bins> box;
        std::array<int, bins> count{};
        for (int i = begin; i < end; ++i) {
            const int b = bin_of(items[i]);
            box[b].extend(items[i].box);
            ++count[b];
        }
        std::array<double, bins> left_cost;
        Box grown;
        for (int b = 0, n = 0; b < bins; ++b) {
            grown.extend(box[b]);
            n += count[b];
            left_cost[b] = half_area(grown) * n;
        }
        double best = std::numeric_limits<double>::infinity();
        int best_bin = 0;
        grown.setEmpty();
        for (int b = bins - 1, n = 0; b > 0; --b) {
            grown.extend(box[b]);
            n += count[b];
            const double cost = left_cost[b - 1] + half_area(grown) * n;
            if (n < end - begin && n > 0 && cost < best) {
                best = cost;
                best_bin = b;
            }
        }
        const auto middle = std::partition(items.begin() + begin, items.begin() + end,
                                           [&](const Item& item) { return bin_of(item) < best_bin; });
        return int(middle - items.begin());
    }
};

Bvh::Bvh(const std::vector<Box>& boxes) {
    Builder builder(boxes, nodes_);
    order_.reserve(boxes.size());
    boxes_.reserve(boxes.size());
    for (const Builder::Item& item : builder.items) {
        order_.push_back(item.index);
        boxes_.push_back(item.box);
    }
}

void Bvh::refit(const std::vector<Box>& boxes) {
    if (boxes.size() != order_.size())
        throw std::invalid_argument("the tree was built over " + std::to_string(order_.size()) +
                                    " boxes and cannot be refitted to " + std::to_string(boxes.size()));
    for (std::size_t i = 0; i < order_.size(); ++i)
        boxes_[i] = boxes[order_[i]];
    for (int n = int(nodes_.size()) - 1; n >= 0; --n) {
        Node& node = nodes_[n];
        if (!node.leaf()) {
            node.box = nodes_[n + 1].box.merged(nodes_[node.right].box);
            continue;
        }
        node.box.setEmpty();
        for (int i = node.begin; i < node.end; ++i)
            node.box.extend(boxes_[i]);
    }
}

std::vector<Box> triangle_boxes(const Points& p, const std::vector<Triangle>& t, double margin) {
    std::vector<Box> boxes(t.size());
    const Vec3 grow = Vec3::Constant(margin);
    for (std::size_t i = 0; i < t.size(); ++i) {
        const Vec3 &a = p[t[i][0]], &b = p[t[i][1]], &c = p[t[i][2]];
        boxes[i] = Box(a.cwiseMin(b).cwiseMin(c) - grow, a.cwiseMax(b).cwiseMax(c) + grow);
    }
    return boxes;
}

std::vector<Box> edge_boxes(const Points& p, const std::vector<std::array<int, 2>>& e, double margin) {
    std::vector<Box> boxes(e.size());
    const Vec3 grow = Vec3::Constant(margin);
    for (std::size_t i = 0; i < e.size(); ++i) {
        const Vec3 &a = p[e[i][0]], &b = p[e[i][1]];
        boxes[i] = Box(a.cwiseMin(b) - grow, a.cwiseMax(b) + grow);
    }
    return boxes;
}

std::vector<Box> point_boxes(const Points& p, double margin) {
    std::vector<Box> boxes(p.size());
    const Vec3 grow = Vec3::Constant(margin);
    for (std::size_t i = 0; i < p.size(); ++i)
        boxes[i] = Box(p[i] - grow, p[i] + grow);
    return boxes;
}

} // namespace toile

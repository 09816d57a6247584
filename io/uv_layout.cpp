// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/uv_layout.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace toile {
namespace {

constexpr double gap = 0.01;

using Boxes = std::vector<Eigen::AlignedBox2d>;

Boxes panel_boxes(const Garment& g) {
    Boxes boxes(g.panel_names.size());
    for (std::size_t v = 0; v < g.uv.size(); ++v)
        boxes[std::size_t(g.panel_of_vertex[v])].extend(g.uv[v]);
    for (auto& box : boxes)
        if (box.isEmpty()) box.extend(Vec2(Vec2::Zero()));
    return boxes;
}

// Shelves of the given width, tallest panels first; returns the height used.
double fill_shelves(const Boxes& boxes, const std::vector<int>& order, double width,
                    std::vector<Vec2>& origin) {
    double x = gap, y = gap, shelf = 0;
    for (const int p : order) {
        const Vec2 size = boxes[std::size_t(p)].sizes();
        if (x > gap && x + size.x() + gap > width) {
            y += shelf + gap;
            x = gap;
            shelf = 0;
        }
        origin[std::size_t(p)] = boxes[std::size_t(p)].min() - Vec2(x, y);
        x += size.x() + gap;
        shelf = std::max(shelf, size.y());
    }
    return y + shelf + gap;
}

} // namespace

UvLayout lay_out_panels(const Garment& g) {
    const Boxes boxes = panel_boxes(g);
    std::vector<int> order(boxes.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
        return boxes[std::size_t(a)].sizes().y() > boxes[std::size_t(b)].sizes().y();
    });
    double area = 0, widest = 2 * gap;
    for (const auto& box : boxes) {
        area += (box.sizes().x() + gap) * (box.sizes().y() + gap);
        widest = std::max(widest, box.sizes().x() + 2 * gap);
    }
    UvLayout layout;
    layout.origin.resize(boxes.size());
    // The smallest square: shelves waste space, so it is grown until they fit.
    double width = std::max(widest, std::sqrt(area));
    double height = fill_shelves(boxes, order, width, layout.origin);
    while (height > width) {
        width *= 1.02;
        height = fill_shelves(boxes, order, width, layout.origin);
    }
    layout.scale = width;
    return layout;
}

Vec2 texture_coordinates(const Garment& g, const UvLayout& layout, int vertex) {
    const auto v = std::size_t(vertex);
    return (g.uv[v] - layout.origin[std::size_t(g.panel_of_vertex[v])]) / layout.scale;
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/contact/contact.h"

#include "geometry/solid.h"

#include <algorithm>

namespace toile {

namespace {

template <std::size_t N> bool touches(const std::array<int, N>& simplex, const std::vector<char>& marked) {
    return std::any_of(simplex.begin(), simplex.end(), [&](int i) { return marked[i]; });
}

/// Of every triangle that has a node which moves, grown by what it may go and reach.
Bvh moving_boxes(const ContactCloth& cloth, const Points& x, const std::vector<char>& moving, double margin) {
    std::vector<Box> boxes;
    for (const Triangle& t : cloth.triangles) {
        if (!touches(t, moving)) continue;
        Box box;
        for (const int i : t) box.extend(x[i]);
        boxes.emplace_back(box.min().array() - margin, box.max().array() + margin);
    }
    return Bvh(boxes);
}

template <std::size_t N> bool meets(const Bvh& boxes, const Points& x, const std::array<int, N>& simplex) {
    Box box;
    for (const int i : simplex) box.extend(x[i]);
    if (!boxes.bounds().intersects(box)) return false;
    bool met = false;
    boxes.overlapping(box, [&](int) { met = true; });
    return met;
}

} // namespace

void add_ring(const std::vector<Triangle>& triangles, std::vector<char>& marked) {
    const std::vector<char> before = marked;
    for (const Triangle& t : triangles)
        if (touches(t, before))
            for (const int i : t) marked[i] = 1;
}

ContactCloth part_of(const ContactCloth& cloth, const std::vector<int>& local, int nodes) {
    ContactCloth part;
    const auto inside = [&](const auto& simplex) {
        return std::all_of(simplex.begin(), simplex.end(), [&](int i) { return local[i] >= 0; });
    };
    const auto renumbered = [&](auto simplex) {
        for (int& i : simplex) i = local[i];
        return simplex;
    };
    for (const Triangle& t : cloth.triangles)
        if (inside(t)) part.triangles.push_back(renumbered(t));
    for (std::size_t e = 0; e < cloth.edges.size(); ++e) {
        if (!inside(cloth.edges[e])) continue;
        part.edges.push_back(renumbered(cloth.edges[e]));
        part.edge_length.push_back(cloth.edge_length[e]);
        part.edge_area.push_back(cloth.edge_area[e]);
    }
    part.node_area.resize(nodes);
    part.node_reach.resize(nodes);
    part.group.resize(nodes);
    for (std::size_t i = 0; i < local.size(); ++i) {
        if (local[i] < 0) continue;
        part.node_area[local[i]] = cloth.node_area[i];
        part.node_reach[local[i]] = cloth.node_reach[i];
        part.group[local[i]] = cloth.group[i];
    }
    for (const auto& sewn : cloth.sewn_to_edge)
        if (inside(sewn)) part.sewn_to_edge.push_back(renumbered(sewn));
    return part;
}

std::vector<char> Contact::within_travel(const Points& x, const std::vector<char>& moving, double travel) const {
    std::vector<char> near = moving;
    add_ring(cloth_.triangles, near);
    add_ring(cloth_.triangles, near);
    if (!options_.self) return near;
    const Bvh boxes = moving_boxes(cloth_, x, moving, travel + options_.cloth.distance);
    for (const Triangle& t : cloth_.triangles)
        if (meets(boxes, x, t))
            for (const int i : t) near[i] = 1;
    return near;
}

TriMesh Contact::body_within_travel(const Points& x, const std::vector<char>& moving, double travel) const {
    const Bvh boxes = moving_boxes(cloth_, x, moving, travel + options_.body.distance);
    std::vector<char> near(body_.size(), 0);
    for (const Triangle& t : body_triangles_)
        if (meets(boxes, body_, t))
            for (const int i : t) near[i] = 1;
    add_ring(body_triangles_, near);
    TriMesh part{body_, {}};
    for (const Triangle& t : body_triangles_)
        if (near[t[0]] && near[t[1]] && near[t[2]]) part.triangles.push_back(t);
    drop_unused_points(part);
    return part;
}

} // namespace toile

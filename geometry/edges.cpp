// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/edges.h"

#include "geometry/disjoint_sets.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace toile {

namespace {

struct HalfEdge {
    int high, triangle, side;
};

void check_triangle(const Triangle& t, int index, int point_count) {
    for (int i : t)
        if (i < 0 || i >= point_count)
            throw std::invalid_argument("triangle " + std::to_string(index) + " names point " +
                                        std::to_string(i) + ", expected an index below " +
                                        std::to_string(point_count));
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
        throw std::invalid_argument("triangle " + std::to_string(index) + " names a point twice (" +
                                    std::to_string(t[0]) + ", " + std::to_string(t[1]) + ", " +
                                    std::to_string(t[2]) + "), expected three different points");
}

// Ends of the edge opposite corner k, in the direction of the triangle.
std::array<int, 2> side(const Triangle& t, int k) {
    return {t[(k + 1) % 3], t[(k + 2) % 3]};
}

// Half-edges bucketed by their lower end: bucket i is [start[i], start[i + 1]).
std::vector<HalfEdge> bucket_by_low_end(const std::vector<Triangle>& triangles, std::vector<int>& start) {
    for (const Triangle& t : triangles)
        for (int k = 0; k < 3; ++k) {
            const auto [a, b] = side(t, k);
            ++start[std::min(a, b) + 1];
        }
    for (std::size_t i = 1; i < start.size(); ++i)
        start[i] += start[i - 1];
    std::vector<HalfEdge> halves(3 * triangles.size());
    std::vector<int> cursor(start.begin(), start.end() - 1);
    for (int t = 0; t < int(triangles.size()); ++t)
        for (int k = 0; k < 3; ++k) {
            const auto [a, b] = side(triangles[t], k);
            halves[cursor[std::min(a, b)]++] = {std::max(a, b), t, k};
        }
    return halves;
}

} // namespace

EdgeTable make_edges(const std::vector<Triangle>& triangles, int point_count) {
    for (int t = 0; t < int(triangles.size()); ++t)
        check_triangle(triangles[t], t, point_count);
    std::vector<int> start(point_count + 1, 0);
    std::vector<HalfEdge> halves = bucket_by_low_end(triangles, start);

    EdgeTable table;
    table.of_triangle.resize(triangles.size());
    table.incident.reserve(halves.size());
    for (int low = 0; low < point_count; ++low) {
        // Triangles are ascending within a bucket already; a stable sort keeps them so within an edge.
        std::stable_sort(halves.begin() + start[low], halves.begin() + start[low + 1],
                         [](const HalfEdge& a, const HalfEdge& b) { return a.high < b.high; });
        for (int h = start[low]; h < start[low + 1]; ++h) {
            const HalfEdge& half = halves[h];
            if (h == start[low] || half.high != halves[h - 1].high) {
                table.ends.push_back({low, half.high});
                table.first.push_back(int(table.incident.size()));
            }
            table.of_triangle[half.triangle][half.side] = table.size() - 1;
            table.incident.push_back(half.triangle);
        }
    }
    table.first.push_back(int(table.incident.size()));
    return table;
}

std::vector<int> pieces(const std::vector<Triangle>& triangles, int point_count) {
    DisjointSets sets(point_count);
    for (const Triangle& t : triangles)
        for (int k = 1; k < 3; ++k)
            sets.join(t[0], t[k]);
    return sets.all();
}

int edge_between(const EdgeTable& edges, int a, int b) {
    const std::array<int, 2> ends{std::min(a, b), std::max(a, b)};
    const auto at = std::lower_bound(edges.ends.begin(), edges.ends.end(), ends);
    return at != edges.ends.end() && *at == ends ? int(at - edges.ends.begin()) : -1;
}

double mean_length(const EdgeTable& edges, const Points& points) {
    double sum = 0;
    for (const auto& [a, b] : edges.ends) sum += (points[a] - points[b]).norm();
    return edges.size() > 0 ? sum / edges.size() : 0;
}

int count_pieces(const std::vector<Triangle>& triangles, int point_count) {
    const std::vector<int> piece = pieces(triangles, point_count);
    std::vector<int> lowest;
    for (const Triangle& t : triangles)
        lowest.push_back(piece[t[0]]);
    std::sort(lowest.begin(), lowest.end());
    return int(std::unique(lowest.begin(), lowest.end()) - lowest.begin());
}

} // namespace toile

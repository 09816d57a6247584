// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/solid.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <stdexcept>
#include <tuple>

namespace toile {

namespace {

/// A directed edge of a triangle, with its ends in ascending order for sorting.
struct HalfEdge {
    int low, high;
    bool forward; ///< runs from low to high
    int triangle;

    bool same_edge(const HalfEdge& other) const { return low == other.low && high == other.high; }
};

std::vector<HalfEdge> sorted_half_edges(const std::vector<Triangle>& triangles) {
    std::vector<HalfEdge> half_edges;
    half_edges.reserve(3 * triangles.size());
    for (int t = 0; t < int(triangles.size()); ++t)
        for (int k = 0; k < 3; ++k) {
            const int a = triangles[t][k], b = triangles[t][(k + 1) % 3];
            half_edges.push_back({std::min(a, b), std::max(a, b), a < b, t});
        }
    std::sort(half_edges.begin(), half_edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
        return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
    });
    return half_edges;
}

/// Calls visit(begin, end) for every run of half-edges that lie on one edge.
template <class Visit> void for_each_edge(const std::vector<HalfEdge>& half_edges, Visit&& visit) {
    for (size_t begin = 0, end = 0; begin < half_edges.size(); begin = end) {
        while (end < half_edges.size() && half_edges[end].same_edge(half_edges[begin])) ++end;
        visit(begin, end);
    }
}

bool has_repeated_corner(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

Vec3 area_vector(const Points& p, const Triangle& t) {
    return 0.5 * (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]);
}

double six_volumes(const Points& p, const Triangle& t) { return p[t[0]].dot(p[t[1]].cross(p[t[2]])); }

/// Points on an open border or at the end of an edge without length.
std::vector<bool> joinable_points(const TriMesh& mesh) {
    std::vector<bool> joinable(mesh.points.size(), false);
    const std::vector<HalfEdge> half_edges = sorted_half_edges(mesh.triangles);
    for_each_edge(half_edges, [&](size_t begin, size_t end) {
        const HalfEdge& e = half_edges[begin];
        if ((end - begin) % 2 == 1 || mesh.points[e.low] == mesh.points[e.high])
            joinable[e.low] = joinable[e.high] = true;
    });
    return joinable;
}

} // namespace

int join_equal_points(TriMesh& mesh) {
    const std::vector<bool> joinable = joinable_points(mesh);
    std::vector<int> order;
    for (int i = 0; i < int(mesh.points.size()); ++i)
        if (joinable[i]) order.push_back(i);
    std::sort(order.begin(), order.end(), [&](int a, int b) {
        const Vec3 &p = mesh.points[a], &q = mesh.points[b];
        return std::tie(p.x(), p.y(), p.z(), a) < std::tie(q.x(), q.y(), q.z(), b);
    });
    std::vector<int> stays(mesh.points.size());
    for (int i = 0; i < int(stays.size()); ++i) stays[i] = i;
    int joined = 0;
    for (size_t i = 1; i < order.size(); ++i)
        if (mesh.points[order[i]] == mesh.points[order[i - 1]]) {
            stays[order[i]] = stays[order[i - 1]];
            ++joined;
        }
    for (Triangle& t : mesh.triangles)
        for (int& corner : t) corner = stays[corner];
    std::erase_if(mesh.triangles, has_repeated_corner);
    return joined;
}

int drop_unused_points(TriMesh& mesh) {
    std::vector<int> index(mesh.points.size(), -1);
    for (const Triangle& t : mesh.triangles)
        for (int corner : t) index[corner] = 0;
    int count = 0;
    for (size_t i = 0; i < index.size(); ++i)
        if (index[i] == 0) {
            mesh.points[count] = mesh.points[i];
            index[i] = count++;
        }
    const int dropped = int(mesh.points.size()) - count;
    mesh.points.resize(count);
    for (Triangle& t : mesh.triangles)
        for (int& corner : t) corner = index[corner];
    return dropped;
}

namespace {

/// The corner opposite the longest edge of t.
int corner_between(const Points& p, const Triangle& t) {
    int best = 0;
    double longest = -1;
    for (int k = 0; k < 3; ++k) {
        const double l = (p[t[(k + 1) % 3]] - p[t[(k + 2) % 3]]).squaredNorm();
        if (l > longest) {
            longest = l;
            best = k;
        }
    }
    return best;
}

/// The other triangle on the edge a - b, or -1.
int neighbour_across(const std::vector<HalfEdge>& half_edges, int t, int a, int b) {
    const int low = std::min(a, b), high = std::max(a, b);
    auto it = std::lower_bound(half_edges.begin(), half_edges.end(), std::tie(low, high),
                               [](const HalfEdge& e, const auto& key) { return std::tie(e.low, e.high) < key; });
    for (; it != half_edges.end() && it->low == low && it->high == high; ++it)
        if (it->triangle != t) return it->triangle;
    return -1;
}

/// Turns the longest edges of flat triangles so that their middle corners split the neighbours in two. A triangle
/// takes part once, because `half_edges` knows the mesh as it was.
int turn_flat_triangles(TriMesh& mesh) {
    const std::vector<HalfEdge> half_edges = sorted_half_edges(mesh.triangles);
    std::vector<bool> touched(mesh.triangles.size(), false);
    int turned = 0;
    for (int t = 0; t < int(mesh.triangles.size()); ++t) {
        const Triangle flat = mesh.triangles[t];
        if (touched[t] || !area_vector(mesh.points, flat).isZero(0.0)) continue;
        const int k = corner_between(mesh.points, flat);
        const int middle = flat[k], a = flat[(k + 1) % 3], b = flat[(k + 2) % 3];
        const int other = neighbour_across(half_edges, t, a, b);
        if (other < 0 || touched[other]) continue;
        Triangle first = mesh.triangles[other], second = first;
        std::replace(first.begin(), first.end(), a, middle);
        std::replace(second.begin(), second.end(), b, middle);
        if (has_repeated_corner(first) || has_repeated_corner(second)) continue;
        mesh.triangles[other] = first;
        mesh.triangles[t] = second;
        touched[t] = touched[other] = true;
        ++turned;
    }
    return turned;
}

} // namespace

int drop_flat_triangles(TriMesh& mesh) {
    int changed = int(std::erase_if(mesh.triangles, has_repeated_corner));
    // Turning can make the neighbour flat in turn, hence rounds.
    for (int round = 0; round < 10; ++round) {
        const int turned = turn_flat_triangles(mesh);
        changed += turned;
        if (turned == 0) break;
    }
    return changed;
}

int orient_outward(TriMesh& mesh) {
    const std::vector<HalfEdge> half_edges = sorted_half_edges(mesh.triangles);
    struct Neighbour {
        int triangle;
        bool agrees;
    };
    std::vector<std::vector<Neighbour>> neighbours(mesh.triangles.size());
    for_each_edge(half_edges, [&](size_t begin, size_t end) {
        if (end - begin != 2) return;
        const HalfEdge &a = half_edges[begin], &b = half_edges[begin + 1];
        neighbours[a.triangle].push_back({b.triangle, a.forward != b.forward});
        neighbours[b.triangle].push_back({a.triangle, a.forward != b.forward});
    });
    std::vector<int> side(mesh.triangles.size(), 0); // 1: as it is, -1: to be turned
    int turned = 0;
    for (int seed = 0; seed < int(side.size()); ++seed) {
        if (side[seed] != 0) continue;
        std::vector<int> piece{seed};
        side[seed] = 1;
        double volume = 0;
        for (size_t i = 0; i < piece.size(); ++i) {
            volume += side[piece[i]] * six_volumes(mesh.points, mesh.triangles[piece[i]]);
            for (const Neighbour& n : neighbours[piece[i]])
                if (side[n.triangle] == 0) {
                    side[n.triangle] = n.agrees ? side[piece[i]] : -side[piece[i]];
                    piece.push_back(n.triangle);
                }
        }
        for (int t : piece)
            if ((side[t] < 0) != (volume < 0)) {
                std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
                ++turned;
            }
    }
    return turned;
}

Points vertex_normals(const TriMesh& mesh) {
    Points n(mesh.points.size(), Vec3::Zero());
    for (const Triangle& t : mesh.triangles) {
        const Vec3 a = (mesh.points[t[1]] - mesh.points[t[0]]).cross(mesh.points[t[2]] - mesh.points[t[0]]);
        for (const int i : t) n[i] += a;
    }
    for (Vec3& v : n) v.normalize();
    return n;
}

double volume(const TriMesh& mesh) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles) sum += six_volumes(mesh.points, t);
    return sum / 6;
}

std::vector<std::vector<int>> border_loops(const TriMesh& mesh) {
    // Every half-edge without a partner leaves an edge to be closed, running the other way.
    std::vector<std::array<int, 2>> open;
    const std::vector<HalfEdge> half_edges = sorted_half_edges(mesh.triangles);
    for_each_edge(half_edges, [&](size_t begin, size_t end) {
        int balance = 0;
        for (size_t i = begin; i < end; ++i) balance += half_edges[i].forward ? 1 : -1;
        const int low = half_edges[begin].low, high = half_edges[begin].high;
        for (; balance > 0; --balance) open.push_back({high, low});
        for (; balance < 0; ++balance) open.push_back({low, high});
    });
    std::sort(open.begin(), open.end());
    std::vector<bool> used(open.size(), false);
    const auto next_from = [&](int point) {
        auto it = std::lower_bound(open.begin(), open.end(), std::array<int, 2>{point, -1});
        while (it != open.end() && (*it)[0] == point && used[it - open.begin()]) ++it;
        return it != open.end() && (*it)[0] == point ? int(it - open.begin()) : -1;
    };
    std::vector<std::vector<int>> loops;
    for (size_t seed = 0; seed < open.size(); ++seed) {
        if (used[seed]) continue;
        std::vector<int> loop;
        for (int e = int(seed); e >= 0; e = next_from(open[e][1])) {
            used[e] = true;
            loop.push_back(open[e][0]);
            // Two holes that touch in a point make one figure of eight; a closed part of it is a loop itself.
            const auto seen = std::find(loop.begin(), loop.end(), open[e][1]);
            if (seen != loop.end()) {
                loops.emplace_back(seen, loop.end());
                loop.erase(seen, loop.end());
                if (loop.empty()) break;
            }
        }
        if (!loop.empty()) loops.push_back(std::move(loop));
    }
    return loops;
}

int crowded_edges(const TriMesh& mesh) {
    int count = 0;
    const std::vector<HalfEdge> half_edges = sorted_half_edges(mesh.triangles);
    for_each_edge(half_edges, [&](size_t begin, size_t end) { count += end - begin > 2; });
    return count;
}

std::vector<Triangle> fill_loop(const Points& points, const std::vector<int>& loop) {
    const int n = int(loop.size());
    if (n < 3) return {};
    if (n > 500) throw std::invalid_argument("fill_loop: a loop of more than 500 points");
    // best[i][j]: least area of a triangulation of the loop's part i .. j; split[i][j] the corner chosen.
    std::vector<double> best(size_t(n) * n, 0);
    std::vector<int> split(size_t(n) * n, -1);
    for (int span = 2; span < n; ++span)
        for (int i = 0; i + span < n; ++i) {
            const int j = i + span;
            double least = 0;
            for (int k = i + 1; k < j; ++k) {
                const double area = best[i * n + k] + best[k * n + j] +
                                    area_vector(points, {loop[i], loop[k], loop[j]}).norm();
                if (k == i + 1 || area < least) {
                    least = area;
                    split[i * n + j] = k;
                }
            }
            best[i * n + j] = least;
        }
    std::vector<Triangle> triangles;
    std::vector<std::array<int, 2>> parts{{0, n - 1}};
    while (!parts.empty()) {
        const auto [i, j] = parts.back();
        parts.pop_back();
        if (j - i < 2) continue;
        const int k = split[i * n + j];
        triangles.push_back({loop[i], loop[k], loop[j]});
        parts.push_back({i, k});
        parts.push_back({k, j});
    }
    return triangles;
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/lined_mesh.h"

#include "geometry/distance.h"
#include "geometry/edges.h"

#include <algorithm>
#include <limits>

namespace toile {

namespace {

// Shares of an edge, or weights in a triangle.
constexpr double at_corner = 0.25; // nearer to a corner that may move, a line takes it along
constexpr double at_held = 0.02;   // nearer to one that may not, it goes through that
constexpr double sliver = 0.02;    // height of a triangle over its longest edge below which that edge is turned
constexpr double opposite = 0.5;   // sum of two normals that are about 150 degrees apart

bool has(const Triangle& t, int point) { return t[0] == point || t[1] == point || t[2] == point; }

Triangle with(Triangle t, int point, int by) {
    std::replace(t.begin(), t.end(), point, by);
    return t;
}

std::array<int, 2> key(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

} // namespace

LinedMesh::LinedMesh(TriMesh mesh) : mesh_(std::move(mesh)), around_(mesh_.points.size()), held_(mesh_.points.size(), 0) {
    for (int t = 0; t < int(mesh_.triangles.size()); ++t)
        for (const int p : mesh_.triangles[t]) around_[p].push_back(t);
}

void LinedMesh::replace(int t, const Triangle& by) {
    for (const int p : mesh_.triangles[t])
        if (!has(by, p)) std::erase(around_[p], t);
    for (const int p : by)
        if (!has(mesh_.triangles[t], p)) around_[p].push_back(t);
    mesh_.triangles[t] = by;
}

int LinedMesh::add(const Triangle& t) {
    const int index = int(mesh_.triangles.size());
    mesh_.triangles.push_back(t);
    for (const int p : t) around_[p].push_back(index);
    return index;
}

std::vector<int> LinedMesh::ring(int point) const {
    std::vector<int> all = around_[point];
    std::sort(all.begin(), all.end());
    return all;
}

void LinedMesh::mark(int a, int b, int line) {
    lines_.emplace(key(a, b), line);
    hold(a);
    hold(b);
}

/// Whether a corner can go `way` metres along the surface without turning over a triangle.
bool LinedMesh::may_move(int point, double way) const {
    if (held_[point]) return false;
    double shortest = std::numeric_limits<double>::infinity();
    for (const int t : around_[point])
        for (const int p : mesh_.triangles[t])
            if (p != point) shortest = std::min(shortest, (mesh_.points[p] - mesh_.points[point]).norm());
    return way < at_corner * shortest;
}

/// The point where a line crosses an edge.
int LinedMesh::cross_edge(int a, int b, double share) {
    if (share > 0.5) return cross_edge(b, a, 1 - share);
    if (share < at_held) return a;
    const Vec3 way = share * (mesh_.points[b] - mesh_.points[a]);
    if (!may_move(a, way.norm())) return split_edge(a, b, share);
    mesh_.points[a] += way;
    return a;
}

int LinedMesh::split_edge(int a, int b, double share) {
    const int m = int(mesh_.points.size());
    mesh_.points.push_back((1 - share) * mesh_.points[a] + share * mesh_.points[b]);
    around_.emplace_back();
    held_.push_back(0);
    for (const int t : ring(a)) {
        const Triangle whole = mesh_.triangles[t];
        if (!has(whole, b)) continue;
        replace(t, with(whole, b, m));
        add(with(whole, a, m));
    }
    if (const auto line = lines_.find(key(a, b)); line != lines_.end()) {
        const int number = line->second;
        lines_.erase(line);
        mark(a, m, number);
        mark(m, b, number);
    }
    return m;
}

int LinedMesh::split_face(int t, const Vec3& p) {
    const Triangle whole = mesh_.triangles[t];
    const int m = int(mesh_.points.size());
    mesh_.points.push_back(p);
    around_.emplace_back();
    held_.push_back(0);
    replace(t, with(whole, whole[2], m));
    add(with(whole, whole[0], m));
    add(with(whole, whole[1], m));
    return m;
}

int LinedMesh::point_near(const Vec3& p, double reach) {
    int at = -1;
    Nearest best;
    best.squared = std::numeric_limits<double>::infinity();
    for (int t = 0; t < int(mesh_.triangles.size()); ++t) {
        const auto& [a, b, c] = mesh_.triangles[t];
        const Nearest n = nearest_point_triangle(p, mesh_.points[a], mesh_.points[b], mesh_.points[c]);
        if (n.squared < best.squared) best = n, at = t;
    }
    const Triangle t = mesh_.triangles[at];
    const auto weight = [&](int k) { return best.weight[k % 3 + 1]; };
    Vec3 on = Vec3::Zero();
    for (int k = 0; k < 3; ++k) on += weight(k) * mesh_.points[t[k]];
    double nearest = reach * reach;
    std::array<int, 2> edge{-1, -1};
    for (const auto& [ends, line] : lines_) {
        const Vec3 &a = mesh_.points[ends[0]], &b = mesh_.points[ends[1]];
        const double s = nearest_on_segment(on, a, b), squared = ((1 - s) * a + s * b - on).squaredNorm();
        if (squared < nearest) nearest = squared, edge = ends;
    }
    if (edge[0] >= 0) return cross_edge(edge[0], edge[1], nearest_on_segment(on, mesh_.points[edge[0]], mesh_.points[edge[1]]));
    int point = -1;
    for (int k = 0; k < 3 && point < 0; ++k)
        if (weight(k) > 1 - at_held || may_move(t[k], (on - mesh_.points[t[k]]).norm())) point = t[k];
    for (int k = 0; k < 3 && point < 0; ++k)
        if (weight(k) < at_corner) point = split_edge(t[(k + 1) % 3], t[(k + 2) % 3], weight(k + 2) / (weight(k + 1) + weight(k + 2)));
    if (point < 0) point = split_face(at, on);
    if (!held_[point]) mesh_.points[point] = on;
    hold(point);
    return point;
}

Vec3 LinedMesh::normal_at(int point) const {
    Vec3 sum = Vec3::Zero();
    for (const int t : ring(point)) {
        const auto& [a, b, c] = mesh_.triangles[t];
        sum += (mesh_.points[b] - mesh_.points[a]).cross(mesh_.points[c] - mesh_.points[a]);
    }
    return sum.normalized();
}

/// Corners moved onto a line may come to lie on one straight line: the longest edge, where it is no line, becomes the other diagonal.
void LinedMesh::turn_slivers() {
    const auto height = [&](int a, int b, int c) { // over the longest edge
        const Vec3 &p = mesh_.points[a], &q = mesh_.points[b], &r = mesh_.points[c];
        return (q - p).cross(r - p).norm() / std::max({(q - p).squaredNorm(), (r - q).squaredNorm(), (p - r).squaredNorm()});
    };
    for (int t = 0; t < int(mesh_.triangles.size()); ++t) {
        const Triangle whole = mesh_.triangles[t];
        const auto length = [&](int k) { return (mesh_.points[whole[(k + 1) % 3]] - mesh_.points[whole[k]]).norm(); };
        const int k = int(std::max({0, 1, 2}, [&](int i, int j) { return length(i) < length(j); }));
        const int a = whole[k], b = whole[(k + 1) % 3], c = whole[(k + 2) % 3];
        if (!held_[a] && !held_[b] && !held_[c]) continue;
        if (height(a, b, c) > sliver || lines_.count(key(a, b))) continue;
        for (const int s : ring(a)) {
            if (s == t || !has(mesh_.triangles[s], b)) continue;
            const Triangle& beyond = mesh_.triangles[s];
            const int d = beyond[0] + beyond[1] + beyond[2] - a - b;
            const std::vector<int> at_c = ring(c);
            const bool there = std::any_of(at_c.begin(), at_c.end(), [&](int u) { return has(mesh_.triangles[u], d); });
            if (there || !(std::min(height(a, d, c), height(d, b, c)) > height(a, b, c))) break;
            replace(t, {a, d, c});
            replace(s, {d, b, c});
            break;
        }
    }
}

bool LinedMesh::join(int a, int b, int line) {
    const Vec3 origin = mesh_.points[a], goal = mesh_.points[b] - origin;
    const Vec3 up = normal_at(a) + normal_at(b), across = goal.cross(up);
    if (!(across.norm() > 0) || up.norm() < opposite) return false;
    const auto height = [&](int p) { return across.dot(mesh_.points[p] - origin); };
    const std::size_t most = mesh_.triangles.size();
    int here = a;
    for (std::size_t steps = 0; steps < most; ++steps) {
        std::array<int, 2> over{-1, -1};
        double share = 0, best = 0; // of the way towards the goal, as a cosine
        for (const int t : ring(here)) {
            if (has(mesh_.triangles[t], b)) {
                mark(here, b, line);
                turn_slivers();
                return true;
            }
            const auto& corner = mesh_.triangles[t];
            const int k = int(std::find(corner.begin(), corner.end(), here) - corner.begin());
            const int p = corner[(k + 1) % 3], q = corner[(k + 2) % 3];
            const double hp = height(p), hq = height(q);
            if (hp * hq > 0 || hp == hq) continue;
            const double s = hp / (hp - hq);
            const Vec3 way = (1 - s) * mesh_.points[p] + s * mesh_.points[q] - mesh_.points[here];
            const double forward = way.normalized().dot(goal.normalized());
            if (forward > best) best = forward, share = s, over = {p, q};
        }
        if (over[0] < 0) return false;
        const int next = cross_edge(over[0], over[1], share);
        mark(here, next, line);
        here = next;
    }
    return false;
}

bool LinedMesh::cut_by_plane(const Vec3& on, const Vec3& normal, const Eigen::AlignedBox3d& box, int line) {
    const auto height = [&](int p) { return normal.dot(mesh_.points[p] - on); };
    const EdgeTable edges = make_edges(mesh_.triangles, int(mesh_.points.size()));
    std::vector<char> drawn(mesh_.points.size(), 0); // points on the line
    const auto each_crossing = [&](auto&& visit) {
        for (const auto& [a, b] : edges.ends) {
            const double ha = height(a), hb = height(b), s = ha / (ha - hb);
            if (ha * hb > 0 || ha == hb) continue;
            if (box.contains((1 - s) * mesh_.points[a] + s * mesh_.points[b])) visit(a, b, s);
        }
    };
    Points moved = mesh_.points; // corners near the line, each the shortest way to it along an edge
    each_crossing([&](int a, int b, double s) {
        if (s > 0.5) std::swap(a, b), s = 1 - s;
        const Vec3 way = s * (mesh_.points[b] - mesh_.points[a]);
        if (s > at_held && !may_move(a, way.norm())) return;
        if (drawn[a] && way.norm() >= (moved[a] - mesh_.points[a]).norm()) return;
        drawn[a] = 1;
        if (!held_[a]) moved[a] = mesh_.points[a] + way;
    });
    mesh_.points = std::move(moved);
    each_crossing([&](int a, int b, double s) {
        if (drawn[a] || drawn[b]) return; // the line goes through its end
        drawn.resize(mesh_.points.size() + 1, 0);
        drawn[split_edge(a, b, s)] = 1;
    });
    bool any = false;
    for (const Triangle& t : mesh_.triangles)
        for (int k = 0; k < 3; ++k)
            if (drawn[t[k]] && drawn[t[(k + 1) % 3]]) {
                mark(t[k], t[(k + 1) % 3], line);
                any = true;
            }
    turn_slivers();
    return any;
}

} // namespace toile

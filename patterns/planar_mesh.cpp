// SPDX-License-Identifier: GPL-3.0-or-later
#include "patterns/planar_mesh.h"

#include "patterns/plane.h"

#include <algorithm>
#include <cmath>
#include <queue>

namespace toile {
namespace {

int next(int k) {
    return k == 2 ? 0 : k + 1;
}
int previous(int k) {
    return k == 0 ? 2 : k - 1;
}

double doubled_area(const Vec2& a, const Vec2& b, const Vec2& c) {
    return cross(b - a, c - a);
}

double doubled_area(const PlanarMesh& m, int t) {
    const Triangle& v = m.triangles[t];
    return doubled_area(m.points[v[0]], m.points[v[1]], m.points[v[2]]);
}

int corner_of(const PlanarMesh& m, int t, int point) {
    const Triangle& v = m.triangles[t];
    return v[0] == point ? 0 : v[1] == point ? 1 : 2;
}

/// Which edge of triangle u leads to triangle t by way of the edge a, b.
int edge_towards(const PlanarMesh& m, int u, int a, int b) {
    for (int k = 0; k < 3; ++k) {
        const int p = m.triangles[u][next(k)], q = m.triangles[u][previous(k)];
        if ((p == a && q == b) || (p == b && q == a)) return k;
    }
    return -1;
}

Vec2 circumcentre(const Vec2& a, const Vec2& b, const Vec2& c) {
    const Vec2 u = b - a, v = c - a;
    const double d = 2 * cross(u, v), uu = u.squaredNorm(), vv = v.squaredNorm();
    return a + Vec2(v.y() * uu - u.y() * vv, u.x() * vv - v.x() * uu) / d;
}

/// The largest cosine of a triangle's angles: the sharpest corner. 1 for a triangle turned over.
double sharpness(const Vec2& a, const Vec2& b, const Vec2& c) {
    const Vec2 ab = b - a, bc = c - b, ca = a - c;
    if (!(cross(ab, -ca) > 0)) return 1;
    const double lc = ab.norm(), la = bc.norm(), lb = ca.norm();
    return std::max({-ab.dot(ca) / (lc * lb), -bc.dot(ab) / (la * lc), -ca.dot(bc) / (lb * la)});
}

double sharpness(const PlanarMesh& m, int t) {
    const Triangle& v = m.triangles[t];
    return sharpness(m.points[v[0]], m.points[v[1]], m.points[v[2]]);
}

/// Triangles around an inner point, counter-clockwise.
void star(const PlanarMesh& m, int point, std::vector<int>& out) {
    out.clear();
    const int first = m.triangle_at[point];
    int t = first;
    do {
        out.push_back(t);
        t = m.across[t][next(corner_of(m, t, point))];
    } while (t != first && t >= 0);
}

void set_across(PlanarMesh& m, int t, int k, int neighbour, bool fixed) {
    m.across[t][k] = neighbour;
    m.fixed[t][k] = fixed;
    if (neighbour < 0) return;
    const int a = m.triangles[t][next(k)], b = m.triangles[t][previous(k)];
    const int back = edge_towards(m, neighbour, a, b);
    m.across[neighbour][back] = t;
    m.fixed[neighbour][back] = fixed;
}

/// The four points of the two triangles at edge k of t: a opposite, p and q on the edge, b beyond.
struct Quad {
    int t, u, k, m; // edge k of t is edge m of u
    int a, p, q, b;
};

bool quad_at(const PlanarMesh& mesh, int t, int k, Quad& quad) {
    if (mesh.fixed[t][k] || mesh.across[t][k] < 0) return false;
    const Triangle& v = mesh.triangles[t];
    const int u = mesh.across[t][k];
    const int m = edge_towards(mesh, u, v[next(k)], v[previous(k)]);
    quad = {t, u, k, m, v[k], v[next(k)], v[previous(k)], mesh.triangles[u][m]};
    return true;
}

/// Replaces the edge p q by a b. The quad must be convex.
void flip(PlanarMesh& mesh, const Quad& e) {
    const int t = e.t, u = e.u;
    const int t_q = mesh.across[t][previous(e.k)], t_p = mesh.across[t][next(e.k)]; // beyond a p, beyond q a
    const int u_q = mesh.across[u][next(e.m)], u_p = mesh.across[u][previous(e.m)]; // beyond p b, beyond b q
    const bool f_tq = mesh.fixed[t][previous(e.k)], f_tp = mesh.fixed[t][next(e.k)];
    const bool f_uq = mesh.fixed[u][next(e.m)], f_up = mesh.fixed[u][previous(e.m)];
    mesh.triangles[t] = {e.a, e.p, e.b};
    mesh.triangles[u] = {e.b, e.q, e.a};
    set_across(mesh, t, 0, u_q, f_uq);
    set_across(mesh, t, 2, t_q, f_tq);
    set_across(mesh, u, 0, t_p, f_tp);
    set_across(mesh, u, 2, u_p, f_up);
    set_across(mesh, t, 1, u, false);
    mesh.triangle_at[e.a] = mesh.triangle_at[e.p] = mesh.triangle_at[e.b] = t;
    mesh.triangle_at[e.q] = u;
}

bool convex(const PlanarMesh& m, const Quad& e) {
    const Vec2 &a = m.points[e.a], &p = m.points[e.p], &q = m.points[e.q], &b = m.points[e.b];
    const double scale = 1e-9 * (b - a).squaredNorm();
    return doubled_area(a, p, b) > scale && doubled_area(b, q, a) > scale;
}

/// The angles opposite the edge add up to more than pi: b lies inside the circumcircle of a, p, q.
bool violates_delaunay(const PlanarMesh& m, const Quad& e) {
    const Vec2 &a = m.points[e.a], &p = m.points[e.p], &q = m.points[e.q], &b = m.points[e.b];
    const Vec2 ap = p - a, aq = q - a, bp = p - b, bq = q - b;
    const double cos_a = ap.dot(aq), sin_a = cross(ap, aq), cos_b = bq.dot(bp), sin_b = cross(bq, bp);
    const double scale = std::sqrt(ap.squaredNorm() * aq.squaredNorm() * bp.squaredNorm() * bq.squaredNorm());
    return sin_a * cos_b + cos_a * sin_b < -1e-10 * scale;
}

/// Flips edges until all in the queue and all that they disturb are Delaunay.
void restore_delaunay(PlanarMesh& mesh, std::vector<std::array<int, 2>>& queue) {
    for (std::size_t done = 0; done < queue.size(); ++done) {
        Quad e;
        if (!quad_at(mesh, queue[done][0], queue[done][1], e) || !violates_delaunay(mesh, e) ||
            !convex(mesh, e))
            continue;
        flip(mesh, e);
        queue.insert(queue.end(), {{e.t, 0}, {e.t, 2}, {e.u, 0}, {e.u, 2}});
    }
    queue.clear();
}

void restore_delaunay(PlanarMesh& mesh) {
    std::vector<std::array<int, 2>> queue;
    for (int t = 0; t < int(mesh.triangles.size()); ++t)
        for (int k = 0; k < 3; ++k)
            if (mesh.across[t][k] > t) queue.push_back({t, k});
    restore_delaunay(mesh, queue);
}

/// Splits triangle t at a new point inside it; appends its three outer edges to `outer`.
void split_triangle(PlanarMesh& mesh, int t, int point, std::vector<std::array<int, 2>>& outer) {
    const Triangle v = mesh.triangles[t];
    const std::array<int, 3> across = mesh.across[t];
    const std::array<bool, 3> fixed = mesh.fixed[t];
    const int first = int(mesh.triangles.size());
    const std::array<int, 3> part{t, first, first + 1};
    for (int k = 1; k < 3; ++k) {
        mesh.triangles.push_back({});
        mesh.across.push_back({-1, -1, -1});
        mesh.fixed.push_back({});
    }
    for (int k = 0; k < 3; ++k)
        mesh.triangles[part[k]] = {point, v[next(k)], v[previous(k)]};
    for (int k = 0; k < 3; ++k) {
        set_across(mesh, part[k], 0, across[k], fixed[k]);
        set_across(mesh, part[k], 1, part[next(k)],
                   false); // opposite v[next(k)] lies the edge v[previous(k)] point
        mesh.triangle_at[v[next(k)]] = part[k];
        outer.push_back({part[k], 0});
    }
    mesh.triangle_at[point] = t;
}

/// Splits the two triangles at an inner edge at a new point on it.
void split_quad(PlanarMesh& mesh, const Quad& e, int point, std::vector<std::array<int, 2>>& outer) {
    const int t_q = mesh.across[e.t][previous(e.k)], t_p = mesh.across[e.t][next(e.k)];
    const int u_q = mesh.across[e.u][next(e.m)], u_p = mesh.across[e.u][previous(e.m)];
    const bool f_tq = mesh.fixed[e.t][previous(e.k)], f_tp = mesh.fixed[e.t][next(e.k)];
    const bool f_uq = mesh.fixed[e.u][next(e.m)], f_up = mesh.fixed[e.u][previous(e.m)];
    const int first = int(mesh.triangles.size());
    for (int k = 0; k < 2; ++k) {
        mesh.triangles.push_back({});
        mesh.across.push_back({-1, -1, -1});
        mesh.fixed.push_back({});
    }
    const std::array<int, 4> part{e.t, first, e.u, first + 1};
    const std::array<int, 4> ring{e.a, e.p, e.b, e.q};
    const std::array<int, 4> beyond{t_q, u_q, u_p, t_p};
    const std::array<bool, 4> fixed{f_tq, f_uq, f_up, f_tp};
    for (int k = 0; k < 4; ++k)
        mesh.triangles[part[k]] = {point, ring[k], ring[(k + 1) % 4]};
    for (int k = 0; k < 4; ++k) {
        set_across(mesh, part[k], 0, beyond[k], fixed[k]);
        set_across(mesh, part[k], 1, part[(k + 1) % 4], false);
        mesh.triangle_at[ring[k]] = part[k];
        outer.push_back({part[k], 0});
    }
    mesh.triangle_at[point] = e.t;
}

int add_point(PlanarMesh& mesh, const Vec2& p) {
    mesh.points.push_back(p);
    mesh.triangle_at.push_back(-1);
    return int(mesh.points.size()) - 1;
}

/// Triangle that contains p, walking from t; -1 when a fixed edge bars the way.
int walk(const PlanarMesh& mesh, int t, const Vec2& p) {
    for (std::size_t steps = 0; steps < mesh.triangles.size(); ++steps) {
        int out = -1;
        double worst = 0;
        for (int k = 0; k < 3; ++k) {
            const Vec2 &a = mesh.points[mesh.triangles[t][next(k)]],
                       &b = mesh.points[mesh.triangles[t][previous(k)]];
            const double side = doubled_area(a, b, p) / (b - a).norm();
            if (side < worst) worst = side, out = k;
        }
        if (out < 0) return t;
        if (mesh.fixed[t][out] || mesh.across[t][out] < 0) return -1;
        t = mesh.across[t][out];
    }
    return -1;
}

/// Distance from p, inside triangle t, to the fixed edges that would become neighbours of a point there.
double room(const PlanarMesh& mesh, int t, const Vec2& p) {
    double nearest = 1e300;
    std::vector<int> cavity{t};
    for (std::size_t k = 0; k < cavity.size(); ++k) {
        const int c = cavity[k];
        const Triangle& v = mesh.triangles[c];
        for (int e = 0; e < 3; ++e) {
            if (mesh.fixed[c][e]) {
                nearest = std::min(
                    nearest, distance_to_segment(p, mesh.points[v[next(e)]], mesh.points[v[previous(e)]]));
                continue;
            }
            const int u = mesh.across[c][e];
            if (u < 0 || std::find(cavity.begin(), cavity.end(), u) != cavity.end()) continue;
            const Vec2& corner = mesh.points[mesh.triangles[u][0]];
            const Vec2 centre =
                circumcentre(corner, mesh.points[mesh.triangles[u][1]], mesh.points[mesh.triangles[u][2]]);
            if ((p - centre).squaredNorm() < (corner - centre).squaredNorm()) cavity.push_back(u);
        }
    }
    return nearest;
}

/// A triangle waiting for refinement: named by its points, so that it is known when it is gone.
struct Large {
    double ratio;
    int triangle;
    Triangle points;
    bool operator<(const Large& o) const {
        return ratio != o.ratio ? ratio < o.ratio
                                : points > o.points; // ties by index: the order is the input's alone
    }
};

void move_point(PlanarMesh& mesh, int point, const Vec2& to, const std::vector<int>& around) {
    const Vec2 from = mesh.points[point];
    double smallest = 1e300;
    for (int t : around)
        smallest = std::min(smallest, doubled_area(mesh, t));
    for (double step : {1.0, 0.5, 0.25}) {
        mesh.points[point] = from + step * (to - from);
        double now = 1e300;
        for (int t : around)
            now = std::min(now, doubled_area(mesh, t));
        if (now > 0.3 * smallest) return;
    }
    mesh.points[point] = from;
}

/// Where an inner point lies best for given neighbours: the mean of the circumcentres around it, weighted by
/// area.
Vec2 mean_circumcentre(const PlanarMesh& mesh, const std::vector<int>& around, const SizeAt& size) {
    Vec2 sum = Vec2::Zero();
    double total = 0;
    for (int t : around) {
        const Triangle& v = mesh.triangles[t];
        const Vec2 &a = mesh.points[v[0]], &b = mesh.points[v[1]], &c = mesh.points[v[2]];
        double weight = doubled_area(a, b, c);
        if (size)
            weight /= std::pow(size((a + b + c) / 3), 4); // spacing goes with the fourth root of density
        sum += weight * circumcentre(a, b, c);
        total += weight;
    }
    return sum / total;
}

/// Sharpest corner around a point if it were at p.
double worst_around(PlanarMesh& mesh, int point, const Vec2& p, const std::vector<int>& around) {
    const Vec2 kept = mesh.points[point];
    mesh.points[point] = p;
    double worst = -1;
    for (int t : around)
        worst = std::max(worst, sharpness(mesh, t));
    mesh.points[point] = kept;
    return worst;
}

/// Moves an inner point by compass search until the sharpest corner around it is as blunt as it gets.
void blunt(PlanarMesh& mesh, int point, std::vector<int>& around) {
    star(mesh, point, around);
    double reach = 0;
    for (int t : around)
        reach = std::max(reach, std::sqrt(doubled_area(mesh, t)));
    double worst = worst_around(mesh, point, mesh.points[point], around);
    for (double step = 0.2 * reach; step > 0.005 * reach; step *= 0.5) {
        for (int tries = 0; tries < 8; ++tries) {
            Vec2 best = mesh.points[point];
            for (int d = 0; d < 8; ++d) {
                const double angle = d * EIGEN_PI / 4;
                const Vec2 p = mesh.points[point] + step * Vec2(std::cos(angle), std::sin(angle));
                const double there = worst_around(mesh, point, p, around);
                if (there < worst) worst = there, best = p;
            }
            if (best == mesh.points[point]) break;
            mesh.points[point] = best;
        }
    }
}

bool all_on_border(const PlanarMesh& mesh, int a, int b, int c) {
    return mesh.on_border(a) && mesh.on_border(b) && mesh.on_border(c);
}

/// Sharpest corner of the triangles around an inner point.
double worst_around(PlanarMesh& mesh, int point) {
    std::vector<int> around;
    star(mesh, point, around);
    return worst_around(mesh, point, mesh.points[point], around);
}

/// Flips the edge between a triangle with three border points and its neighbour's inner point, and moves that
/// point to suit if it may; undone unless all angles around it stay blunter than `cosine`.
void open_ears(PlanarMesh& mesh, double cosine) {
    std::vector<int> around;
    for (int t = 0; t < int(mesh.triangles.size()); ++t)
        for (int k = 0; k < 3; ++k) {
            Quad e;
            if (!quad_at(mesh, t, k, e) || !convex(mesh, e)) continue;
            if (!all_on_border(mesh, e.a, e.p, e.q) || mesh.on_border(e.b)) continue;
            const Vec2 kept = mesh.points[e.b];
            flip(mesh, e);
            if (worst_around(mesh, e.b) < cosine) break;
            if (!mesh.still(e.b)) {
                blunt(mesh, e.b, around);
                if (worst_around(mesh, e.b) < cosine) break;
                mesh.points[e.b] = kept;
            }
            Quad back;
            if (quad_at(mesh, t, 1, back)) flip(mesh, back);
        }
}

} // namespace

double smallest_angle(const Vec2& a, const Vec2& b, const Vec2& c) {
    return std::acos(
        std::clamp(doubled_area(a, b, c) > 0 ? sharpness(a, b, c) : sharpness(a, c, b), -1.0, 1.0));
}

void refine(PlanarMesh& mesh, const SizeAt& size, double limit) {
    std::priority_queue<Large> queue;
    auto consider = [&](int t) {
        const Triangle& v = mesh.triangles[t];
        const Vec2 &a = mesh.points[v[0]], &b = mesh.points[v[1]], &c = mesh.points[v[2]];
        const double ratio = (circumcentre(a, b, c) - a).norm() / size((a + b + c) / 3);
        if (ratio > limit) queue.push({ratio, t, v});
    };
    for (int t = 0; t < int(mesh.triangles.size()); ++t)
        consider(t);
    std::vector<std::array<int, 2>> outer;
    std::vector<int> around;
    while (!queue.empty()) {
        const Large large = queue.top();
        queue.pop();
        const int t = large.triangle;
        if (mesh.triangles[t] != large.points) continue;
        const Triangle& v = mesh.triangles[t];
        const Vec2 p = circumcentre(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]]);
        const int home = walk(mesh, t, p);
        if (home < 0 || room(mesh, home, p) < 0.5 * size(p)) continue;
        const int point = add_point(mesh, p);
        int flat = -1; // an edge that p lies on
        for (int k = 0; k < 3; ++k) {
            const Vec2 &a = mesh.points[mesh.triangles[home][next(k)]],
                       &b = mesh.points[mesh.triangles[home][previous(k)]];
            if (doubled_area(a, b, p) < 1e-3 * (b - a).squaredNorm()) flat = k;
        }
        Quad e;
        if (flat >= 0 && quad_at(mesh, home, flat, e))
            split_quad(mesh, e, point, outer);
        else
            split_triangle(mesh, home, point, outer);
        restore_delaunay(mesh, outer);
        star(mesh, point, around);
        for (int n : around)
            consider(n);
    }
}

void smooth(PlanarMesh& mesh, const SizeAt& size, int sweeps) {
    std::vector<int> around;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        for (int p = mesh.still_points; p < int(mesh.points.size()); ++p) {
            star(mesh, p, around);
            move_point(mesh, p, mean_circumcentre(mesh, around, size), around);
        }
        restore_delaunay(mesh);
    }
}

void improve_angles(PlanarMesh& mesh) {
    const double bad = std::cos(33 * EIGEN_PI / 180), least = std::cos(27 * EIGEN_PI / 180);
    open_ears(mesh, least);
    std::vector<int> around;
    for (int round = 0; round < 4; ++round) {
        for (int t = 0; t < int(mesh.triangles.size()); ++t) {
            if (sharpness(mesh, t) < bad) continue;
            for (int k = 0; k < 3; ++k)
                if (!mesh.still(mesh.triangles[t][k])) blunt(mesh, mesh.triangles[t][k], around);
        }
        open_ears(mesh, least);
    }
}

bool split_edge(PlanarMesh& mesh, int a, int b) {
    for (int t = 0; t < int(mesh.triangles.size()); ++t) {
        const int k = edge_towards(mesh, t, a, b);
        Quad e;
        if (k < 0 || !quad_at(mesh, t, k, e)) continue;
        std::vector<std::array<int, 2>> outer;
        split_quad(mesh, e, add_point(mesh, 0.5 * (mesh.points[a] + mesh.points[b])), outer);
        return true;
    }
    return false;
}

} // namespace toile

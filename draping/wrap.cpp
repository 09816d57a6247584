// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/wrap.h"

#include "draping/energy/grain.h"
#include "draping/place.h"
#include "draping/pull_shut.h"
#include "draping/rings.h"
#include "geometry/intersections.h"
#include "sewing/sparse_solve.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace toile {

namespace {

constexpr double tie = 1e3;       // weight of a seam, beside which the energy of a field over cloth is about 1,
constexpr double faint = 1e-3;    // and of what turns the whole to what it hangs from
constexpr double trace = 1e-9;    // and of 0 everywhere
constexpr double most_of_a_turn = 1.9 * EIGEN_PI;
constexpr double most_bent = 0.1; // mean square by which no function goes down as the cloth does: panels not of one skirt
constexpr double pleat_edges = 8; // edges that a pleat has at least, half way down
constexpr int fewest_pleats = 4, most_pleats = 16;
constexpr double deepest = 0.4;   // of the way down: how far pleats go out and in
constexpr double slants[] = {75, 60, 45, 30, 20, 10}; // degrees between a cone and its axis that are tried, the first that is clear is taken,
constexpr double drops[] = {0.02, 0.1, 0.2};          // m below what the skirt hangs from,
constexpr double wider[] = {0, 0.04, 0.08, 0.12, 0.16}; // m that the upper edge's radius is larger than cut

/// The panels that go round, and functions over their nodes.
struct Skirt {
    const Garment& garment;
    const Points& x;
    std::vector<int> triangles = {}; ///< of the garment
    std::vector<int> unknown = {};   ///< by node; -1: of another panel
    int count = 0;                   ///< of unknowns
    std::vector<double> areas = {};  ///< by triangle, m2
    std::vector<GrainShape> slopes = {}; ///< of the hat functions of its corners along the cloth

    bool has(int node) const { return unknown[node] >= 0; }
    bool between(const Stitch& s) const { return has(s.a) && has(s.b[0]); }
    bool upper(const Stitch& s) const { return has(s.a) != has(s.b[0]); }

    Vec2 slope(int k, const Eigen::VectorXd& f) const {
        const Triangle v = garment.nodes(triangles[k]);
        Vec2 sum = Vec2::Zero();
        for (int i = 0; i < 3; ++i) sum += f[unknown[v[i]]] * slopes[k].row(i).transpose();
        return sum;
    }
};

Skirt skirt_of(const Garment& g, const Points& x, const std::vector<bool>& round) {
    Skirt skirt{g, x};
    skirt.unknown.assign(g.node_count, -1);
    for (int t = 0; t < int(g.triangles.size()); ++t) {
        if (!round[g.panel_of_triangle[t]]) continue;
        skirt.triangles.push_back(t);
        skirt.areas.push_back(rest_area(g.rest.edges[t]));
        skirt.slopes.push_back(grain_shape(g.rest.edges[t]));
        for (int i : g.nodes(t))
            if (!skirt.has(i)) skirt.unknown[i] = skirt.count++;
    }
    return skirt;
}

using Sum = std::vector<std::pair<int, double>>; // of a function at nodes, each times a factor

Sum across(const Stitch& s) { return {{s.a, 1.0}, {s.b[0], s.r - 1}, {s.b[1], -s.r}}; }

/// Of an upper stitch, the end that is the skirt's.
Sum upper_end(const Skirt& skirt, const Stitch& s) {
    return skirt.has(s.a) ? Sum{{s.a, 1.0}} : Sum{{s.b[0], 1 - s.r}, {s.b[1], s.r}};
}

/// Where an upper stitch hangs from.
Vec3 hanger(const Skirt& skirt, const Stitch& s) {
    return skirt.has(s.a) ? seam_point(s, skirt.x) : skirt.x[s.a];
}

/// A function over the skirt: the integral of the square of its slope (less `pull`) is least, beside what it is wanted to be.
struct Form {
    const Skirt& skirt;
    std::vector<Eigen::Triplet<double>> entries = {};
    Eigen::VectorXd pull = {};

    explicit Form(const Skirt& s) : skirt(s), pull(Eigen::VectorXd::Zero(s.count)) {
        for (std::size_t k = 0; k < skirt.triangles.size(); ++k) {
            const Triangle v = skirt.garment.nodes(skirt.triangles[k]);
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j)
                    add(v[i], v[j], skirt.areas[k] * skirt.slopes[k].row(i).dot(skirt.slopes[k].row(j)));
        }
    }
    /// To the entry of two nodes.
    void add(int i, int j, double value) {
        if (skirt.unknown[i] >= skirt.unknown[j]) entries.emplace_back(skirt.unknown[i], skirt.unknown[j], value);
    }
    void want(const Sum& sum, double weight, double value) {
        for (const auto& [i, c] : sum) {
            pull[skirt.unknown[i]] += weight * c * value;
            for (const auto& [j, d] : sum) add(i, j, weight * c * d);
        }
    }
    Eigen::VectorXd least() {
        for (int u = 0; u < skirt.count; ++u) entries.emplace_back(u, u, trace); // of a part that nothing holds
        Eigen::SparseMatrix<double> a(skirt.count, skirt.count);
        a.setFromTriplets(entries.begin(), entries.end());
        return solve_definite(a, pull);
    }
};

/// Where on a surface round the axis the skirt lies, by unknown.
struct Round {
    Eigen::VectorXd azimuth; ///< rad
    Eigen::VectorXd down;    ///< m along the cloth from what it hangs from
    Eigen::VectorXd wide;    ///< m of cloth per rad
};

Eigen::VectorXd azimuths(const Skirt& skirt, const Vec3& axis) {
    const Garment& g = skirt.garment;
    const std::vector<int> turns = turns_at_seams(g, skirt.x, axis);
    const std::vector<Vec3> middles = panel_middles(g, skirt.x);
    Form form(skirt);
    for (const Stitch& s : g.stitches) {
        if (skirt.between(s)) form.want(across(s), tie, 2 * EIGEN_PI * turns[s.seam]);
        if (!skirt.upper(s)) continue;
        const double middle = azimuth(middles[g.panel_of_vertex[skirt.has(s.a) ? s.a : s.b[0]]], axis);
        const double ahead = std::remainder(azimuth(hanger(skirt, s), axis) - middle, 2 * EIGEN_PI);
        form.want(upper_end(skirt, s), faint, middle + ahead);
    }
    return form.least();
}

/// 1 or -1 by panel: whether weft and warp are a right-handed pair as seen from outside.
std::vector<double> senses(const Skirt& skirt, const Vec3& axis) {
    const Garment& g = skirt.garment;
    std::vector<Vec3> normals(g.panel_names.size(), Vec3::Zero());
    for (std::size_t k = 0; k < skirt.triangles.size(); ++k) {
        const int t = skirt.triangles[k];
        const GrainImages yarns = grain_images(g.nodes(t), skirt.slopes[k], skirt.x);
        normals[g.panel_of_triangle[t]] += skirt.areas[k] * Vec3(yarns.col(0).cross(yarns.col(1)));
    }
    const std::vector<Vec3> middles = panel_middles(g, skirt.x);
    std::vector<double> sense;
    for (std::size_t p = 0; p < normals.size(); ++p) {
        Vec3 out = middles[p] - axis;
        out.y() = 0;
        sense.push_back(normals[p].dot(out) < 0 ? -1 : 1);
    }
    return sense;
}

std::optional<Round> go_round(const Skirt& skirt, const Vec3& axis) {
    const Garment& g = skirt.garment;
    Round r{azimuths(skirt, axis), {}, Eigen::VectorXd::Zero(skirt.count)};
    // Where a seam gains a turn its sides have azimuths that far apart.
    if (r.azimuth.maxCoeff() - r.azimuth.minCoeff() < most_of_a_turn) return std::nullopt;
    const std::vector<double> sense = senses(skirt, axis);
    Form down(skirt);
    std::vector<Vec2> ways;
    Eigen::VectorXd shares = Eigen::VectorXd::Zero(skirt.count);
    for (std::size_t k = 0; k < skirt.triangles.size(); ++k) {
        const Vec2 slope = skirt.slope(int(k), r.azimuth);
        if (!(slope.norm() > 0)) return std::nullopt;
        ways.push_back(sense[g.panel_of_triangle[skirt.triangles[k]]] * Vec2(-slope.y(), slope.x()).normalized());
        const Triangle v = g.nodes(skirt.triangles[k]);
        for (int i = 0; i < 3; ++i) {
            const int u = skirt.unknown[v[i]];
            down.pull[u] += skirt.areas[k] * skirt.slopes[k].row(i).dot(ways[k]);
            r.wide[u] += skirt.areas[k] * slope.norm();
            shares[u] += skirt.areas[k];
        }
    }
    r.wide = shares.cwiseQuotient(r.wide);
    for (const Stitch& s : g.stitches) {
        if (skirt.between(s)) down.want(across(s), tie, 0);
        if (skirt.upper(s)) down.want(upper_end(skirt, s), tie, 0);
    }
    r.down = down.least();
    double bent = 0, area = 0;
    for (std::size_t k = 0; k < ways.size(); ++k) {
        bent += skirt.areas[k] * (skirt.slope(int(k), r.down) - ways[k]).squaredNorm();
        area += skirt.areas[k];
    }
    if (bent > most_bent * area) return std::nullopt;
    return r;
}

/// Length of pleats over that of the circle in their middle; `steep` is their amplitude times their number over its radius.
double longer(double steep) {
    constexpr int parts = 16;
    double sum = 0;
    for (int i = 0; i < parts; ++i) sum += std::hypot(1, steep * std::sin((i + 0.5) * EIGEN_PI / parts));
    return sum / parts;
}

/// How far pleats that begin at a radius go out and in, m, to take up so much cloth per rad.
double amplitude(double wide, double radius, int pleats) {
    double low = 0, high = std::max(wide - radius, 0.0);
    for (int i = 0; i < 50; ++i) {
        const double a = 0.5 * (low + high), middle = radius + a;
        (middle * longer(a * pleats / middle) < wide ? low : high) = a;
    }
    return low;
}

/// `slant` is the angle between the cone and its axis.
Points on_cone(const Skirt& skirt, const Round& r, const Vec3& top, double radius, double slant, int pleats) {
    Points x = skirt.x;
    for (int i = 0; i < skirt.garment.node_count; ++i) {
        if (!skirt.has(i)) continue;
        const int u = skirt.unknown[i];
        const double down = std::max(r.down[u], 0.0), inner = radius + down * std::sin(slant);
        const double out = std::min(amplitude(r.wide[u], inner, pleats), deepest * down) * (1 - std::cos(pleats * r.azimuth[u]));
        x[i] = top + Vec3((inner + out) * std::cos(r.azimuth[u]), -down * std::cos(slant), (inner + out) * std::sin(r.azimuth[u]));
    }
    return x;
}

/// An even number, so that there are none to either side, where arms are.
int how_many_pleats(const Skirt& skirt, const Round& r) {
    double edge = 0;
    for (double a : skirt.areas) edge += std::sqrt(2 * a) / double(skirt.areas.size());
    std::vector<double> wide(r.wide.begin(), r.wide.end());
    const auto half = wide.begin() + std::ptrdiff_t(wide.size() / 2);
    std::nth_element(wide.begin(), half, wide.end());
    return std::clamp(2 * int(EIGEN_PI * *half / (pleat_edges * edge)), fewest_pleats, most_pleats);
}

} // namespace

std::optional<Points> wrap_round(const Garment& garment, const Points& x, const TriMesh& body, const std::vector<bool>& round) {
    const Skirt skirt = skirt_of(garment, x, round);
    Vec3 top = Vec3::Zero();
    double lowest = std::numeric_limits<double>::infinity();
    int hangers = 0;
    for (const Stitch& s : garment.stitches) {
        if (!skirt.upper(s)) continue;
        const Vec3 from = hanger(skirt, s);
        top += from;
        lowest = std::min(lowest, from.y());
        ++hangers;
    }
    if (hangers == 0) return std::nullopt;
    top /= hangers;
    top.y() = lowest;
    const std::optional<Round> r = go_round(skirt, top);
    if (!r) return std::nullopt;
    double cut = 0;
    for (const Stitch& s : garment.stitches)
        if (skirt.upper(s)) cut += r->wide[skirt.unknown[upper_end(skirt, s)[0].first]] / hangers;

    Garment between = garment;
    std::erase_if(between.stitches, [&](const Stitch& s) { return !skirt.between(s); });
    std::vector<int> map;
    const Garment closed = close_seams(between, &map);
    std::vector<Triangle> triangles;
    for (int t : skirt.triangles) triangles.push_back(closed.nodes(t));
    PlaceOptions where_it_is;
    where_it_is.farthest = 0;
    where_it_is.outside = round;
    for (const bool goes : round) where_it_is.fixed.push_back(!goes);
    const int pleats = how_many_pleats(skirt, *r);
    for (const double slant : slants)
        for (const double low : drops)
            for (const double more : wider) {
                Points laid = on_cone(skirt, *r, top - low * Vec3::UnitY(), cut + more, slant * EIGEN_PI / 180, pleats);
                const Points joined = merge(closed, map, laid);
                if (!place_clear(closed, joined, body, where_it_is).left.empty()) continue;
                if (!self_intersecting_pairs({joined, triangles}).empty()) continue;
                for (std::size_t i = 0; i < laid.size(); ++i) laid[i] = joined[map[i]];
                return laid;
            }
    return std::nullopt;
}

} // namespace toile

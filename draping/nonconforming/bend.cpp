// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/nonconforming/bend.h"

#include "draping/energy/bend.h"
#include "draping/energy/unfold.h"

#include <Eigen/Dense>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>

namespace toile {

namespace {

constexpr double ring_weight =
    0.25; // how much rather a slope uses the edge's own triangles than those around them
constexpr double largest_weight = 3; // on a regular mesh 0.5 inside, 2 at a border
constexpr int most_rings = 3;
constexpr double jump_stiffness = 1; // in units of D |e|^2 / (A1 + A2)

Eigen::Matrix<double, 2, 3> corner_gradients(const std::array<Vec2, 3>& corner) {
    Mat2 edges;
    edges << corner[1] - corner[0], corner[2] - corner[0];
    const Mat2 inverse = edges.inverse();
    Eigen::Matrix<double, 2, 3> gradients;
    gradients.col(1) = inverse.row(0);
    gradients.col(2) = inverse.row(1);
    gradients.col(0) = -gradients.col(1) - gradients.col(2);
    return gradients;
}

/// A linear map from midpoints to `Rows` numbers per coordinate, and what clamps add to it.
template <int Rows> struct Functional {
    using Column = Eigen::Matrix<double, Rows, 1>;
    std::map<int, Column> of;
    Eigen::Matrix<double, Rows, 3> offset = Eigen::Matrix<double, Rows, 3>::Zero();

    void add(int midpoint, const Column& weight) {
        of.emplace(midpoint, Column::Zero()).first->second += weight;
    }

    template <int More> void add(const Eigen::Matrix<double, Rows, More>& map, const Functional<More>& f) {
        for (const auto& [midpoint, weight] : f.of)
            add(midpoint, map * weight);
        offset += map * f.offset;
    }
};
using Gradient = Functional<2>;
using Second = Functional<4>; ///< uu, vu, uv, vv: derivative of slope u, v by u, then by v

/// A triangle in the plane of another.
struct Laid {
    int triangle = 0;
    std::array<Vec2, 3> corner;

    Vec2 centroid() const { return (corner[0] + corner[1] + corner[2]) / 3; }
    Vec2 middle(int k) const { return (corner[(k + 1) % 3] + corner[(k + 2) % 3]) / 2; }
};

Laid laid(const Unfolding::Placed& placed) {
    return {placed.triangle, {placed.corners[0].at, placed.corners[1].at, placed.corners[2].at}};
}

Laid own_plane(const Garment& garment, int t) {
    const Mat2& e = garment.rest.edges[t];
    return {t, {Vec2(0, 0), Vec2(e.col(0)), Vec2(e.col(1))}};
}

/// The rotation from the plane of the triangle's own rest shape to that in which it is laid.
Mat2 turn_of(const Garment& garment, const Laid& laid) {
    Mat2 edges;
    edges << laid.corner[1] - laid.corner[0], laid.corner[2] - laid.corner[0];
    const Mat2 map = edges * garment.rest.edges[laid.triangle].inverse();
    const Eigen::JacobiSVD<Mat2> svd(map, Eigen::ComputeFullU | Eigen::ComputeFullV);
    return svd.matrixU() * svd.matrixV().transpose();
}

Gradient gradient_of(const Garment& garment, const Laid& laid) {
    const auto gradients = corner_gradients(laid.corner);
    Gradient g;
    for (int k = 0; k < 3; ++k)
        g.add(garment.edges.of_triangle[laid.triangle][k], -2 * gradients.col(k));
    return g;
}

int side_of(const Garment& garment, int t, int e) {
    const auto& sides = garment.edges.of_triangle[t];
    return int(std::find(sides.begin(), sides.end(), e) - sides.begin());
}

/// Weights of the gradients of the triangles, the first `near` of which are preferred, exact at `at` where
/// gradients are linear. Empty when there are none, or none that are small enough.
std::vector<double> exact_weights(const std::vector<Laid>& triangles, int near, const Vec2& at,
                                  double length) {
    const int n = int(triangles.size());
    Eigen::MatrixXd conditions(3, n);
    Eigen::VectorXd share = Eigen::VectorXd::Constant(n, ring_weight);
    share.head(near).setOnes();
    for (int i = 0; i < n; ++i) {
        const Vec2 from = (triangles[i].centroid() - at) / length;
        conditions.col(i) = share[i] * Vec3(1, from.x(), from.y());
    }
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solve;
    solve.setThreshold(1e-6);
    solve.compute(conditions);
    const Eigen::VectorXd scaled = solve.solve(Vec3(1, 0, 0));
    const Eigen::VectorXd weights = scaled.cwiseProduct(share);
    if ((conditions * scaled - Vec3(1, 0, 0)).norm() > 1e-9 || weights.cwiseAbs().maxCoeff() > largest_weight)
        return {};
    return {weights.begin(), weights.end()};
}

/// Where the line from centroid to centroid is nearest to the middle of the edge: the best that two triangles
/// can do.
std::vector<double> line_weights(const std::vector<Laid>& own, const Vec2& at) {
    if (own.size() < 2) return {1};
    const Vec2 along = own[1].centroid() - own[0].centroid();
    const double w = std::clamp((at - own[0].centroid()).dot(along) / along.squaredNorm(), 0.0, 1.0);
    return {1 - w, w};
}

/// Slope at the middle of edge k of triangle t, in the plane of t.
Gradient shared_slope(const Garment& garment, int t, int k) {
    Unfolding unfolding = start_unfolding(garment, t);
    unfold_over(garment, unfolding, 0, k);
    const int near = int(unfolding.triangles.size());
    const Laid first = laid(unfolding.triangles[0]);
    const Vec2 at = first.middle(k);
    const double length = (first.corner[(k + 1) % 3] - first.corner[(k + 2) % 3]).norm();
    std::vector<Laid> triangles;
    std::vector<double> weights;
    for (int ring = 0; ring < most_rings && weights.empty(); ++ring) {
        unfold_ring(garment, unfolding);
        triangles.clear();
        for (const auto& placed : unfolding.triangles)
            triangles.push_back(laid(placed));
        weights = exact_weights(triangles, near, at, length);
    }
    if (weights.empty()) {
        triangles.resize(near);
        weights = line_weights(triangles, at);
    }
    Gradient slope;
    for (std::size_t i = 0; i < triangles.size(); ++i)
        slope.add<2>(weights[i] * Mat2::Identity(), gradient_of(garment, triangles[i]));
    return slope;
}

struct Assembly {
    const Garment& garment;
    const std::vector<Fabric>& fabrics;
    std::vector<const Clamp*> clamp_at;               ///< per edge
    std::vector<std::array<Gradient, 3>> slopes = {}; ///< per triangle and side, in the triangle's own plane
    std::vector<Second> seconds = {};                 ///< per triangle, in its own plane
    std::vector<Eigen::Triplet<double>> entries = {};
    std::vector<Eigen::RowVector3d> offsets = {};

    int triangles() const { return int(garment.triangles.size()); }
    double area(int t) const { return rest_area(garment.rest.edges[t]); }
    double stiffness(int t) const {
        const Fabric& f = fabrics[garment.panel_of_triangle[t]];
        return 0.5 * (f.bend_warp + f.bend_weft);
    }

    /// The triangle on the other side of edge k of t, laid in the plane of t; false at a border.
    bool across(int t, int k, Laid& other) const {
        Unfolding unfolding = start_unfolding(garment, t);
        unfold_over(garment, unfolding, 0, k);
        if (unfolding.triangles.size() < 2) return false;
        other = laid(unfolding.triangles[1]);
        return true;
    }

    void find_slopes() {
        slopes.resize(triangles());
        for (int e = 0; e < garment.edges.size(); ++e)
            for (int i = garment.edges.first[e]; i < garment.edges.first[e + 1]; ++i) {
                const int t = garment.edges.incident[i], k = side_of(garment, t, e);
                if (i > garment.edges.first[e] && neighbour(garment, t, k) >= 0)
                    continue; // the first has done it
                Gradient slope = clamp_at[e] ? Gradient{} : shared_slope(garment, t, k);
                if (clamp_at[e]) slope.offset = clamp_at[e]->slope.transpose();
                Laid other;
                if (across(t, k, other))
                    slopes[other.triangle][side_of(garment, other.triangle, e)].add<2>(
                        turn_of(garment, other).transpose(), slope);
                slopes[t][k] = std::move(slope);
            }
    }

    void find_seconds() {
        seconds.resize(triangles());
        for (int t = 0; t < triangles(); ++t) {
            const auto gradients = corner_gradients(own_plane(garment, t).corner);
            for (int k = 0; k < 3; ++k) {
                const Vec2 out = -2 * gradients.col(k); // |e| n_e / A
                Eigen::Matrix<double, 4, 2> map;
                map << out.x() * Mat2::Identity(), out.y() * Mat2::Identity();
                seconds[t].add<2>(map, slopes[t][k]);
            }
        }
    }

    template <int Rows> void put(const Functional<Rows>& f) {
        for (const auto& [midpoint, weight] : f.of)
            for (int r = 0; r < Rows; ++r)
                entries.emplace_back(int(offsets.size()) + r, midpoint, weight[r]);
        for (int r = 0; r < Rows; ++r)
            offsets.push_back(f.offset.row(r));
    }

    void put_curvature(int t, const Mat3& moduli) {
        Eigen::Matrix<double, 3, 4> to_voigt; // uu, vv, uv
        to_voigt << 1, 0, 0, 0, 0, 0, 0, 1, 0, 0.5, 0.5, 0;
        const Mat3 root = moduli.llt().matrixU();
        Functional<3> f;
        f.add<4>(std::sqrt(area(t)) * root * to_voigt, seconds[t]);
        put(f);
    }

    /// What the shared slope of an edge leaves of the slope that the triangle has there by its own gradient
    /// and second derivative. Both triangles see half of the jump between them, and so does the cloth at a
    /// clamp or border of that to its mirror image.
    void put_jump(int t, int k) {
        Laid other;
        const bool inner = across(t, k, other);
        const Laid own = own_plane(garment, t);
        const double d = inner ? 0.5 * (stiffness(t) + stiffness(other.triangle)) : stiffness(t);
        const double both = area(t) + (inner ? area(other.triangle) : area(t));
        const double length = (own.corner[(k + 1) % 3] - own.corner[(k + 2) % 3]).norm();
        const double factor = length * std::sqrt(2 * jump_stiffness * d / both);
        Gradient jump;
        jump.add<2>(factor * Mat2::Identity(), gradient_of(garment, own));
        jump.add<2>(-factor * Mat2::Identity(), slopes[t][k]);
        const Vec2 step = own.middle(k) - own.centroid();
        Eigen::Matrix<double, 2, 4> along;
        along << step.x() * Mat2::Identity(), step.y() * Mat2::Identity();
        jump.add<4>(factor * along, seconds[t]);
        put(jump);
    }
};

/// See MidpointBending::compact.
Eigen::SparseMatrix<double> jumps_alone(const Assembly& all) {
    const Garment& garment = all.garment;
    std::vector<Eigen::Triplet<double>> entries;
    int rows = 0;
    for (int t = 0; t < all.triangles(); ++t)
        for (int k = 0; k < 3; ++k) {
            Laid other;
            if (!all.across(t, k, other) || other.triangle < t) continue;
            const Laid own = own_plane(garment, t);
            const double length = (own.corner[(k + 1) % 3] - own.corner[(k + 2) % 3]).norm();
            const double d = 0.5 * (all.stiffness(t) + all.stiffness(other.triangle));
            const double factor = length * std::sqrt(3 * d / (all.area(t) + all.area(other.triangle)));
            Gradient jump;
            jump.add<2>(factor * Mat2::Identity(), gradient_of(garment, own));
            jump.add<2>(-factor * Mat2::Identity(), gradient_of(garment, other));
            for (const auto& [midpoint, weight] : jump.of)
                for (int r = 0; r < 2; ++r) entries.emplace_back(rows + r, midpoint, weight[r]);
            rows += 2;
        }
    Eigen::SparseMatrix<double> jumps(rows, garment.edges.size());
    jumps.setFromTriplets(entries.begin(), entries.end());
    return jumps.transpose() * jumps;
}

} // namespace

MidpointBending make_midpoint_bending(const Garment& garment, const std::vector<Fabric>& fabrics,
                                      const std::vector<Clamp>& clamps) {
    std::vector<Mat3> moduli;
    for (const Fabric& fabric : fabrics)
        moduli.push_back(bend_moduli(fabric));
    Assembly assembly{garment, fabrics, std::vector<const Clamp*>(garment.edges.size(), nullptr)};
    for (const Clamp& clamp : clamps) {
        if (clamp.edge < 0 || clamp.edge >= garment.edges.size())
            throw std::invalid_argument("edge " + std::to_string(clamp.edge) +
                                        " of a clamp does not exist: there are " +
                                        std::to_string(garment.edges.size()));
        assembly.clamp_at[clamp.edge] = &clamp;
    }
    assembly.find_slopes();
    assembly.find_seconds();
    for (int t = 0; t < assembly.triangles(); ++t)
        assembly.put_curvature(t, moduli[garment.panel_of_triangle[t]]);
    for (int t = 0; t < assembly.triangles(); ++t)
        for (int k = 0; k < 3; ++k)
            assembly.put_jump(t, k);

    MidpointBending bending;
    const int rows = int(assembly.offsets.size());
    bending.rows.resize(rows, garment.edges.size());
    bending.rows.setFromTriplets(assembly.entries.begin(), assembly.entries.end());
    bending.offset.resize(rows, 3);
    for (int i = 0; i < rows; ++i)
        bending.offset.row(i) = assembly.offsets[i];
    bending.stiffness = bending.rows.transpose() * bending.rows;
    bending.compact = jumps_alone(assembly);
    return bending;
}

namespace {

using Coordinates = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

// From a point of the cloth: rows of gradients sum to zero, and far from the origin only differences are
// small.
Coordinates residuals(const MidpointBending& bending, const Points& x) {
    Coordinates from_first(x.size(), 3);
    for (std::size_t i = 0; i < x.size(); ++i)
        from_first.row(i) = (x[i] - x[0]).transpose();
    return bending.rows * from_first + bending.offset;
}

} // namespace

double bend_value(const MidpointBending& bending, const Points& x) {
    return x.empty() ? 0 : 0.5 * residuals(bending, x).squaredNorm();
}

Points bend_gradient(const MidpointBending& bending, const Points& x) {
    Points gradient(x.size());
    if (x.empty()) return gradient;
    const Coordinates g = bending.rows.transpose() * residuals(bending, x);
    for (std::size_t i = 0; i < x.size(); ++i)
        gradient[i] = g.row(i);
    return gradient;
}

} // namespace toile

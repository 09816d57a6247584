// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/bend.h"

#include "draping/energy/grain.h"
#include "geometry/parallel.h"

#include <Eigen/Dense>

#include <algorithm>
#include <stdexcept>

namespace toile {

namespace {

// A linear functional of node positions.
struct Stencil {
    std::vector<int> nodes;
    std::vector<double> weights;

    void add(int node, double weight) {
        const auto at = std::find(nodes.begin(), nodes.end(), node);
        if (at != nodes.end()) {
            weights[at - nodes.begin()] += weight;
            return;
        }
        nodes.push_back(node);
        weights.push_back(weight);
    }
};

// Derivative across an edge, at its middle, out of the first of its triangles: exact, and from the edge's own
// two triangles alone.
struct EdgeSlope {
    Stencil exact, compact;
};

struct EdgeFrame {
    Vec2 middle, along, out;
    double length;

    /// Monomials (1, s, n, ss, sn, nn) in units of the edge's length, s along the edge and n out of the
    /// triangle.
    Eigen::Matrix<double, 6, 1> monomials(const Vec2& at) const {
        const double s = (at - middle).dot(along) / length, n = (at - middle).dot(out) / length;
        Eigen::Matrix<double, 6, 1> m;
        m << 1, s, n, s * s, s * n, n * n;
        return m;
    }
};

EdgeFrame frame_of(const Vec2& a, const Vec2& b, const Vec2& inside) {
    EdgeFrame frame;
    frame.length = (b - a).norm();
    frame.middle = (a + b) / 2;
    frame.along = (b - a) / frame.length;
    frame.out = Vec2(frame.along.y(), -frame.along.x());
    if (frame.out.dot(inside - a) > 0) frame.out = -frame.out;
    return frame;
}

constexpr double ring_weight =
    0.05; // how much rather a slope uses the edge's own triangles than those around them
constexpr double largest_weight = 4; // times 1 / length; on a regular mesh 0.58
constexpr int most_rings = 3;

// The weights of least (weighted) size that are exact on all quadratics. False when the points do not allow
// it.
bool exact_weights(const EdgeFrame& frame, const std::vector<RestPoint>& points, Eigen::VectorXd& weights) {
    const int n = int(points.size());
    Eigen::MatrixXd conditions(6, n);
    Eigen::VectorXd share = Eigen::VectorXd::Constant(n, ring_weight);
    share.head(4).setOnes();
    for (int i = 0; i < n; ++i)
        conditions.col(i) = frame.monomials(points[i].at) * share[i];
    Eigen::Matrix<double, 6, 1> slope = Eigen::Matrix<double, 6, 1>::Zero();
    slope[2] = 1 / frame.length;
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solve;
    solve.setThreshold(1e-8);
    solve.compute(conditions);
    weights = solve.solve(slope);
    const bool exact = (conditions * weights - slope).norm() < 1e-9 / frame.length;
    weights = weights.cwiseProduct(share);
    return exact && weights.cwiseAbs().maxCoeff() * frame.length < largest_weight;
}

// Linear interpolation on each side, mixed such that a surface bent about the edge has its exact slope.
Stencil compact_slope(const EdgeFrame& frame, const std::vector<RestPoint>& points) {
    // points: the edge's ends in 0 and 1, the far corners in 2 (inside) and 3 (outside)
    Stencil slope;
    std::array<double, 2> height, place;
    for (int side = 0; side < 2; ++side) {
        const Vec2 to = points[2 + side].at - points[0].at;
        height[side] = to.dot(frame.out);
        place[side] = to.dot(frame.along) / frame.length;
    }
    for (int side = 0; side < 2; ++side) {
        const double share = std::abs(height[1 - side]) / (std::abs(height[0]) + std::abs(height[1]));
        const double w = share / height[side];
        slope.add(points[2 + side].node, w);
        slope.add(points[0].node, -w * (1 - place[side]));
        slope.add(points[1].node, -w * place[side]);
    }
    return slope;
}

EdgeSlope inner_slope(const Garment& garment, int t, int k) {
    Unfolding unfolding = start_unfolding(garment, t);
    unfold_over(garment, unfolding, 0, k);
    std::vector<RestPoint>& points = unfolding.points;
    const auto& corner = unfolding.triangles[0].corners;
    const RestPoint a = corner[(k + 1) % 3], b = corner[(k + 2) % 3], inside = corner[k];
    const EdgeFrame frame = frame_of(a.at, b.at, inside.at);
    points[0] = a, points[1] = b, points[2] = inside;

    EdgeSlope slope;
    if (points.size() < 4) return slope; // two triangles on the same three nodes
    slope.compact = compact_slope(frame, points);
    Eigen::VectorXd weights;
    for (int ring = 0; ring < most_rings; ++ring) {
        unfold_ring(garment, unfolding);
        if (!exact_weights(frame, points, weights)) continue;
        for (std::size_t i = 0; i < points.size(); ++i)
            slope.exact.add(points[i].node, weights[i]);
        return slope;
    }
    slope.exact = slope.compact; // a strip too narrow to show the curvature across it
    return slope;
}

std::array<Vec2, 3> barycentric_gradients(const Mat2& edges) {
    const Mat2 inverse = edges.inverse();
    const Vec2 a = inverse.row(0), b = inverse.row(1);
    return {Vec2(-a - b), a, b};
}

// Out of triangle t across its border edge k: the slope of its own patch.
Stencil border_slope(const Garment& garment, int t, int k, const Patch& patch) {
    const auto gradient = barycentric_gradients(garment.rest.edges[t]);
    const Vec2 out = -gradient[k].normalized();
    Stencil slope;
    for (int i = 0; i < 3; ++i)
        slope.add(patch.nodes[i], gradient[i].dot(out));
    // The patch is the interpolant plus sum_m -q_m / 2 l_i l_j; in the middle of edge k, l_k = 0 and the
    // others 1/2.
    for (int m = 0; m < 3; ++m) {
        const Vec2 bump =
            m == k ? Vec2((gradient[(m + 1) % 3] + gradient[(m + 2) % 3]) / 2) : Vec2(gradient[k] / 2);
        for (int a = 0; a < patch.count; ++a)
            slope.add(patch.nodes[a], -0.5 * patch.curve(m, a) * bump.dot(out));
    }
    return slope;
}

int slot_of(const Garment& garment, int e) { // corner opposite edge e in the edge's first triangle
    const auto& sides = garment.edges.of_triangle[garment.edges.incident[garment.edges.first[e]]];
    return int(std::find(sides.begin(), sides.end(), e) - sides.begin());
}

std::vector<EdgeSlope> inner_slopes(const Garment& garment) {
    std::vector<EdgeSlope> slopes(garment.edges.size());
    parallel_for(garment.edges.size(), 256, [&](int begin, int end) {
        for (int e = begin; e < end; ++e) {
            const int t = garment.edges.incident[garment.edges.first[e]], k = slot_of(garment, e);
            if (neighbour(garment, t, k) >= 0) slopes[e] = inner_slope(garment, t, k);
        }
    });
    return slopes;
}

// Second derivatives (uu, vv, uv) of Morley's triangle from its corners (columns 0-2) and from the slopes out
// of its edges (columns 3-5): the mean of the gradient's derivative, by Gauss, from the gradient at
// mid-edges.
Eigen::Matrix<double, 3, 6> morley(const Mat2& edges) {
    const auto gradient = barycentric_gradients(edges);
    Eigen::Matrix<double, 3, 6> b = Eigen::Matrix<double, 3, 6>::Zero();
    for (int k = 0; k < 3; ++k) {
        // With height h over edge k, |gradient_k| = 1 / h and length / area = 2 / h.
        const double two_over_h = 2 * gradient[k].norm();
        const Vec2 n = -gradient[k].normalized();
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const std::array<Vec2, 3> corner{Vec2(0, 0), Vec2(edges.col(0)), Vec2(edges.col(1))};
        const Vec2 line = corner[j] - corner[i], s = line / line.squaredNorm();
        b.col(3 + k) = two_over_h * Vec3(n.x() * n.x(), n.y() * n.y(), n.x() * n.y());
        const Vec3 mixed =
            two_over_h * Vec3(n.x() * s.x(), n.y() * s.y(), 0.5 * (n.x() * s.y() + n.y() * s.x()));
        b.col(j) += mixed;
        b.col(i) -= mixed;
    }
    return b;
}

BendRows exact_rows(const Garment& garment, int t, const std::vector<EdgeSlope>& slopes, const Patch& patch) {
    const Eigen::Matrix<double, 3, 6> b = morley(garment.rest.edges[t]);
    const Triangle corners = garment.nodes(t);
    BendRows result{{corners.begin(), corners.end()}, b.leftCols<3>()};
    auto& [nodes, rows] = result;
    for (int k = 0; k < 3; ++k) {
        const int e = garment.edges.of_triangle[t][k];
        const bool inner = neighbour(garment, t, k) >= 0;
        const Stencil own = inner ? Stencil{} : border_slope(garment, t, k, patch);
        const Stencil& slope = inner ? slopes[e].exact : own;
        const double sign = garment.edges.incident[garment.edges.first[e]] == t ? 1 : inner ? -1 : 1;
        for (std::size_t i = 0; i < slope.nodes.size(); ++i) {
            const int at = int(std::find(nodes.begin(), nodes.end(), slope.nodes[i]) - nodes.begin());
            if (at == int(nodes.size())) {
                nodes.push_back(slope.nodes[i]);
                rows.conservativeResize(3, rows.cols() + 1);
                rows.rightCols<1>().setZero();
            }
            rows.col(at) += sign * slope.weights[i] * b.col(3 + k);
        }
    }
    if (!garment.rest.curvature.empty())
        rows.leftCols<3>() -= garment.rest.curvature[t].leftCols<2>() * grain_shape(garment.rest.edges[t]).transpose();
    return result;
}

std::vector<BendRows> bend_rows(const Garment& garment, const std::vector<EdgeSlope>& slopes) {
    const std::vector<Patch> patches = make_patches(garment);
    std::vector<BendRows> all(garment.triangles.size());
    parallel_for(int(all.size()), 256, [&](int begin, int end) {
        for (int t = begin; t < end; ++t) all[t] = exact_rows(garment, t, slopes, patches[t]);
    });
    return all;
}

BendElement compact_element(const Garment& garment, int t, const std::vector<EdgeSlope>& slopes,
                            const Mat3& moduli) {
    const Mat2& edges = garment.rest.edges[t];
    const Eigen::Matrix<double, 3, 6> b = morley(edges);
    const Triangle corners = garment.nodes(t);
    BendElement element;
    element.count = 3;
    std::copy(corners.begin(), corners.end(), element.nodes.begin());
    // Energy over (second derivatives of what is known) with the slopes of border edges left free: they take
    // the value of least energy, which is a constraint on the moduli.
    Eigen::Matrix<double, 3, BendElement::max_nodes> rows = Eigen::Matrix<double, 3, 6>::Zero();
    rows.leftCols<3>() = b.leftCols<3>();
    Mat3 left = moduli;
    for (int k = 0; k < 3; ++k) {
        const int e = garment.edges.of_triangle[t][k];
        if (neighbour(garment, t, k) < 0) {
            const Vec3 free = b.col(3 + k), moment = left * free;
            const double size = free.dot(moment);
            if (size > 1e-12 * moduli.trace() * free.squaredNorm())
                left -= moment * moment.transpose() / size;
            continue;
        }
        const Stencil& slope = slopes[e].compact;
        const double sign = garment.edges.incident[garment.edges.first[e]] == t ? 1 : -1;
        for (std::size_t i = 0; i < slope.nodes.size(); ++i) {
            const auto end = element.nodes.begin() + element.count;
            const int at = int(std::find(element.nodes.begin(), end, slope.nodes[i]) - element.nodes.begin());
            if (at == element.count) element.nodes[element.count++] = slope.nodes[i];
            rows.col(at) += sign * slope.weights[i] * b.col(3 + k);
        }
    }
    element.stiffness = rest_area(edges) * rows.transpose() * left * rows;
    return element;
}

Eigen::SparseMatrix<double> assemble(const Garment& garment, const std::vector<EdgeSlope>& slopes,
                                     const std::vector<Mat3>& moduli) {
    const std::vector<BendRows> all = bend_rows(garment, slopes);
    const int n = int(garment.triangles.size());
    std::vector<Eigen::MatrixXd> blocks(n);
    parallel_for(n, 256, [&](int begin, int end) {
        for (int t = begin; t < end; ++t) {
            const auto& rows = all[t].rows;
            blocks[t] = rest_area(garment.rest.edges[t]) * rows.transpose() *
                        moduli[garment.panel_of_triangle[t]] * rows;
        }
    });
    std::vector<Eigen::Triplet<double>> entries;
    for (int t = 0; t < n; ++t) {
        const std::vector<int>& nodes = all[t].nodes;
        for (std::size_t i = 0; i < nodes.size(); ++i)
            for (std::size_t j = 0; j < nodes.size(); ++j)
                entries.emplace_back(nodes[i], nodes[j], blocks[t](i, j));
    }
    Eigen::SparseMatrix<double> stiffness(garment.node_count, garment.node_count);
    stiffness.setFromTriplets(entries.begin(), entries.end());
    return stiffness;
}

// Row i of K x, from differences: the rows of K sum to zero, and far from the origin only differences are
// small.
Vec3 force_at(const Eigen::SparseMatrix<double>& stiffness, const Points& x, int i) {
    Vec3 sum = Vec3::Zero();
    for (Eigen::SparseMatrix<double>::InnerIterator entry(stiffness, i); entry; ++entry)
        sum += entry.value() * (x[entry.index()] - x[i]);
    return sum;
}

} // namespace

std::vector<BendRows> bend_rows(const Garment& garment) { return bend_rows(garment, inner_slopes(garment)); }

Mat3 bend_moduli(const Fabric& fabric) {
    Mat3 d = Mat3::Zero();
    d(0, 0) = fabric.bend_weft;
    d(1, 1) = fabric.bend_warp;
    d(0, 1) = d(1, 0) = fabric.bend_poisson * std::sqrt(fabric.bend_warp * fabric.bend_weft);
    d(2, 2) = 4 * fabric.bend_twist;
    if (!(d(0, 0) > 0 && d(1, 1) > 0 && d(2, 2) > 0 && std::abs(fabric.bend_poisson) < 1))
        throw std::invalid_argument(
            "fabric \"" + fabric.name +
            "\": bend_warp, bend_weft and bend_twist must be positive and bend_poisson below 1");
    return d;
}

double bend_modulus(const Fabric& f, double angle) {
    const double c = std::pow(std::cos(angle), 2), s = std::pow(std::sin(angle), 2);
    const double coupling = f.bend_poisson * std::sqrt(f.bend_warp * f.bend_weft);
    return f.bend_warp * c * c + f.bend_weft * s * s + (2 * coupling + 4 * f.bend_twist) * c * s;
}

Bending make_bending(const Garment& garment, const std::vector<Fabric>& fabrics) {
    std::vector<Mat3> moduli;
    for (const Fabric& fabric : fabrics)
        moduli.push_back(bend_moduli(fabric));
    const std::vector<EdgeSlope> slopes = inner_slopes(garment);
    Bending bending;
    bending.stiffness = assemble(garment, slopes, moduli);
    bending.compact.resize(garment.triangles.size());
    for (int t = 0; t < int(bending.compact.size()); ++t)
        bending.compact[t] = compact_element(garment, t, slopes, moduli[garment.panel_of_triangle[t]]);
    return bending;
}

double bend_value(const Bending& bending, const Points& x) {
    return 0.5 * parallel_sum(int(x.size()), 512, [&](int begin, int end) {
               double sum = 0;
               for (int i = begin; i < end; ++i)
                   sum += (x[i] - x[0]).dot(force_at(bending.stiffness, x, i));
               return sum;
           });
}

void bend_gradient(const Bending& bending, const Points& x, Points& gradient) {
    parallel_for(int(x.size()), 512, [&](int begin, int end) {
        for (int i = begin; i < end; ++i)
            gradient[i] += force_at(bending.stiffness, x, i);
    });
}

void add_gradient(const Bending& bending, const Points& x, Eigen::VectorXd& g) {
    Points bent(x.size(), Vec3::Zero());
    bend_gradient(bending, x, bent);
    g += flat(bent);
}

void couplings(const Bending& bending, std::vector<std::pair<int, int>>& pairs) {
    for (int j = 0; j < bending.stiffness.outerSize(); ++j)
        for (Eigen::SparseMatrix<double>::InnerIterator entry(bending.stiffness, j); entry; ++entry)
            if (entry.row() > j) pairs.emplace_back(int(entry.row()), j);
}

void add_hessian(const Bending& bending, BlockMatrix& h) {
    for (int j = 0; j < bending.stiffness.outerSize(); ++j)
        for (Eigen::SparseMatrix<double>::InnerIterator entry(bending.stiffness, j); entry; ++entry) {
            const Mat3 block = entry.value() * Mat3::Identity();
            if (entry.row() == j)
                h.add_diagonal(j, block);
            else if (entry.row() > j)
                h.add_off_diagonal(j, h.find(int(entry.row()), j), block);
        }
}

} // namespace toile

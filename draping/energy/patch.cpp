// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/patch.h"

#include "geometry/parallel.h"

#include <Eigen/Dense>

#include <algorithm>

namespace toile {

namespace {

// Weighted products of barycentric coordinates; on a regular mesh the smallest singular value is 0.42. Below
// the first bound more nodes are added, below the second a curvature counts as invisible.
constexpr double well_conditioned = 0.1;
constexpr double invisible = 1e-3;

using Curve = Eigen::Matrix<double, 3, Patch::max_nodes>;

Vec3 barycentric(const Mat2& inverse_edges, const Vec2& at) {
    const Vec2 l = inverse_edges * at;
    return {1 - l.x() - l.y(), l.x(), l.y()};
}

// The quadratic that vanishes at the corners is sum_k c_k l_i l_j (i, j the ends of edge k), and its second
// derivative along edge k, times length squared, is -2 c_k. Fits the other points, weighted by 1 / distance^4
// since the error of a smooth surface grows with distance cubed. Returns the smallest singular value.
double fit_curve(const std::vector<RestPoint>& points, int count, const Mat2& edges, Curve& curve) {
    const Mat2 inverse = edges.inverse();
    const Vec2 centre = (edges.col(0) + edges.col(1)) / 3;
    const double size = std::abs(edges.determinant());
    Eigen::Matrix<double, Patch::max_nodes - 3, 3> products =
        Eigen::Matrix<double, Patch::max_nodes - 3, 3>::Zero();
    Eigen::Matrix<double, Patch::max_nodes - 3, Patch::max_nodes> deviation;
    deviation.setZero();
    for (int a = 3; a < count; ++a) {
        const Vec3 l = barycentric(inverse, points[a].at);
        const double near = size / (points[a].at - centre).squaredNorm(), weight = near * near;
        products.row(a - 3) = weight * Vec3(l[1] * l[2], l[2] * l[0], l[0] * l[1]).transpose();
        deviation.row(a - 3).head<3>() = -weight * l.transpose();
        deviation(a - 3, a) = weight;
    }
    // Normal equations would square the condition number; a 6 x 3 singular value decomposition is cheap.
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(products, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Vec3 values = svd.singularValues();
    Vec3 inverses = Vec3::Zero();
    for (int i = 0; i < 3; ++i)
        if (values[i] > invisible) inverses[i] = 1 / values[i];
    curve = -2 * (svd.matrixV() * inverses.asDiagonal() * (svd.matrixU().transpose() * deviation));
    return values[2];
}

// Nodes of the outermost ring come nearest first, so that a full patch leaves out the farthest.
void sort_ring(std::vector<RestPoint>& points, std::size_t first, const Vec2& centre) {
    std::stable_sort(points.begin() + first, points.end(), [&](const RestPoint& a, const RestPoint& b) {
        return (a.at - centre).squaredNorm() < (b.at - centre).squaredNorm();
    });
}

Patch make_patch(const Garment& garment, int t) {
    const Mat2& edges = garment.rest.edges[t];
    const Vec2 centre = (edges.col(0) + edges.col(1)) / 3;
    Unfolding unfolding = start_unfolding(garment, t);
    Patch patch;
    double condition = 0;
    while (condition < well_conditioned && patch.count < Patch::max_nodes) {
        const std::size_t before = unfolding.points.size(), rings = unfolding.triangles.size();
        unfold_ring(garment, unfolding);
        if (unfolding.triangles.size() == rings) break;
        if (before > 3) sort_ring(unfolding.points, before, centre);
        patch.count = int(std::min<std::size_t>(unfolding.points.size(), Patch::max_nodes));
        condition = fit_curve(unfolding.points, patch.count, edges, patch.curve);
    }
    if (patch.count == 0) { // a triangle on its own cannot be seen to bend
        patch.count = 3;
        patch.curve.setZero();
    }
    for (int a = 0; a < patch.count; ++a)
        patch.nodes[a] = unfolding.points[a].node;
    return patch;
}

} // namespace

std::vector<Patch> make_patches(const Garment& garment) {
    std::vector<Patch> patches(garment.triangles.size());
    parallel_for(int(patches.size()), 256, [&](int begin, int end) {
        for (int t = begin; t < end; ++t)
            patches[t] = make_patch(garment, t);
    });
    return patches;
}

Mat3 curvature_of_edges(const Mat2& edges) {
    const Mat2 inverse = edges.inverse();
    const std::array<Vec2, 3> slope{Vec2(-inverse.row(0) - inverse.row(1)), Vec2(inverse.row(0)),
                                    Vec2(inverse.row(1))};
    Mat3 result;
    for (int k = 0; k < 3; ++k) {
        const Vec2 &a = slope[(k + 1) % 3], &b = slope[(k + 2) % 3];
        result.col(k) = -Vec3(a.x() * b.x(), a.y() * b.y(), 0.5 * (a.x() * b.y() + a.y() * b.x()));
    }
    return result;
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sewing/flat_energy.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <limits>

namespace toile {

namespace {

Mat4 positive_part(const Mat4& m) {
    const Eigen::SelfAdjointEigenSolver<Mat4> own(m);
    return own.eigenvectors() * own.eigenvalues().cwiseMax(0).asDiagonal() * own.eigenvectors().transpose();
}

} // namespace

double flat_energy(const Mat2& j, Vec4* gradient, Mat4* hessian) {
    const double d = j.determinant(), n = j.squaredNorm();
    if (!(d > 0)) return std::numeric_limits<double>::infinity();
    const Vec4 f(j(0, 0), j(1, 0), j(0, 1), j(1, 1)), g(f[3], -f[2], -f[1], f[0]); // g: slope of d
    const double whole = 1 + 1 / (d * d), cube = 1 / (d * d * d); // |J^-1|^2 = n / d^2
    if (gradient) *gradient = 0.5 * (whole * f - n * cube * g);
    if (hessian) {
        Mat4 turn = Mat4::Zero(); // second derivatives of d
        turn(0, 3) = turn(3, 0) = 1;
        turn(1, 2) = turn(2, 1) = -1;
        *hessian = positive_part(0.5 * whole * Mat4::Identity() - cube * (f * g.transpose() + g * f.transpose()) +
                                 1.5 * n * cube / d * g * g.transpose() - 0.5 * n * cube * turn);
    }
    return 0.25 * (n * whole - 4);
}

double sewn_energy(const std::array<Vec2, 4>& ends, Eigen::Matrix<double, 8, 1>* gradient, Eigen::Matrix<double, 8, 8>* hessian) {
    const Vec2 a = ends[1] - ends[0], b = ends[3] - ends[2];
    const double off = a.norm() - b.norm();
    Eigen::Matrix<double, 8, 1> slope;
    slope << -a.normalized(), a.normalized(), b.normalized(), -b.normalized();
    if (gradient) *gradient = off * slope;
    if (hessian) {
        *hessian = slope * slope.transpose();
        // The longer edge resists being turned; that the shorter one gives way is left out.
        const Vec2& longer = off > 0 ? a : b;
        const Vec2 across = Vec2(-longer.y(), longer.x()) / longer.norm();
        const Mat2 stiff = std::abs(off) / longer.norm() * across * across.transpose();
        const int at = off > 0 ? 0 : 4;
        hessian->block<2, 2>(at, at) += stiff;
        hessian->block<2, 2>(at + 2, at + 2) += stiff;
        hessian->block<2, 2>(at, at + 2) -= stiff;
        hessian->block<2, 2>(at + 2, at) -= stiff;
    }
    return 0.5 * off * off;
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sewing/flat_energy.h"

#include <catch2/catch.hpp>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

using namespace toile;

namespace {

constexpr double step = 1e-6;

/// Differences of f, one row per direction.
template <class Vector, class F>
Eigen::MatrixXd differences(const Vector& x, F&& f) {
    Eigen::MatrixXd rows(x.size(), f(x).size());
    for (int i = 0; i < x.size(); ++i) {
        Vector up = x, down = x;
        up[i] += step, down[i] -= step;
        rows.row(i) = ((f(up) - f(down)) / (2 * step)).transpose();
    }
    return rows;
}

Eigen::Matrix<double, 1, 1> one(double v) { return Eigen::Matrix<double, 1, 1>(v); }

Mat2 as_map(const Vec4& f) { return Eigen::Map<const Mat2>(f.data()); }

using Vec8 = Eigen::Matrix<double, 8, 1>;
using Mat8 = Eigen::Matrix<double, 8, 8>;

std::array<Vec2, 4> as_ends(const Vec8& x) { return {x.segment<2>(0), x.segment<2>(2), x.segment<2>(4), x.segment<2>(6)}; }

} // namespace

TEST_CASE("the energy of a map to the plane has the derivatives that differences show and is infinite where it folds over") {
    for (const Vec4& f : {Vec4(1, 0, 0, 1), Vec4(1.2, 0.3, -0.5, 0.9), Vec4(0.4, 0.1, 0.2, 0.6), Vec4(2, -1, 0.5, 1.5), Vec4(-1, 0.1, 0, -0.8)}) {
        Vec4 gradient;
        Mat4 hessian;
        const double value = flat_energy(as_map(f), &gradient, &hessian);
        const Mat2 j = as_map(f);
        CHECK(value == Approx((j.squaredNorm() + j.inverse().squaredNorm() - 4) / 4).margin(1e-14));
        CHECK((gradient - differences(f, [](const Vec4& x) { return one(flat_energy(as_map(x))); })).norm() < 1e-7 * (1 + gradient.norm()));
        const Mat4 exact = differences(f, [](const Vec4& x) {
            Vec4 g;
            flat_energy(as_map(x), &g);
            return g;
        });
        const Eigen::SelfAdjointEigenSolver<Mat4> own(Mat4(0.5 * (exact + exact.transpose())));
        const Mat4 positive = own.eigenvectors() * own.eigenvalues().cwiseMax(0).asDiagonal() * own.eigenvectors().transpose();
        CHECK((hessian - positive).norm() < 1e-6 * (1 + hessian.norm()));
    }
    CHECK(std::isinf(flat_energy(as_map(Vec4(1, 0, 0, -1)))));
    CHECK(std::isinf(flat_energy(Mat2::Zero())));
}

TEST_CASE("the energy of a pair of sewn edges has the derivatives that differences show but for the shorter edge giving way") {
    Vec8 x;
    x << 0, 0, 1, 0.2, 3, 1, 2.5, 1.4;
    for (const bool swapped : {false, true}) {
        if (swapped) x.head<4>().swap(x.tail<4>());
        Vec8 gradient;
        Mat8 hessian;
        const double value = sewn_energy(as_ends(x), &gradient, &hessian);
        const double a = (x.segment<2>(2) - x.segment<2>(0)).norm(), b = (x.segment<2>(6) - x.segment<2>(4)).norm();
        CHECK(value == Approx(0.5 * (a - b) * (a - b)));
        CHECK((gradient - differences(x, [](const Vec8& y) { return one(sewn_energy(as_ends(y))); })).norm() < 1e-8);
        const Mat8 exact = differences(x, [](const Vec8& y) {
            Vec8 g;
            sewn_energy(as_ends(y), &g);
            return g;
        });
        const Eigen::SelfAdjointEigenSolver<Mat8> left(Mat8(hessian - exact)), own(hessian);
        CHECK(own.eigenvalues()[0] > -1e-12);
        CHECK(left.eigenvalues().head<7>().cwiseAbs().maxCoeff() < 1e-8); // one direction is left out:
        CHECK(left.eigenvalues()[7] == Approx(2 * std::abs(a - b) / std::min(a, b)).epsilon(1e-6)); // both ends of the shorter, turned
    }
}

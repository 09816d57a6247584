// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/stability/boundary.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace toile {

namespace {

constexpr double pi = std::numbers::pi;

void sweep(std::vector<double>& excess, ChainOrder order, double end_mass) {
    const int n = int(excess.size());
    for (int k = 0; k < n; ++k) {
        const int i = order == ChainOrder::from_held_end ? k : n - 1 - k;
        if (excess[i] <= 0) continue;
        const double upper = i == 0 ? 0 : 1, lower = i + 1 == n ? 1 / end_mass : 1; // mobilities
        if (i > 0) excess[i - 1] += excess[i] * upper / (upper + lower);
        if (i + 1 < n) excess[i + 1] += excess[i] * lower / (upper + lower);
        excess[i] = 0;
    }
}

/// The z up to which a period of 2 pi / z steps, each of which divides the amplitude by e^loss(z), leaves more than `left` of it; below `high`,
/// up to where loss(z) / z grows.
template <class Loss> double longest_swing(double high, double left, Loss loss) {
    double low = 0;
    for (int i = 0; i < 60; ++i) {
        const double z = (low + high) / 2;
        (2 * pi * loss(z) < -z * std::log(left) ? low : high) = z;
    }
    return low;
}

} // namespace

double indefinite_step(double mass, double stiffness, double rest, double length) {
    return indefinite_step(-2 * stiffness * (rest - length) / (length * mass));
}

double indefinite_step(double lowest) {
    return lowest < 0 ? 1 / std::sqrt(-lowest) : std::numeric_limits<double>::infinity();
}

double swing_step(double frequency, double left) {
    // log(1 + z^2) / z grows up to z = 1.98
    return longest_swing(1, left, [](double z) { return std::log(1 + z * z) / 2; }) / frequency;
}

double bdf2_swing_step(double frequency, double left) {
    return longest_swing(2, left, [](double z) { return std::log(std::abs(2.0 - std::sqrt(std::complex<double>(1, 2 * z)))); }) / frequency;
}

double projective_rate(double strain, double shared) { return 1 - (strain / (1 + strain) + shared) / (1 + shared); }

double sweep_rate(int links, double softness, double end_mass) {
    Eigen::VectorXd own(links), beside(links - 1);
    for (int i = 0; i < links; ++i) own[i] = softness * ((i == 0 ? 0 : 1) + (i + 1 == links ? 1 / end_mass : 1)) + 1;
    for (int i = 0; i + 1 < links; ++i) beside[i] = softness / std::sqrt(own[i] * own[i + 1]);
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    solver.computeFromTridiagonal(Eigen::VectorXd::Zero(links), beside, Eigen::EigenvaluesOnly);
    const double jacobi = solver.eigenvalues().maxCoeff();
    return jacobi * jacobi;
}

double times_until(double rate, double left) { return std::log(left) / std::log(rate); }

std::vector<double> limited_chain(int links, ChainOrder order, int sweeps, double end_mass) {
    std::vector<double> excess(links, 1.0);
    for (int k = 0; k < sweeps; ++k) sweep(excess, order, end_mass);
    return excess;
}

int limit_sweeps(int links, ChainOrder order, double left, double end_mass) {
    std::vector<double> excess(links, 1.0);
    int sweeps = 0;
    for (; *std::max_element(excess.begin(), excess.end()) > left; ++sweeps) sweep(excess, order, end_mass);
    return sweeps;
}

} // namespace toile

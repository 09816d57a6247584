// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/implicit.h"

#include <stdexcept>

namespace toile {

namespace {

using Eigen::VectorXd;

constexpr double hold_share = 100; // of the nodes' own entries in the matrix, with which touches hold
constexpr double left_over = 1e-5; // of the size of a solution, that conjugate gradients leave
constexpr int most_gradients = 50;
constexpr int most_rounds = 2;     // solves of a step, until every touch that slides or pulls is known

} // namespace

std::vector<double> own_stiffness(const BlockMatrix& a) {
    std::vector<double> own(a.block_rows(), 0.0);
    for (int i = 0; i < a.rows(); ++i) own[i / 3] += a.values()[a.scalar_columns()[i]] / 3;
    return own;
}

/// The velocities by the cloth's own forces and by what contact did in the last step; touches that pull are let go
/// on the way, and those that friction does not hold slide.
Points ImplicitStepper::candidate(Moving& cloth, HeldTouches& touches) {
    const int n = problem_.points();
    const double dt = options_.time_step;
    problem_.arrive(cloth.x);
    VectorXd g;
    problem_.gradient(cloth.x, g);
    bool pattern_changed = false;
    BlockMatrix& a = problem_.hessian(cloth.x, false, pattern_changed);
    if (!analysed_ || pattern_changed) factor_.analyse(a, analysed_);
    analysed_ = true;
    // All by dt2: the second derivative as the problem has it.
    a.add_to_diagonal((1 + options_.damping * dt) / (dt * dt) * problem_.mass());
    problem_.add_damping_matrix(cloth.x, 1 / dt, a);
    VectorXd momentum = problem_.mass().cwiseProduct(flat(cloth.velocity)) - dt * g;
    for (int i = 0; i < n; ++i) momentum.segment<3>(3 * i) += dt * cloth.other_force[i];
    touches.find_holds(own_stiffness(a), hold_share);
    Points v(n);
    for (int round = 0; round < most_rounds; ++round) {
        BlockMatrix held = a;
        VectorXd b = momentum;
        touches.add(held, b);
        for (int i = 0; i < n; ++i)
            if (pinned(i)) b.segment<3>(3 * i).setZero();
        held.pin(problem_.pinned());
        ++factorisations_;
        if (!factor_.factorise(held)) throw std::runtime_error("the motion of the cloth has no finite stiffness");
        flat(v) = solution(held, b / (dt * dt));
        if (!touches.let_go(v, round + 1 == most_rounds)) break;
    }
    return v;
}

/// By the factor of `a`; conjugate gradients add what `a` leaves out of the second derivative. Without it the step would be explicit
/// in that part, which a stiff plate does not bear.
VectorXd ImplicitStepper::solution(const BlockMatrix& a, const VectorXd& b) {
    const auto left_out = [&](const VectorXd& v) {
        VectorXd product = VectorXd::Zero(v.size());
        problem_.add_left_out(v, product);
        for (int i = 0; i < problem_.points(); ++i)
            if (pinned(i)) product.segment<3>(3 * i).setZero();
        return product;
    };
    VectorXd x, z, product;
    factor_.solve(b, x);
    VectorXd r = -left_out(x);
    if (r.isZero(0)) return x;
    factor_.solve(r, z);
    VectorXd p = z;
    double rz = r.dot(z);
    const double stop = left_over * left_over * b.dot(x);
    for (int k = 0; k < most_gradients && rz > stop; ++k) {
        a.multiply(p, product);
        product += left_out(p);
        const double share = rz / p.dot(product);
        x += share * p;
        r -= share * product;
        factor_.solve(r, z);
        const double next = r.dot(z);
        p = z + next / rz * p;
        rz = next;
    }
    return x;
}

ResponseDone ImplicitStepper::step(Moving& cloth, const Points& body_end) {
    Points v;
    const ResponseDone done = step_with_touches(cloth, response_, inverse_mass(), body_end, options_, [&](HeldTouches& touches) {
        Points wanted = candidate(cloth, touches);
        constrain(cloth, wanted);
        return wanted;
    }, v);
    for (std::size_t i = 0; i < cloth.x.size(); ++i) cloth.x[i] += options_.time_step * v[i];
    cloth.velocity = std::move(v);
    return done;
}

} // namespace toile

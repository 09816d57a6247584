// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/nonconforming/motion.h"

#include <Eigen/SparseCholesky>

#include <numeric>
#include <stdexcept>
#include <string>

namespace toile {

namespace {

constexpr double immovable = 1e-10; // share of the mean mobility below which a ghost node cannot be moved

/// Of (x - known) * rate = velocity and (velocity - known_velocity) * rate = acceleration at the end of a
/// step.
struct Formula {
    double rate = 0; ///< 1/s
    Points known, known_velocity;
};

Formula formula_of(const Motion& m, double h) {
    if (m.x_before.empty() || h != m.last_step) return {1 / h, m.x, m.velocity};
    Formula f{1.5 / h, m.x, m.velocity};
    for (std::size_t i = 0; i < m.x.size(); ++i) {
        f.known[i] = (4 * m.x[i] - m.x_before[i]) / 3;
        f.known_velocity[i] = (4 * m.velocity[i] - m.velocity_before[i]) / 3;
    }
    return f;
}

/// Inertia as a spring to where the midpoints would go without force; damping as one to where they come from.
void add_inertia(const std::vector<double>& mass, const Formula& f, double damping,
                 IsometricProblem& problem) {
    const double inertia = f.rate * f.rate, drag = damping * f.rate;
    for (std::size_t i = 0; i < mass.size(); ++i) {
        problem.stiffness.coeffRef(i, i) += mass[i] * (inertia + drag);
        problem.load[i] += mass[i] * ((inertia + drag) * f.known[i] + f.rate * f.known_velocity[i]);
    }
}

void need_nodes(const NonconformingCloth& cloth, const Points& given, const std::string& what) {
    const auto nodes = cloth.midpoints.ghost.rows();
    if (Eigen::Index(given.size()) != nodes)
        throw std::invalid_argument(what + " are of " + std::to_string(given.size()) + " nodes, expected " +
                                    std::to_string(nodes));
}

double mean_weight(const std::vector<double>& mass) {
    return 9.81 * std::accumulate(mass.begin(), mass.end(), 0.0) / double(mass.size());
}

/// Velocities of midpoints by impulses on ghost nodes that change the velocities of these by `change`.
Points velocity_change(const Motion& motion, const Points& change) {
    const auto& ghost = motion.cloth.midpoints.ghost;
    Eigen::VectorXd mobility(ghost.cols());
    for (int e = 0; e < int(mobility.size()); ++e)
        mobility[e] = motion.problem.held[e] ? 0 : 1 / motion.cloth.midpoints.mass[e];
    const Eigen::SparseMatrix<double> of_ghosts = ghost * mobility.asDiagonal() * ghost.transpose();
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver;
    solver.setShift(immovable * of_ghosts.diagonal().mean());
    solver.compute(of_ghosts);
    using Coordinates = Eigen::Matrix<double, Eigen::Dynamic, 3>;
    Coordinates wanted(change.size(), 3);
    for (std::size_t i = 0; i < change.size(); ++i)
        wanted.row(i) = change[i];
    Coordinates impulse = Coordinates::Zero(change.size(), 3);
    for (int refinement = 0; refinement < 3; ++refinement) {
        const Coordinates left = wanted - of_ghosts * impulse;
        impulse += solver.solve(left);
    }
    const Coordinates velocity = mobility.asDiagonal() * (ghost.transpose() * impulse);
    Points result(motion.x.size());
    for (std::size_t e = 0; e < result.size(); ++e)
        result[e] = velocity.row(e);
    return result;
}

} // namespace

Motion start_motion(NonconformingCloth cloth, const Garment& garment, const Points& nodes,
                    const std::vector<char>& held, const std::vector<GhostSpring>& springs) {
    need_nodes(cloth, nodes, "start positions");
    Motion m;
    m.cloth = std::move(cloth);
    m.problem = problem_of(m.cloth, Vec3::Zero(), {}, springs);
    if (!held.empty()) m.problem.held = held;
    m.saddle = std::make_unique<Saddle>(m.problem.stiffness, m.problem.bars, m.problem.held);
    m.x = midpoints_of(garment, nodes);
    m.isometric = make_isometric(*m.saddle, m.problem, m.x);
    m.velocity.assign(m.x.size(), Vec3::Zero());
    m.candidate = m.x;
    m.candidate_velocity = m.velocity;
    return m;
}

MotionStep try_step(Motion& motion, const Vec3& gravity, const Points& ghost_forces,
                    const MotionOptions& options) {
    if (!ghost_forces.empty()) need_nodes(motion.cloth, ghost_forces, "forces");
    const double h = options.time_step;
    const Formula f = formula_of(motion, h);
    const std::vector<double>& mass = motion.cloth.midpoints.mass;
    IsometricProblem problem = motion.problem;
    const Points pushed = from_ghost_nodes(motion.cloth.midpoints, ghost_forces);
    for (std::size_t i = 0; i < mass.size(); ++i)
        problem.load[i] += mass[i] * gravity + pushed[i];
    add_inertia(mass, f, options.damping, problem);

    motion.candidate = motion.x;
    for (std::size_t i = 0; i < mass.size(); ++i)
        if (!problem.held[i]) motion.candidate[i] += h * motion.velocity[i];
    IsometricOptions newton;
    newton.tolerance = options.tolerance * mean_weight(mass);
    newton.strain = options.strain;
    newton.max_iterations = options.max_iterations;
    const IsometricResult r =
        settle_isometric(*motion.saddle, problem, motion.candidate, newton, motion.tension);
    motion.tension = r.tension;

    MotionStep step{r.end, r.iterations, r.factorisations,
                    ghost_nodes(motion.cloth.midpoints, motion.candidate)};
    const Points from = ghost_nodes(motion.cloth.midpoints, motion.x);
    for (std::size_t i = 0; i < from.size(); ++i)
        step.ghost_velocity[i] = (step.ghost_velocity[i] - from[i]) / h;
    motion.candidate_velocity.resize(mass.size());
    for (std::size_t i = 0; i < mass.size(); ++i)
        motion.candidate_velocity[i] = f.rate * (motion.candidate[i] - f.known[i]);
    return step;
}

void finish_step(Motion& motion, const MotionOptions& options) {
    motion.x_before = std::move(motion.x);
    motion.velocity_before = std::move(motion.velocity);
    motion.x = motion.candidate;
    motion.velocity = motion.candidate_velocity;
    motion.last_step = options.time_step;
}

void finish_step(Motion& motion, const MotionOptions& options, const Points& ghost_velocity) {
    need_nodes(motion.cloth, ghost_velocity, "corrected velocities");
    const double h = options.time_step;
    const Points from = ghost_nodes(motion.cloth.midpoints, motion.x);
    Points change = ghost_nodes(motion.cloth.midpoints, motion.candidate);
    double most = 0;
    for (std::size_t i = 0; i < change.size(); ++i) {
        change[i] = ghost_velocity[i] - (change[i] - from[i]) / h;
        most = std::max(most, change[i].norm());
    }
    if (most > 0) {
        const Points by = velocity_change(motion, change);
        for (std::size_t i = 0; i < by.size(); ++i) {
            motion.candidate[i] += h * by[i];
            motion.candidate_velocity[i] += by[i];
        }
    }
    finish_step(motion, options);
}

double kinetic_energy(const Motion& motion) {
    double sum = 0;
    for (std::size_t i = 0; i < motion.x.size(); ++i)
        sum += 0.5 * motion.cloth.midpoints.mass[i] * motion.velocity[i].squaredNorm();
    return sum;
}

Vec3 momentum(const Motion& motion) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < motion.x.size(); ++i)
        sum += motion.cloth.midpoints.mass[i] * motion.velocity[i];
    return sum;
}

} // namespace toile

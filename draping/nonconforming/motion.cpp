// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/nonconforming/motion.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>

namespace toile {

namespace {

constexpr double unfelt = 1e-9; // m/s, by which ghost nodes are moved without a jump of the motion: held ones are, by rounding (1e-12)

constexpr double immovable = 1e-10; // share of the mean mobility below which a ghost node cannot be moved

// A bar is drawn in more slowly when contact has left less than this share of what it was to be drawn in by.
constexpr double left_of_it = 0.5, slower = 0.5, faster = 1.2, least_drawn = 1e-5;

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

/// The misfit of every bar that a step is to end with, m.
Eigen::VectorXd to_be_left(const Motion& m) {
    Eigen::VectorXd c = misfit(m.cloth.bars, m.x);
    for (std::size_t i = 0; i < m.cloth.bars.size(); ++i) {
        const double most = m.drawn_in[i] * m.cloth.bars[i].length;
        c[i] -= std::clamp(c[i], -most, most);
    }
    return c;
}

/// Bars that contact has kept from being drawn in wait for it.
void adapt_drawing(Motion& m, const MotionOptions& o) {
    const Eigen::VectorXd from = misfit(m.cloth.bars, m.x).cwiseAbs(), end = misfit(m.cloth.bars, m.candidate).cwiseAbs();
    for (std::size_t i = 0; i < m.drawn_in.size(); ++i) {
        const double wanted = std::min(from[i], m.drawn_in[i] * m.cloth.bars[i].length);
        const bool kept = end[i] > from[i] - left_of_it * wanted;
        m.drawn_in[i] *= kept ? slower : faster;
        m.drawn_in[i] = std::clamp(m.drawn_in[i], std::min(least_drawn, o.drawn_in), o.drawn_in);
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

} // namespace

Motion place_motion(NonconformingCloth cloth, const Garment& garment, const Points& nodes, const MotionHolds& holds) {
    need_nodes(cloth, nodes, "start positions");
    Motion m;
    m.cloth = std::move(cloth);
    m.problem = problem_of(m.cloth, Vec3::Zero(), {}, holds.springs);
    if (!holds.midpoints.empty()) m.problem.held = holds.midpoints;
    std::vector<HeldPlace> places;
    for (int node : holds.nodes) {
        places.emplace_back();
        for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator e(m.cloth.midpoints.ghost, node); e; ++e)
            places.back().emplace_back(int(e.col()), e.value());
    }
    m.solver = std::make_unique<StepSolver>(m.problem, places);
    m.impulses = std::make_unique<GhostImpulses>(m.cloth.midpoints, m.problem.held);
    m.x = m.candidate = midpoints_of(garment, nodes);
    m.velocity.assign(m.x.size(), Vec3::Zero());
    m.candidate_velocity = m.velocity;
    return m;
}

Motion start_motion(NonconformingCloth cloth, const Garment& garment, const Points& nodes, const MotionHolds& holds) {
    Motion m = place_motion(std::move(cloth), garment, nodes, holds);
    Saddle saddle(m.problem.stiffness, m.problem.bars, m.problem.held);
    m.isometric = make_isometric(saddle, m.problem, m.x);
    m.candidate = m.x;
    return m;
}

MotionStep try_step(Motion& motion, const Vec3& gravity, const GhostLoads& loads, const MotionOptions& options) {
    if (!loads.forces.empty()) need_nodes(motion.cloth, loads.forces, "forces");
    const double h = options.time_step;
    if (motion.drawn_in.empty()) motion.drawn_in.assign(motion.cloth.bars.size(), options.drawn_in);
    const Formula f = formula_of(motion, h);
    const std::vector<double>& mass = motion.cloth.midpoints.mass;
    // Inertia is a spring to where the midpoints would go without force, damping one to where they come from.
    const double inertia = f.rate * (f.rate + options.damping);
    StepProblem problem{motion.problem, motion.cloth.midpoints, from_ghost_nodes(motion.cloth.midpoints, loads.forces),
                        {}, loads.stiffness, motion.x, to_be_left(motion)};
    for (std::size_t i = 0; i < mass.size(); ++i) {
        problem.inertia.push_back(inertia * mass[i]);
        problem.load[i] += motion.problem.load[i] + mass[i] * (gravity + inertia * f.known[i] + f.rate * f.known_velocity[i]);
    }
    motion.candidate = motion.x;
    for (std::size_t i = 0; i < mass.size(); ++i)
        if (!motion.problem.held[i]) motion.candidate[i] += h * motion.velocity[i];
    StepSolverOptions newton;
    newton.tolerance = options.tolerance * mean_weight(mass);
    newton.strain = options.strain;
    newton.max_iterations = options.max_iterations;
    const IsometricResult r = motion.solver->step(problem, motion.candidate, motion.tension, newton);

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
    adapt_drawing(motion, options);
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
        const Points by = motion.impulses->velocities(change);
        for (std::size_t i = 0; i < by.size(); ++i) {
            motion.candidate[i] += h * by[i];
            motion.candidate_velocity[i] += by[i];
        }
    }
    finish_step(motion, options);
    if (most > unfelt) motion.x_before.clear();
}

Points unanswered(Motion& motion, const Points& ghost_forces) {
    need_nodes(motion.cloth, ghost_forces, "forces");
    Points force = from_ghost_nodes(motion.cloth.midpoints, ghost_forces);
    Eigen::VectorXd pulls = Eigen::VectorXd::Zero(3 * Eigen::Index(force.size()));
    if (motion.tension.size() > 0) pulls = motion.solver->pulls(motion.x, motion.tension);
    using Coordinates = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
    const Coordinates bent = motion.problem.stiffness * Eigen::Map<const Coordinates>(motion.x[0].data(), force.size(), 3);
    for (std::size_t e = 0; e < force.size(); ++e)
        force[e] += motion.problem.load[e] - pulls.segment<3>(3 * e) - bent.row(e).transpose();
    return force;
}

void replace(Motion& motion, const Garment& garment, const Points& nodes, const Points& velocity) {
    need_nodes(motion.cloth, nodes, "positions");
    need_nodes(motion.cloth, velocity, "velocities");
    motion.x = motion.candidate = midpoints_of(garment, nodes);
    motion.velocity = motion.candidate_velocity = midpoints_of(garment, velocity);
    motion.x_before.clear();
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

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What every energy must stand: derivatives by finite differences, rigid motions, a positive projected
// Hessian.

#include "draping/algebra/block_matrix.h"
#include "draping/energy/bend.h"
#include "draping/energy/strain_limit.h"
#include "draping/energy/stretch.h"
#include "tests/support/flat_mesh.h"

#include <catch2/catch.hpp>

#include <Eigen/Dense>

#include <functional>
#include <memory>

namespace toile::test {

struct TestedEnergy {
    std::string name;
    std::function<double(const Points&)> value;
    std::function<void(const Points&, Points&)> gradient;
    std::function<Eigen::MatrixXd(const Points&, HessianKind)> hessian; ///< assembled over all nodes
};

struct TestedState {
    std::string name;
    Points x;
    double step = 2e-7; ///< m, of differences of the gradient; a small share of what the energy changes over
};

/// What is to be asked of an energy at a state.
struct EnergyCase {
    TestedEnergy energy;
    TestedState state;
    bool rigid = true; ///< does not change when everything is moved; energies tied to places in space do
};

template <class Nodes, class Block>
void add_block(Eigen::MatrixXd& all, const Nodes& nodes, int count, const Block& block) {
    for (int a = 0; a < count; ++a)
        for (int b = 0; b < count; ++b)
            all.block<3, 3>(3 * nodes[a], 3 * nodes[b]) += block.template block<3, 3>(3 * a, 3 * b);
}

inline BlockMatrix full_matrix(int n) {
    std::vector<std::pair<int, int>> pairs;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < i; ++j)
            pairs.emplace_back(i, j);
    return BlockMatrix(n, pairs);
}

inline Eigen::MatrixXd dense(int rows,
                             const std::function<void(const Eigen::VectorXd&, Eigen::VectorXd&)>& multiply) {
    Eigen::MatrixXd all(rows, rows);
    for (int k = 0; k < rows; ++k) {
        Eigen::VectorXd y;
        multiply(Eigen::VectorXd::Unit(rows, k), y);
        all.col(k) = y;
    }
    return all;
}

inline Eigen::MatrixXd dense(const BlockMatrix& m) {
    return dense(m.rows(), [&](const auto& x, auto& y) { m.multiply(x, y); });
}

/// An energy that adds to a flat gradient and to a matrix of blocks.
inline TestedEnergy
block_energy(const std::string& name, const std::function<double(const Points&)>& value,
             const std::function<void(const Points&, Eigen::VectorXd&)>& add_gradient,
             const std::function<void(const Points&, HessianKind, BlockMatrix&)>& add_hessian) {
    return {name, value,
            [=](const Points& x, Points& g) {
                Eigen::VectorXd part = Eigen::VectorXd::Zero(3 * x.size());
                add_gradient(x, part);
                flat(g) += part;
            },
            [=](const Points& x, HessianKind kind) {
                BlockMatrix h = full_matrix(int(x.size()));
                add_hessian(x, kind, h);
                return dense(h);
            }};
}

inline TestedEnergy model_energy(const std::string& name, const std::shared_ptr<const Energy>& model) {
    return block_energy(
        name, [model](const Points& x) { return model->value(x); },
        [model](const Points& x, Eigen::VectorXd& g) { model->add_gradient(x, g); },
        [model](const Points& x, HessianKind kind, BlockMatrix& h) { model->add_hessian(x, kind, h); });
}

inline TestedEnergy stretch_energy(const std::string& name, const std::vector<StretchElement>& elements) {
    return {name, [elements](const Points& x) { return stretch_value(elements, x); },
            [elements](const Points& x, Points& g) { stretch_gradient(elements, x, g); },
            [elements](const Points& x, HessianKind kind) {
                Eigen::MatrixXd all = Eigen::MatrixXd::Zero(3 * x.size(), 3 * x.size());
                StretchHessian block;
                for (const StretchElement& e : elements) {
                    stretch_hessian(e, x, kind, block);
                    add_block(all, e.patch.nodes, e.patch.count, block);
                }
                return all;
            }};
}

inline TestedEnergy strain_limit_energy(const std::string& name, const std::vector<StrainLimit>& limits) {
    return {name, [limits](const Points& x) { return strain_limit_value(limits, x); },
            [limits](const Points& x, Points& g) { strain_limit_gradient(limits, x, g); },
            [limits](const Points& x, HessianKind kind) {
                Eigen::MatrixXd all = Eigen::MatrixXd::Zero(3 * x.size(), 3 * x.size());
                Eigen::Matrix<double, 9, 9> block;
                for (const StrainLimit& l : limits)
                    if (strain_limit_hessian(l, x, kind, block)) add_block(all, l.nodes, 3, block);
                return all;
            }};
}

inline TestedEnergy bend_energy(const std::string& name, const Bending& bending) {
    return {name, [bending](const Points& x) { return bend_value(bending, x); },
            [bending](const Points& x, Points& g) { bend_gradient(bending, x, g); },
            [bending](const Points& x, HessianKind) {
                Eigen::MatrixXd all = Eigen::MatrixXd::Zero(3 * x.size(), 3 * x.size());
                const Eigen::MatrixXd k = bending.stiffness;
                for (int i = 0; i < k.rows(); ++i)
                    for (int j = 0; j < k.cols(); ++j)
                        all.block<3, 3>(3 * i, 3 * j) = k(i, j) * Mat3::Identity();
                return all;
            }};
}

/// Flat and stretched, compressed, wavy, rough, folded flat onto itself, and one with a triangle all but
/// collapsed. Strains stay below 0.3 except where the name says otherwise.
inline std::vector<TestedState> tested_states(const FlatMesh& mesh) {
    std::vector<TestedState> states;
    const auto add = [&](const std::string& name, const std::function<Vec3(const Vec2&, Random&)>& map) {
        Random random(17);
        Points x;
        for (const Vec2& p : mesh.points)
            x.push_back(map(p, random));
        states.push_back({name, x, 2e-7});
    };
    add("stretched", [](const Vec2& p, Random& r) -> Vec3 {
        return Vec3(1.04 * p.x() + 0.1 * p.y(), 1.03 * p.y(), 0) + r.vec3(2e-4);
    });
    add("compressed", [](const Vec2& p, Random& r) -> Vec3 {
        return Vec3(0.9 * p.x() + 0.2 * p.y(), 0.95 * p.y(), 0) + r.vec3(2e-4);
    });
    add("wavy", [](const Vec2& p, Random& r) -> Vec3 {
        return Vec3(p.x(), p.y(), 0.01 * std::sin(30 * p.x() + 10 * p.y())) + r.vec3(1e-3);
    });
    add("rough", [](const Vec2& p, Random& r) -> Vec3 { return Vec3(p.x(), p.y(), 0) + r.vec3(4e-3); });
    add("folded", [](const Vec2& p, Random& r) -> Vec3 {
        return Vec3(p.x() < 0.15 ? p.x() : 0.3 - p.x(), p.y(), 0) + r.vec3(1e-3);
    });
    states.push_back(states[2]);
    states.back().name = "collapsed";
    Points& x = states.back().x;
    const Triangle& t = mesh.triangles[mesh.triangles.size() / 2];
    x[t[2]] = 0.7 * x[t[0]] + 0.3 * x[t[1]] + Vec3(0, 0, 1e-7);
    return states;
}

inline Eigen::VectorXd gradient_of(const TestedEnergy& energy, const Points& x) {
    Points g(x.size(), Vec3::Zero());
    energy.gradient(x, g);
    return flat(g);
}

inline Points moved(const Points& x, const Eigen::VectorXd& d, double step) {
    Points y = x;
    flat(y) += step * d;
    return y;
}

/// Richardson-extrapolated central differences along random directions against the derivatives given.
inline void check_derivatives(const TestedEnergy& energy, const TestedState& state) {
    const Eigen::VectorXd g = gradient_of(energy, state.x);
    const Eigen::MatrixXd h = energy.hessian(state.x, HessianKind::exact);
    REQUIRE(g.norm() > 0);
    CHECK((h - h.transpose()).cwiseAbs().maxCoeff() <= 1e-12 * h.cwiseAbs().maxCoeff());
    Random random(3);
    for (int trial = 0; trial < 4; ++trial) {
        Eigen::VectorXd d(g.size());
        for (double& c : d)
            c = random.in(-1, 1);
        const double step = state.step;
        const auto slope = [&](double s) {
            return (energy.value(moved(state.x, d, s)) - energy.value(moved(state.x, d, -s))) / (2 * s);
        };
        const auto bend = [&](double s) -> Eigen::VectorXd {
            return (gradient_of(energy, moved(state.x, d, s)) - gradient_of(energy, moved(state.x, d, -s))) /
                   (2 * s);
        };
        const double difference = (4 * slope(10 * step) - slope(20 * step)) / 3;
        INFO("difference " << difference << " derivative " << g.dot(d));
        CHECK(std::abs(difference - g.dot(d)) < 1e-5 * g.norm() * d.norm() / std::sqrt(double(d.size())));
        const Eigen::VectorXd second = (4 * bend(step) - bend(2 * step)) / 3;
        CHECK((second - h * d).norm() < 1e-5 * (h * d).norm());
        CHECK(second != h * d); // a check that compared a thing with itself would pass
    }
}

inline void check_invariance(const TestedEnergy& energy, const TestedState& state) {
    const Mat3 turn = Eigen::AngleAxisd(2.2, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
    Points moved = state.x;
    for (Vec3& p : moved)
        p = turn * p + Vec3(0.4, -1, 0.2);
    CHECK(energy.value(moved) == Approx(energy.value(state.x)).epsilon(1e-9));
    const Eigen::VectorXd g = gradient_of(energy, state.x);
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    double size = 0;
    for (std::size_t i = 0; i < state.x.size(); ++i) {
        const Vec3 gi = g.segment<3>(3 * i);
        force += gi;
        torque += state.x[i].cross(gi);
        size += gi.norm();
    }
    CHECK(force.norm() < 1e-11 * size);
    CHECK(torque.norm() < 1e-11 * size);
}

inline void check_projection(const TestedEnergy& energy, const TestedState& state) {
    const Eigen::MatrixXd h = energy.hessian(state.x, HessianKind::projected);
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(h, Eigen::EigenvaluesOnly).eigenvalues();
    CHECK(values[0] > -1e-10 * values[values.size() - 1]);
}

inline void check_energy(const EnergyCase& c) {
    INFO(c.energy.name << ", " << c.state.name);
    REQUIRE(std::isfinite(c.energy.value(c.state.x)));
    check_derivatives(c.energy, c.state);
    check_projection(c.energy, c.state);
    if (c.rigid) check_invariance(c.energy, c.state);
}

} // namespace toile::test

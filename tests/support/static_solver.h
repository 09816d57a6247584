// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A small static solver for validation and bake-offs. The product's own is elsewhere; this one is to be
// simple enough to be believed: exact Hessian, shifted until it is positive, steps that lower the energy.

#include "draping/energy/bend.h"
#include "draping/energy/stretch.h"

#include <Eigen/CholmodSupport>

#include <functional>
#include <memory>

namespace toile::test {

using Entries = std::vector<Eigen::Triplet<double>>;

/// A share of the energy over all freedoms: three per node, then whatever a method adds.
struct Term {
    std::function<double(const Eigen::VectorXd&)> value;
    std::function<void(const Eigen::VectorXd&, Eigen::VectorXd&)> add_gradient;
    std::function<void(const Eigen::VectorXd&, HessianKind, Entries&)> add_hessian;
};

/// Freedom i is sign[i] * unknown[of[i]] + fixed[i]; of[i] < 0: fixed.
struct Freedoms {
    std::vector<int> of;
    std::vector<double> sign, fixed;
    int unknowns = 0;

    explicit Freedoms(const Eigen::VectorXd& start)
        : of(start.size()), sign(start.size(), 1), fixed(start.size(), 0) {
        for (int i = 0; i < int(of.size()); ++i)
            of[i] = unknowns++;
        for (int i = 0; i < int(of.size()); ++i)
            fixed[i] = 0;
    }
    void hold(int i, double value) {
        of[i] = -1;
        fixed[i] = value;
    }
    /// Freedom i mirrors freedom j, which must not be tied itself.
    void tie(int i, int j, double s) {
        of[i] = of[j];
        sign[i] = s * sign[j];
        fixed[i] = s * fixed[j];
    }
    /// Numbers the unknowns anew after freedoms were held and tied.
    void number() {
        std::vector<int> name(of.size(), -1);
        unknowns = 0;
        for (int& o : of) {
            if (o < 0) continue;
            if (name[o] < 0) name[o] = unknowns++;
            o = name[o];
        }
    }
    Eigen::VectorXd expand(const Eigen::VectorXd& y) const {
        Eigen::VectorXd q(of.size());
        for (std::size_t i = 0; i < of.size(); ++i)
            q[i] = fixed[i] + (of[i] < 0 ? 0 : sign[i] * y[of[i]]);
        return q;
    }
    Eigen::VectorXd gather(const Eigen::VectorXd& q) const {
        Eigen::VectorXd y = Eigen::VectorXd::Zero(unknowns);
        for (std::size_t i = 0; i < of.size(); ++i)
            if (of[i] >= 0) y[of[i]] = sign[i] * (q[i] - fixed[i]);
        return y;
    }
    Eigen::VectorXd reduce(const Eigen::VectorXd& g) const {
        Eigen::VectorXd r = Eigen::VectorXd::Zero(unknowns);
        for (std::size_t i = 0; i < of.size(); ++i)
            if (of[i] >= 0) r[of[i]] += sign[i] * g[i];
        return r;
    }
    Eigen::SparseMatrix<double> reduce(const Entries& entries) const {
        Entries reduced;
        reduced.reserve(entries.size());
        for (const auto& e : entries)
            if (of[e.row()] >= 0 && of[e.col()] >= 0)
                reduced.emplace_back(of[e.row()], of[e.col()], e.value() * sign[e.row()] * sign[e.col()]);
        Eigen::SparseMatrix<double> h(unknowns, unknowns);
        h.setFromTriplets(reduced.begin(), reduced.end());
        return h;
    }
};

struct StaticResult {
    Eigen::VectorXd q;
    double residual = 0; ///< largest reduced gradient entry over the largest load
    int iterations = 0;
    bool converged = false;
    bool stable = false; ///< the exact Hessian is positive definite at the end
};

struct StaticOptions {
    double tolerance = 1e-7;
    int max_iterations = 400;
};

inline Points points_of(const Eigen::VectorXd& q, int nodes) {
    Points x(nodes);
    for (int i = 0; i < nodes; ++i)
        x[i] = q.segment<3>(3 * i);
    return x;
}

inline bool positive_definite(const Eigen::SparseMatrix<double>& matrix) {
    Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<double>> solver;
    solver.cholmod().print = 0;
    solver.compute(matrix);
    return solver.info() == Eigen::Success;
}

/// Minimum of the terms minus load . q near `start`.
inline StaticResult solve_static(const std::vector<Term>& terms, const Eigen::VectorXd& load,
                                 const Freedoms& freedoms, const Eigen::VectorXd& start,
                                 const StaticOptions& options = {}) {
    StaticResult result;
    Eigen::VectorXd y = freedoms.gather(start);
    const auto energy = [&](const Eigen::VectorXd& at) {
        const Eigen::VectorXd q = freedoms.expand(at);
        double e = -load.dot(q - start);
        for (const Term& term : terms)
            e += term.value(q);
        return e;
    };
    const double scale = std::max(load.cwiseAbs().maxCoeff(), 1e-300);
    double shift = 0, current = energy(y);
    Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<double>> solver;
    solver.cholmod().print = 0; // it reports what is asked of it on purpose: whether a matrix is positive
    bool analysed = false;
    for (; result.iterations <= options.max_iterations; ++result.iterations) {
        const Eigen::VectorXd q = freedoms.expand(y);
        Eigen::VectorXd full = -load;
        for (const Term& term : terms)
            term.add_gradient(q, full);
        const Eigen::VectorXd g = freedoms.reduce(full);
        result.residual = g.cwiseAbs().maxCoeff() / scale;
        Entries entries;
        for (const Term& term : terms)
            term.add_hessian(q, HessianKind::exact, entries);
        const Eigen::SparseMatrix<double> h = freedoms.reduce(entries);
        const double diagonal = h.diagonal().cwiseAbs().mean();
        if (!analysed) solver.analyzePattern(h), analysed = true;
        if (result.residual < options.tolerance) {
            solver.setShift(0);
            solver.factorize(h);
            result.converged = true;
            result.stable = solver.info() == Eigen::Success;
            break;
        }
        bool moved = false;
        for (int trial = 0; trial < 60 && !moved; ++trial) {
            solver.setShift(shift * diagonal);
            solver.factorize(h);
            if (solver.info() == Eigen::Success) {
                const Eigen::VectorXd d = solver.solve(-g);
                const double next = energy(y + d), expected = g.dot(d) / 2;
                // Below the rounding of the energy itself, trust the step.
                if (next <= current + 0.1 * expected || std::abs(expected) < 1e-13 * std::abs(current)) {
                    y += d;
                    current = next;
                    shift = shift < 1e-12 ? 0 : shift / 5;
                    moved = true;
                    break;
                }
            }
            shift = std::max(4 * shift, 1e-10);
        }
        if (!moved) break;
    }
    result.q = freedoms.expand(y);
    return result;
}

inline Term stretch_term(const std::vector<StretchElement>& elements, int nodes) {
    return {[=](const Eigen::VectorXd& q) { return stretch_value(elements, points_of(q, nodes)); },
            [=](const Eigen::VectorXd& q, Eigen::VectorXd& g) {
                Points part(nodes, Vec3::Zero());
                stretch_gradient(elements, points_of(q, nodes), part);
                g.head(3 * nodes) += flat(part);
            },
            [=](const Eigen::VectorXd& q, HessianKind kind, Entries& entries) {
                const Points x = points_of(q, nodes);
                StretchHessian h;
                for (const StretchElement& e : elements) {
                    stretch_hessian(e, x, kind, h);
                    for (int a = 0; a < 3 * e.patch.count; ++a)
                        for (int b = 0; b < 3 * e.patch.count; ++b)
                            entries.emplace_back(3 * e.patch.nodes[a / 3] + a % 3,
                                                 3 * e.patch.nodes[b / 3] + b % 3, h(a, b));
                }
            }};
}

inline Term bend_term(const Bending& bending, int nodes) {
    return {[=](const Eigen::VectorXd& q) { return bend_value(bending, points_of(q, nodes)); },
            [=](const Eigen::VectorXd& q, Eigen::VectorXd& g) {
                Points part(nodes, Vec3::Zero());
                bend_gradient(bending, points_of(q, nodes), part);
                g.head(3 * nodes) += flat(part);
            },
            [=](const Eigen::VectorXd&, HessianKind, Entries& entries) {
                for (int j = 0; j < nodes; ++j)
                    for (Eigen::SparseMatrix<double>::InnerIterator e(bending.stiffness, j); e; ++e)
                        for (int i = 0; i < 3; ++i)
                            entries.emplace_back(3 * e.row() + i, 3 * e.col() + i, e.value());
            }};
}

/// Any model of cloth.
inline Term model_term(const std::shared_ptr<const Energy>& model, int nodes) {
    std::vector<std::pair<int, int>> pairs;
    model->couplings(pairs);
    const auto matrix = std::make_shared<BlockMatrix>(nodes, pairs);
    return {[=](const Eigen::VectorXd& q) { return model->value(points_of(q, nodes)); },
            [=](const Eigen::VectorXd& q, Eigen::VectorXd& g) {
                Eigen::VectorXd part = Eigen::VectorXd::Zero(3 * nodes);
                model->add_gradient(points_of(q, nodes), part);
                g.head(3 * nodes) += part;
            },
            [=](const Eigen::VectorXd& q, HessianKind kind, Entries& entries) {
                matrix->set_zero();
                model->add_hessian(points_of(q, nodes), kind, *matrix);
                for (int j = 0; j < matrix->rows(); ++j)
                    for (int k = matrix->scalar_columns()[j]; k < matrix->scalar_columns()[j + 1]; ++k) {
                        const int i = matrix->scalar_rows()[k];
                        entries.emplace_back(i, j, matrix->values()[k]);
                        if (i != j) entries.emplace_back(j, i, matrix->values()[k]);
                    }
            }};
}

} // namespace toile::test

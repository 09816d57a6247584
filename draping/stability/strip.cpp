// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/stability/strip.h"

#include "geometry/random.h"

#include <Eigen/Eigenvalues>

#include <cmath>

namespace toile {

namespace {

constexpr double bend = 1e-5;         // N m
constexpr double jitter = 0.2;        // of the shortest edge
constexpr double rounding = 1e-11;    // of the largest eigenvalue
constexpr double edge = strip_length / strip_rows;

SheetMesh strip_mesh(const StabilityMesh& mesh) {
    const SheetMesh sheet = sheet_mesh(mesh.kind, strip_length, 3 * edge, edge);
    return mesh.seed > 0 ? jittered(sheet, jitter, unsigned(mesh.seed)) : sheet;
}

SceneCloth cloth_of(const SheetMesh& sheet, double stiffness) {
    SceneCloth cloth;
    cloth.garment = sheet_garment(sheet);
    cloth.fabrics = {plain_cloth(stiffness * bend / (strip_length * strip_length), bend)};
    for (std::size_t i = 0; i < sheet.points.size(); ++i) {
        cloth.x.push_back({sheet.points[i].x(), 0, -sheet.points[i].y()});
        if (std::abs(sheet.points[i].x()) < 1e-9) cloth.held.push_back(int(i));
    }
    return cloth;
}

} // namespace

SceneCloth stability_strip(const StabilityMesh& mesh, double stiffness) { return cloth_of(strip_mesh(mesh), stiffness); }

SceneCloth stability_arms(const StabilityMesh& mesh, double stiffness) { return cloth_of(with_mirror_image(strip_mesh(mesh)), stiffness); }

void hold_far_end(SceneCloth& cloth) {
    for (std::size_t i = 0; i < cloth.x.size(); ++i)
        if (cloth.x[i].x() > strip_length - 1e-9) cloth.held.push_back(int(i));
}

std::vector<char> held_nodes(const SceneCloth& cloth) {
    std::vector<char> held(cloth.x.size(), 0);
    for (const int i : cloth.held) held[i] = 1;
    return held;
}

void shake(Points& x, double size) {
    std::mt19937_64 random(1);
    for (double& c : flat(x)) c += size * next_signed(random);
}

double lowest_eigenvalue(NodeProblem& problem, const Points& x) {
    bool changed = false;
    problem.arrive(x);
    const BlockMatrix& k = problem.hessian(x, true, changed);
    std::vector<Eigen::Index> free;
    for (Eigen::Index c = 0; c < problem.mass().size(); ++c)
        if (!problem.pinned()[c / 3]) free.push_back(c);
    const Eigen::VectorXd scale = problem.mass().cwiseSqrt().cwiseInverse();
    Eigen::MatrixXd all(free.size(), free.size());
    for (std::size_t j = 0; j < free.size(); ++j) {
        Eigen::VectorXd column;
        k.multiply(Eigen::VectorXd::Unit(scale.size(), free[j]), column);
        for (std::size_t i = 0; i < free.size(); ++i) all(i, j) = scale[free[i]] * column[free[i]] * scale[free[j]];
    }
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(all, Eigen::EigenvaluesOnly).eigenvalues();
    return std::abs(values.minCoeff()) < rounding * values.maxCoeff() ? 0 : values.minCoeff();
}

} // namespace toile

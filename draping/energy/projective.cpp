// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/projective.h"

#include "draping/energy/grain.h"

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

constexpr double least_share = 0.1; // of a yarn's stiffness that is left to it beside what shear adds

Vec3 image(const DirectionSpring& s, const Points& x) {
    return s.shape[0] * x[s.nodes[0]] + s.shape[1] * x[s.nodes[1]] + s.shape[2] * x[s.nodes[2]];
}

} // namespace

ProjectiveCloth::ProjectiveCloth(const Garment& garment, const std::vector<Fabric>& fabrics)
    : bending_(make_bending(garment, fabrics)) {
    for (std::size_t t = 0; t < garment.triangles.size(); ++t) {
        const Mat2& rest = garment.rest.edges[t];
        const Fabric& f = fabrics[garment.panel_of_triangle[t]];
        const double area = rest_area(rest);
        const GrainShape shape = grain_shape(rest);
        const double weft = std::max(f.stretch_weft - f.shear, least_share * f.stretch_weft);
        const double warp = std::max(f.stretch_warp - f.shear, least_share * f.stretch_warp);
        const double half = std::sqrt(0.5);
        for (const auto& [direction, stiffness] :
             {std::pair(Vec2(1, 0), weft), {Vec2(0, 1), warp}, {Vec2(half, half), 2 * f.shear}, {Vec2(half, -half), 2 * f.shear}})
            springs_.push_back({garment.nodes(int(t)), shape * direction, stiffness * area});
    }
}

double ProjectiveCloth::value(const Points& x) const {
    double sum = bend_value(bending_, x);
    for (const DirectionSpring& s : springs_) sum += 0.5 * s.stiffness * std::pow(image(s, x).norm() - 1, 2);
    return sum;
}

void ProjectiveCloth::add_gradient(const Points& x, Eigen::VectorXd& g) const {
    toile::add_gradient(bending_, x, g);
    for (const DirectionSpring& s : springs_) {
        const Vec3 w = image(s, x);
        const double length = w.norm();
        if (length == 0) continue; // as near to the sphere in every direction
        const Vec3 off = s.stiffness * (1 - 1 / length) * w;
        for (int k = 0; k < 3; ++k) g.segment<3>(3 * s.nodes[k]) += s.shape[k] * off;
    }
}

void ProjectiveCloth::couplings(std::vector<std::pair<int, int>>& pairs) const {
    for (const DirectionSpring& s : springs_)
        for (int k = 0; k < 3; ++k) pairs.emplace_back(s.nodes[k], s.nodes[(k + 1) % 3]);
    toile::couplings(bending_, pairs);
}

template <class Block>
void ProjectiveCloth::add_elements(BlockMatrix& h, const Block& block) const {
    toile::add_hessian(bending_, h);
    for (const DirectionSpring& s : springs_) {
        const Mat3 along = block(s);
        Eigen::Matrix<double, 9, 9> all;
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l) all.block<3, 3>(3 * k, 3 * l) = s.shape[k] * s.shape[l] * along;
        h.add_element(s.nodes, all);
    }
}

void ProjectiveCloth::add_hessian(const Points& x, HessianKind kind, BlockMatrix& h) const {
    add_elements(h, [&](const DirectionSpring& s) -> Mat3 {
        const Vec3 w = image(s, x);
        const double length = w.norm();
        if (length == 0) return Mat3::Zero();
        double turning = 1 - 1 / length;
        if (kind == HessianKind::projected) turning = std::max(turning, 0.0);
        const Mat3 along = w * w.transpose() / (length * length);
        return s.stiffness * (along + turning * (Mat3::Identity() - along));
    });
}

void ProjectiveCloth::add_bound(BlockMatrix& h) const {
    add_elements(h, [](const DirectionSpring& s) -> Mat3 { return s.stiffness * Mat3::Identity(); });
}

} // namespace toile

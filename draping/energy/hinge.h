// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The angle between the two triangles at an edge, and the bending of Baraff and Witkin (Large Steps in Cloth Simulation,
// 1998) that stands on it.

#include "draping/energy/constraint.h"
#include "draping/fabric/fabric.h"
#include "sewing/garment.h"

namespace toile {

/// An edge with two triangles: nodes 0 and 1 its ends, in the order in which the first triangle goes round, 2 and 3 the
/// far corners of the first and the second triangle.
struct Hinge {
    int edge = 0;
    std::array<int, 2> triangles{};
    std::array<int, 4> nodes{};
};

/// Every edge with exactly two triangles, in the order of the edges.
std::vector<Hinge> hinges_of(const EdgeTable& edges, const std::vector<Triangle>& triangles);
inline std::vector<Hinge> hinges_of(const Garment& garment) { return hinges_of(garment.edges, node_triangles(garment)); }

/// The angle by which the second triangle is turned out of the plane of the first, in (-pi, pi], 0 flat, positive where
/// their fronts turn away from each other; and its derivatives by the nodes of the hinge. Triangles must have area.
struct HingeAngle {
    double value = 0;
    std::array<Vec3, 4> gradient;
};
HingeAngle hinge_angle(const std::array<Vec3, 4>& x);
/// The same of four nodes, in a hinge's order, among all.
inline std::array<Vec3, 4> hinge_corners(const std::array<int, 4>& nodes, const Points& x) {
    return {x[nodes[0]], x[nodes[1]], x[nodes[2]], x[nodes[3]]};
}
inline HingeAngle hinge_angle(const std::array<int, 4>& nodes, const Points& x) { return hinge_angle(hinge_corners(nodes, x)); }
Eigen::Matrix<double, 12, 12> hinge_hessian(const std::array<Vec3, 4>& x);

/// Bending of one hinge: with kappa = (theta - theta0) / l, l the mean altitude of its two triangles over the edge and A
/// their area, E = 1/2 D kappa^2 A = 1/2 stiffness (theta - theta0)^2.
struct HingeBend {
    std::array<int, 4> nodes{};
    double rest = 0;      ///< rad
    double stiffness = 0; ///< J
};

inline constexpr double crease_width = 2e-3; ///< m, of the cloth that a pressed fold has bent

/// D is the fabric's stiffness for a cylinder across the edge. `fabrics` has one entry per panel; where two panels meet, the
/// mean of both. A crease bends as a strip of the width of a pressed fold does, whatever the mesh: its stiffness is
/// D length / crease_width.
std::vector<HingeBend> make_hinge_bends(const Garment& garment, const std::vector<Fabric>& fabrics);

/// Those of creases alone.
std::vector<HingeBend> make_creases(const Garment& garment, const std::vector<Fabric>& fabrics);

double value(const std::vector<HingeBend>& bends, const Points& x);
void add_gradient(const std::vector<HingeBend>& bends, const Points& x, Eigen::VectorXd& g);
void couplings(const std::vector<HingeBend>& bends, std::vector<std::pair<int, int>>& pairs);
Constraint constraint(const HingeBend& bend, const Points& x); ///< theta - theta0
/// Projected: without the second derivative of the angle.
void add_hessian(const std::vector<HingeBend>& bends, const Points& x, HessianKind kind, BlockMatrix& h);

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The element on which stretch and bend stand: a triangle with the neighbours that tell how it is curved.

#include "draping/energy/unfold.h"

namespace toile {

/// A triangle and its neighbourhood, flat. With x the positions of `nodes` (the triangle's own corners
/// first), q_k = sum_a curve(k, a) x_a is the second derivative of the surface along edge k (opposite corner
/// k) times that edge's rest length squared: a vector, whose length is the edge's turning times its length.
/// Rows of `curve` sum to zero and annihilate every affine map of the rest shape; on a surface whose
/// coordinates are quadratic over the rest plane they are exact, at borders too.
struct Patch {
    static constexpr int max_nodes = 9;
    int count = 0;
    std::array<int, max_nodes> nodes{};
    Eigen::Matrix<double, 3, max_nodes> curve; ///< columns from `count` on are zero
};

/// One patch per triangle of the garment, over its nodes: the quadratic through the corners and the far
/// corners of the three neighbours, unfolded. At a border, or where these six lie near a conic, further nodes
/// are added and fitted by least squares with the corners kept exact. A curvature that no node can show
/// (across a strip one triangle wide) is zero.
std::vector<Patch> make_patches(const Garment& garment);

/// Second derivatives (d2/du2, d2/dv2, d2/dudv) of the quadratic whose second derivatives along the edges,
/// times length squared, are q: the rows of the result times (q_0, q_1, q_2). `edges` as in RestShape.
Mat3 curvature_of_edges(const Mat2& edges);

} // namespace toile

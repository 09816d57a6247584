// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The element on which stretch and bend stand: a triangle with the neighbours that tell how it is curved.

#include "sewing/garment.h"

namespace toile {

/// A triangle and its neighbourhood, flat. With x the positions of `nodes` (the triangle's own corners first),
/// q_k = sum_a curve(k, a) x_a is the second derivative of the surface along edge k (opposite corner k) times that
/// edge's rest length squared: a vector, whose length is the edge's turning times its length.
/// Rows of `curve` sum to zero and annihilate every affine map of the rest shape.
struct Patch {
    static constexpr int max_nodes = 9;
    int count = 0;
    std::array<int, max_nodes> nodes{};
    Eigen::Matrix<double, 3, max_nodes> curve; ///< columns from `count` on are zero
};

/// One patch per triangle of the garment, over its nodes. Neighbours are unfolded over the shared edge into the
/// plane of the triangle; an edge with one or with more than two triangles is a border.
std::vector<Patch> make_patches(const Garment& garment);

} // namespace toile

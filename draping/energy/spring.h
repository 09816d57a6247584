// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Zero-rest-length springs whose pull is capped: stitches between nodes, hooks to places in space. The cap keeps
// a seam that is still far open from tearing at the cloth.

#include "draping/algebra/block_matrix.h"

namespace toile {

/// From node a to the point (1 - r) b0 + r b1.
struct StitchSpring {
    int a = 0;
    std::array<int, 2> b{};
    double r = 0;
    double stiffness = 0; ///< N/m
    double cap = 0;       ///< N

    bool operator==(const StitchSpring&) const = default;
};

/// From a node to a place.
struct HookSpring {
    int node = 0;
    Vec3 place = Vec3::Zero();
    Vec3 axes = Vec3::Ones(); ///< 1 for axes that are held, 0 for free ones
    double stiffness = 0;     ///< N/m
    double cap = 0;           ///< N

    bool operator==(const HookSpring&) const = default;
};

double value(const std::vector<StitchSpring>& springs, const Points& x);
void add_gradient(const std::vector<StitchSpring>& springs, const Points& x, Eigen::VectorXd& g);
void add_hessian(const std::vector<StitchSpring>& springs, const Points& x, BlockMatrix& h);
void couplings(const std::vector<StitchSpring>& springs, std::vector<std::pair<int, int>>& pairs);

double value(const std::vector<HookSpring>& springs, const Points& x);
void add_gradient(const std::vector<HookSpring>& springs, const Points& x, Eigen::VectorXd& g);
void add_hessian(const std::vector<HookSpring>& springs, const Points& x, BlockMatrix& h);

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// An elastic band sewn along a line of nodes: it pulls its line together and never pushes.

#include "draping/algebra/block_matrix.h"

namespace toile {

/// The stretch of a band between two nodes. With e = (length - rest) / rest its tension is stiffness e for
/// e > 0 and nothing below: energy stiffness rest e^2 / 2, once continuously differentiable.
struct ElasticSegment {
    int a = 0, b = 0;
    double rest = 0;      ///< m, relaxed length of the band here, > 0
    double stiffness = 0; ///< N per unit strain

    bool operator==(const ElasticSegment&) const = default;
};

double value(const std::vector<ElasticSegment>& segments, const Points& x);
void add_gradient(const std::vector<ElasticSegment>& segments, const Points& x, Eigen::VectorXd& g);
/// Positive semidefinite as it is.
void add_hessian(const std::vector<ElasticSegment>& segments, const Points& x, BlockMatrix& h);
void couplings(const std::vector<ElasticSegment>& segments, std::vector<std::pair<int, int>>& pairs);

/// (length - rest) / rest; negative where the band is slack.
double strain(const ElasticSegment& segment, const Points& x);

} // namespace toile

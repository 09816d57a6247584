// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What acts on cloth beside the cloth itself and contact.

#include "draping/energy/elastic.h"
#include "draping/energy/spring.h"

namespace toile {

struct Loads {
    double gravity = 0; ///< m/s2 along -y
    std::vector<StitchSpring> stitches;
    std::vector<HookSpring> hooks;
    std::vector<ElasticSegment> elastics;

    bool operator==(const Loads&) const = default;
};

/// `node_mass` in kg.
double value(const Loads& loads, const std::vector<double>& node_mass, const Points& x);
void add_gradient(const Loads& loads, const std::vector<double>& node_mass, const Points& x, Eigen::VectorXd& g);
void add_hessian(const Loads& loads, const Points& x, BlockMatrix& h);
void couplings(const Loads& loads, std::vector<std::pair<int, int>>& pairs);

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/loads.h"

namespace toile {

double value(const Loads& l, const std::vector<double>& node_mass, const Points& x) {
    double sum = value(l.stitches, x) + value(l.hooks, x) + value(l.elastics, x);
    for (std::size_t i = 0; i < x.size(); ++i) sum += node_mass[i] * l.gravity * x[i].y();
    return sum;
}

void add_gradient(const Loads& l, const std::vector<double>& node_mass, const Points& x, Eigen::VectorXd& g) {
    add_gradient(l.stitches, x, g);
    add_gradient(l.hooks, x, g);
    add_gradient(l.elastics, x, g);
    for (std::size_t i = 0; i < x.size(); ++i) g[3 * i + 1] += node_mass[i] * l.gravity;
}

void add_hessian(const Loads& l, const Points& x, BlockMatrix& h) {
    add_hessian(l.stitches, x, h);
    add_hessian(l.hooks, x, h);
    add_hessian(l.elastics, x, h);
}

void couplings(const Loads& l, std::vector<std::pair<int, int>>& pairs) {
    couplings(l.stitches, pairs);
    couplings(l.elastics, pairs);
}

} // namespace toile

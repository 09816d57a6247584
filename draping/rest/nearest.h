// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The nearest shapes that a surface can take to what it is told to be: local minima of the energy of what is prescribed,
// which is what stays frozen in. There may be several, as a cap may be pushed through.

#include "draping/rest/prescribed.h"

#include <cstdint>
#include <functional>

namespace toile {

struct NearestOptions {
    double tolerance = 1e-12; ///< of gradient_measure()
    int max_iterations = 1000;
};

enum class NearestEnd { minimum, saddle, iterations, stalled };

struct NearestShape {
    Points x;
    double energy = 0;   ///< J
    double gradient = 0; ///< its largest component, as the tolerance counts it
    int iterations = 0;
    NearestEnd end = NearestEnd::iterations;
};

/// Gauss and Newton's method with the damping of Levenberg and Marquardt, on a sparse Cholesky; near a minimum with the exact
/// second derivative, with which a saddle is left. `start` has one place per point.
NearestShape nearest_shape(const Prescribed& data, const Points& start, const NearestOptions& options = {});

/// The same by NLopt's L-BFGS, which shares nothing with it but the energy and its gradient: a second opinion.
NearestShape nearest_shape_lbfgs(const Prescribed& data, const Points& start, const NearestOptions& options = {});

/// A shape with its place among the others.
struct FoundShape {
    NearestShape shape;
    int mirror = -1; ///< index of the shape whose angles are these with the other sign, roughly; -1: none found
};

/// The minima that `find` comes to from `start`, from its mirror image, and from both shaken (seeded) across the surface, each
/// once, lowest energy first. Those are one that differ by less than 1e-6 in energy and 1e-3 rad in all angles; the weights of
/// `data` say how large an energy is.
std::vector<FoundShape> distinct_shapes(const Prescribed& data, const Points& start,
                                        const std::function<NearestShape(const Points&)>& find);

/// The same with nearest_shape().
std::vector<FoundShape> nearest_shapes(const Prescribed& data, const Points& start, const NearestOptions& options = {});

/// Points moved across the surface by up to a share of the mean edge, the same way for the same seed.
Points shaken(const Prescribed& data, Points x, double share, std::uint64_t seed);

/// The largest component of the gradient of the energy, as a share of the sum of all weights over the mean length.
double gradient_measure(const Prescribed& data, const Eigen::VectorXd& gradient);

/// The angle of every edge as `x` has it, 0 where there is no hinge.
std::vector<double> angles_of(const Prescribed& data, const Points& x);

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What a flattened piece is asked to have little of, by the triangle and by the pair of sewn edges.

#include "geometry/types.h"

namespace toile {

using Vec4 = Eigen::Vector4d;
using Mat4 = Eigen::Matrix4d;

/// (|J|^2 + |J^-1|^2 - 4) / 4 of a map of the plane with a positive determinant (Smith, Schaefer: Bijective Parameterization with
/// Free Boundaries, 2015): the sum of squares of small principal strains, infinite where the map folds over. `gradient` and
/// `hessian` (positive part), where not null, by J's columns one below the other.
double flat_energy(const Mat2& j, Vec4* gradient = nullptr, Mat4* hessian = nullptr);

/// (|a1 - a0| - |b1 - b0|)^2 / 2 of edges of two different points each, m^2. `gradient` and `hessian` (a part without negative values), where not null, by
/// a0, a1, b0, b1.
double sewn_energy(const std::array<Vec2, 4>& ends, Eigen::Matrix<double, 8, 1>* gradient = nullptr,
                   Eigen::Matrix<double, 8, 8>* hessian = nullptr);

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A triangle's linear map from the flat cloth to space, in grain directions: T = [x0 x1 x2] shape, whose columns are the images
// of the unit directions of weft and warp. Models that are functions of these images share what leads to the nodes.

#include "draping/fabric/fabric.h"
#include "sewing/garment.h"

namespace toile {

using GrainShape = Eigen::Matrix<double, 3, 2>;  ///< by corner; columns weft and warp, 1/m
using GrainImages = Eigen::Matrix<double, 3, 2>; ///< columns weft and warp
using GrainSlope = Eigen::Matrix<double, 6, 1>;  ///< by the weft's image, then by the warp's
using GrainBend = Eigen::Matrix<double, 6, 6>;

/// `rest` as in RestShape; a triangle without area has no shape.
GrainShape grain_shape(const Mat2& rest);
GrainImages grain_images(const std::array<int, 3>& nodes, const GrainShape& shape, const Points& x);

/// The derivative by the images as one by the triangle's corner k.
inline Vec3 at_corner(const GrainShape& shape, const GrainSlope& slope, int k) {
    return shape(k, 0) * slope.head<3>() + shape(k, 1) * slope.tail<3>();
}
/// The second derivative by the images as one by the corners.
Eigen::Matrix<double, 9, 9> at_corners(const GrainShape& shape, const GrainBend& bend);

/// A triangle that resists stretch of weft and warp and shear, each by itself.
struct GrainTriangle {
    std::array<int, 3> nodes{};
    GrainShape shape;
    double weft = 0, warp = 0, shear = 0; ///< stiffness times area, J
};

/// Triangle t of the garment with all that its fabric resists; measured curves by the numbers that stand for them.
GrainTriangle make_grain_triangle(const Garment& garment, const Fabric& fabric, int t);

} // namespace toile

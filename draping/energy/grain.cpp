// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/grain.h"

#include <Eigen/LU>

namespace toile {

GrainShape grain_shape(const Mat2& rest) {
    GrainShape shape;
    shape.bottomRows<2>() = rest.inverse();
    shape.row(0) = -shape.row(1) - shape.row(2);
    return shape;
}

GrainImages grain_images(const std::array<int, 3>& nodes, const GrainShape& shape, const Points& x) {
    Eigen::Matrix<double, 3, 2> edges;
    edges << x[nodes[1]] - x[nodes[0]], x[nodes[2]] - x[nodes[0]];
    return edges * shape.bottomRows<2>();
}

Eigen::Matrix<double, 9, 9> at_corners(const GrainShape& shape, const GrainBend& bend) {
    Eigen::Matrix<double, 9, 9> h;
    for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l) {
            Mat3 sum = Mat3::Zero();
            for (int p = 0; p < 2; ++p)
                for (int q = 0; q < 2; ++q) sum += shape(k, p) * shape(l, q) * bend.block<3, 3>(3 * p, 3 * q);
            h.block<3, 3>(3 * k, 3 * l) = sum;
        }
    return h;
}

GrainTriangle make_grain_triangle(const Garment& garment, const Fabric& fabric, int t) {
    const Mat2& rest = garment.rest.edges[t];
    const double area = rest_area(rest);
    return {garment.nodes(t), grain_shape(rest), fabric.stretch_weft * area, fabric.stretch_warp * area, fabric.shear * area};
}

} // namespace toile

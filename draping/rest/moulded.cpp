// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/rest/moulded.h"

#include "draping/energy/bend.h"
#include "draping/energy/grain.h"
#include "draping/energy/hinge.h"
#include "draping/energy/stretch.h"

#include <Eigen/Dense>

#include <stdexcept>

namespace toile {

namespace {

Vec3 across(const Triangle& nodes, const Points& x) {
    return (x[nodes[1]] - x[nodes[0]]).cross(x[nodes[2]] - x[nodes[0]]);
}

void refuse_flat_triangles(const Garment& garment, const Points& x) {
    for (int t = 0; t < int(garment.triangles.size()); ++t) {
        const char* where = !(rest_area(garment.rest.edges[t]) > 0)         ? "in the rest shape it had"
                            : !(across(garment.nodes(t), x).norm() > 0) ? "in the shape it is to take"
                                                                           : nullptr;
        if (where)
            throw std::invalid_argument("triangle " + std::to_string(t) + " has no area " + where +
                                        "; cloth can be moulded where every triangle has one");
    }
}

// Edges whose strain at x is zero, of any fabric. What arcs add depends on the edges in turn, but weakly.
void set_edges(Garment& g, const Points& x) {
    constexpr int most_rounds = 50;
    Fabric any;
    any.stretch_warp = any.stretch_weft = any.shear = 1;
    const std::vector<Fabric> fabrics(g.panel_names.size(), any);
    for (int round = 0; round < most_rounds; ++round) {
        const std::vector<StretchElement> elements = make_stretch(g, fabrics);
        double largest = 0;
        for (std::size_t t = 0; t < elements.size(); ++t) {
            const Vec3 strain = stretch_strain(elements[t], x);
            largest = std::max(largest, strain.cwiseAbs().maxCoeff());
            Mat2 metric;
            metric << 1 + 2 * strain[0], strain[2], strain[2], 1 + 2 * strain[1];
            g.rest.edges[t] = Eigen::SelfAdjointEigenSolver<Mat2>(metric).operatorSqrt() * g.rest.edges[t];
        }
        if (largest < 1e-15) return;
    }
}

void set_creases(Garment& g, const Points& x) {
    for (const Hinge& h : hinges_of(g))
        if (is_crease(g, h.edge))
            g.rest.angles[h.edge] = hinge_angle(h.nodes, x).value;
}

void set_curvature(Garment& g, const Points& x) {
    const std::vector<BendRows> rows = bend_rows(g);
    g.rest.curvature.resize(rows.size());
    for (std::size_t t = 0; t < rows.size(); ++t) {
        const Triangle nodes = g.nodes(int(t));
        Mat3 second = Mat3::Zero(), frame; // row by row; from differences, since the rows sum to zero
        for (std::size_t a = 1; a < rows[t].nodes.size(); ++a)
            second += rows[t].rows.col(a) * (x[rows[t].nodes[a]] - x[nodes[0]]).transpose();
        frame << grain_images(nodes, grain_shape(g.rest.edges[t]), x), across(nodes, x).normalized();
        g.rest.curvature[t] = second * frame.inverse().transpose();
    }
}

} // namespace

RestShape moulded(const Garment& garment, const Points& x) {
    refuse_flat_triangles(garment, x);
    Garment g = garment;
    g.rest.curvature.clear();
    set_edges(g, x);
    set_creases(g, x);
    set_curvature(g, x);
    return g.rest;
}

} // namespace toile

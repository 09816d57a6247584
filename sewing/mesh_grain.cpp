// SPDX-License-Identifier: GPL-3.0-or-later
#include "sewing/mesh_grain.h"

#include <numeric>

namespace toile {

namespace {

constexpr double across = 1e-6; // of the direction: less of it in the plane is rounding

} // namespace

Mat2 edges_in_grain(const Vec3& a, const Vec3& b, const Vec3& warp) {
    const Vec3 normal = a.cross(b).normalized();
    Vec3 along = warp.normalized() - warp.normalized().dot(normal) * normal;
    if (!(along.norm() > across)) {
        Eigen::Index axis = 0;
        normal.cwiseAbs().minCoeff(&axis);
        along = Vec3::Unit(axis) - normal[axis] * normal;
    }
    along.normalize();
    const Vec3 weft = along.cross(normal);
    Mat2 edges;
    edges << weft.dot(a), weft.dot(b), along.dot(a), along.dot(b);
    return edges;
}

Vec3 flat_warp(const Vec3& a, const Vec3& b, const Vec2& a_flat, const Vec2& b_flat) {
    const double area = a_flat.x() * b_flat.y() - a_flat.y() * b_flat.x();
    if (area == 0) return Vec3::Zero();
    return (a_flat.x() * b - b_flat.x() * a) / area;
}

Garment mesh_garment(const std::vector<Triangle>& triangles, int points, std::vector<Mat2> edges) {
    Garment g;
    g.triangles = triangles;
    g.panel_of_triangle.assign(triangles.size(), 0);
    g.panel_names = {"cloth"};
    g.panel_fabrics.resize(1);
    g.panel_layers.resize(1);
    g.uv.assign(points, Vec2::Zero());
    g.panel_of_vertex.assign(points, 0);
    g.node_count = points;
    g.node_of_vertex.resize(points);
    std::iota(g.node_of_vertex.begin(), g.node_of_vertex.end(), 0);
    g.edges = make_edges(triangles, points);
    g.seam_edge.assign(g.edges.size(), false);
    g.eased_triangle.assign(triangles.size(), false);
    g.rest.edges = std::move(edges);
    g.rest.angles.assign(g.edges.size(), 0.0);
    return g;
}

} // namespace toile

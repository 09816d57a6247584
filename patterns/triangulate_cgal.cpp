// SPDX-License-Identifier: GPL-3.0-or-later
#include "patterns/planar_mesh.h"

#ifndef CGAL_NDEBUG
#define CGAL_NDEBUG // the input is checked before it comes here, and the checks cost a third of the time
#endif
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Spatial_sort_traits_adapter_2.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/hilbert_sort.h>
#include <CGAL/property_map.h>

#include <stdexcept>

namespace toile {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
constexpr int unseen = -2, outside = -1;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>;
using FaceBase =
    CGAL::Triangulation_face_base_with_info_2<int, Kernel,
                                              CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Cdt = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>, CGAL::No_constraint_intersection_tag>;

/// Points in an order in which neighbours follow each other, which makes insertion fast.
std::vector<std::size_t> insertion_order(const std::vector<Kernel::Point_2>& points) {
    std::vector<std::size_t> order(points.size());
    for (std::size_t k = 0; k < order.size(); ++k)
        order[k] = k;
    using Map = CGAL::Pointer_property_map<Kernel::Point_2>::const_type;
    using Traits = CGAL::Spatial_sort_traits_adapter_2<Kernel, Map>;
    CGAL::hilbert_sort(order.begin(), order.end(), Traits(CGAL::make_property_map(points)));
    return order;
}

/// Marks the faces between the outlines: crossing one of their edges changes from outside to inside and back.
void mark_inside(Cdt& cdt, const std::vector<std::pair<Cdt::Vertex_handle, Cdt::Vertex_handle>>& outline) {
    for (auto f = cdt.all_faces_begin(); f != cdt.all_faces_end(); ++f)
        f->info() = unseen;
    std::vector<std::array<int, 2>> edges;
    for (const auto& [a, b] : outline)
        edges.push_back({std::min(a->info(), b->info()), std::max(a->info(), b->info())});
    std::sort(edges.begin(), edges.end());
    auto toggles = [&](Cdt::Face_handle f, int k) {
        if (!f->is_constrained(k)) return false;
        const int a = f->vertex(Cdt::ccw(k))->info(), b = f->vertex(Cdt::cw(k))->info();
        return std::binary_search(edges.begin(), edges.end(), std::array{std::min(a, b), std::max(a, b)});
    };
    std::vector<Cdt::Face_handle> stack{cdt.infinite_face()};
    cdt.infinite_face()->info() = outside;
    while (!stack.empty()) {
        const Cdt::Face_handle f = stack.back();
        stack.pop_back();
        for (int k = 0; k < 3; ++k) {
            const Cdt::Face_handle g = f->neighbor(k);
            if (g->info() != unseen) continue;
            g->info() = toggles(f, k) ? (f->info() == outside ? 0 : outside) : f->info();
            stack.push_back(g);
        }
    }
}

PlanarMesh extract(const Cdt& cdt, std::vector<Vec2> points, int border_points) {
    PlanarMesh mesh;
    mesh.points = std::move(points);
    mesh.border_points = mesh.still_points = border_points;
    mesh.triangle_at.assign(mesh.points.size(), -1);
    int count = 0;
    for (auto f = cdt.finite_faces_begin(); f != cdt.finite_faces_end(); ++f)
        if (f->info() != outside) f->info() = count++;
    for (auto f = cdt.finite_faces_begin(); f != cdt.finite_faces_end(); ++f) {
        if (f->info() == outside) continue;
        Triangle t;
        std::array<int, 3> across;
        std::array<bool, 3> fixed;
        for (int k = 0; k < 3; ++k) {
            t[k] = f->vertex(k)->info();
            across[k] = cdt.is_infinite(f->neighbor(k)) ? -1 : f->neighbor(k)->info();
            fixed[k] = f->is_constrained(k);
            mesh.triangle_at[t[k]] = int(mesh.triangles.size());
        }
        mesh.triangles.push_back(t);
        mesh.across.push_back(across);
        mesh.fixed.push_back(fixed);
    }
    return mesh;
}

} // namespace

PlanarMesh delaunay(const std::vector<Vec2>& border, const std::vector<std::array<int, 2>>& outline,
                    const std::vector<std::array<int, 2>>& inner, const std::vector<Vec2>& seeds) {
    std::vector<Vec2> all = border;
    all.insert(all.end(), seeds.begin(), seeds.end());
    std::vector<Kernel::Point_2> points;
    points.reserve(all.size());
    for (const Vec2& p : all)
        points.emplace_back(p.x(), p.y());

    Cdt cdt;
    std::vector<Cdt::Vertex_handle> vertex(points.size());
    Cdt::Face_handle hint;
    for (std::size_t k : insertion_order(points)) {
        vertex[k] = cdt.insert(points[k], hint);
        vertex[k]->info() = int(k);
        hint = vertex[k]->face();
    }
    if (cdt.number_of_vertices() != points.size()) throw std::runtime_error("two border points coincide");
    std::vector<std::pair<Cdt::Vertex_handle, Cdt::Vertex_handle>> outline_edges;
    try {
        for (const auto& [a, b] : outline) {
            cdt.insert_constraint(vertex[a], vertex[b]);
            outline_edges.push_back({vertex[a], vertex[b]});
        }
        for (const auto& [a, b] : inner)
            cdt.insert_constraint(vertex[a], vertex[b]);
    } catch (const Cdt::Intersection_of_constraints_exception&) {
        throw std::runtime_error("its edges cross");
    }
    mark_inside(cdt, outline_edges);
    return extract(cdt, std::move(all), int(border.size()));
}

} // namespace toile

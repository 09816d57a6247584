// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A flat triangulation with neighbours, and the local changes that make it better. Border points and others that are
// still never move, and fixed edges are never flipped or split.

#include "geometry/types.h"

#include <functional>

namespace toile {

struct PlanarMesh {
    std::vector<Vec2> points; ///< the border's first
    int border_points = 0;
    int still_points = 0; ///< the first so many do not move: those of the border, and of a lattice that is to stay
    std::vector<Triangle> triangles; ///< counter-clockwise
    std::vector<std::array<int, 3>>
        across; ///< triangle on the other side of the edge opposite corner k; -1: none
    std::vector<std::array<bool, 3>>
        fixed;                    ///< the edge opposite corner k is part of an outline, hole or line
    std::vector<int> triangle_at; ///< some triangle of each point

    bool on_border(int point) const { return point < border_points; }
    bool still(int point) const { return point < still_points; }
};

/// Wanted edge length at a place, metres.
using SizeAt = std::function<double(const Vec2&)>;

/// Constrained Delaunay triangulation (CGAL) of the inside of closed outlines (odd-even) with inner fixed
/// edges. `seeds` are further points inside. Throws std::runtime_error when fixed edges cross.
PlanarMesh delaunay(const std::vector<Vec2>& border, const std::vector<std::array<int, 2>>& outline,
                    const std::vector<std::array<int, 2>>& inner, const std::vector<Vec2>& seeds);

/// Inserts circumcentres of triangles that are too large, worst first, until every circumradius is below
/// `limit` times the wanted edge; none nearer to a fixed edge than half the wanted edge.
void refine(PlanarMesh& mesh, const SizeAt& size, double limit);

/// Sweeps that move every point that is not still to the mean circumcentre of its triangles, weighted by area (and for
/// graded sizes by density), and restore the Delaunay property by flips. Like Lloyd's sweeps, but the energy
/// is that of the triangulation instead of the Voronoi cells, which gives better angles in as many sweeps.
/// Never turns a triangle over. Chen, Holst: Efficient mesh optimization schemes based on optimal Delaunay
/// triangulations, 2011.
void smooth(PlanarMesh& mesh, const SizeAt& size, int sweeps);

/// Gives corners whose triangle has all three points on the border an inner point where the angles allow it
/// (such a triangle cannot drape), then moves those points of the worst triangles that may move to raise their
/// smallest angle.
void improve_angles(PlanarMesh& mesh);

/// Splits the edge between two points at its middle. False when there is no such edge or it is fixed.
bool split_edge(PlanarMesh& mesh, int a, int b);

/// Radians.
double smallest_angle(const Vec2& a, const Vec2& b, const Vec2& c);

} // namespace toile

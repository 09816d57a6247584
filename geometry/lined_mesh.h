// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Lines drawn on a surface: its triangles are split so that every line is a chain of edges, along which it can be cut. Corners
// near a line move onto it along the surface, so that no slivers are left.

#include "geometry/tri_mesh.h"

#include <Eigen/Geometry>

#include <map>

namespace toile {

class LinedMesh {
public:
    explicit LinedMesh(TriMesh mesh);

    const TriMesh& mesh() const { return mesh_; }
    /// The line that an edge belongs to, the smaller point first; that of an edge of two lines is the first drawn.
    const std::map<std::array<int, 2>, int>& lines() const { return lines_; }

    /// The point of the surface nearest to p, made a corner of its triangles; on a line where one is within `reach` metres of it.
    int point_near(const Vec3& p, double reach = 0);

    /// Draws a line from point a to b: the section by the plane that holds both and the mean of the normals there. False
    /// when it does not come to b, since the surface ends or turns away by more than 90 degrees, and for points on opposite sides.
    bool join(int a, int b, int line);

    /// Draws where the plane through `on` across `normal` meets the surface inside the box. False: nowhere.
    bool cut_by_plane(const Vec3& on, const Vec3& normal, const Eigen::AlignedBox3d& box, int line);

private:
    int cross_edge(int a, int b, double share);
    int split_edge(int a, int b, double share);
    void hold(int point) { held_[point] = 1; }
    bool may_move(int point, double way) const;
    void turn_slivers();
    int split_face(int t, const Vec3& p);
    void replace(int t, const Triangle& by);
    int add(const Triangle& t);
    std::vector<int> ring(int point) const; ///< triangles at a point, ascending
    void mark(int a, int b, int line);
    Vec3 normal_at(int point) const;

    TriMesh mesh_;
    std::vector<std::vector<int>> around_; ///< per point, its triangles
    std::vector<char> held_;               ///< per point, whether it must not move
    std::map<std::array<int, 2>, int> lines_;
};

} // namespace toile

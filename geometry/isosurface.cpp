// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/isosurface.h"

#include "geometry/parallel.h"
#include "geometry/solid.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <string>
#include <tuple>

namespace toile {

namespace {

using Field = std::function<double(const Vec3&)>;

/// Values of the field on the corners of a box of cubes.
struct Grid {
    Vec3 origin;
    double cell = 0;
    std::array<int, 3> corners{}; ///< number along x, y, z
    std::vector<double> value;

    int index(int i, int j, int k) const { return (k * corners[1] + j) * corners[0] + i; }
    Vec3 point(int i, int j, int k) const { return origin + cell * Vec3(i, j, k); }
};

Grid make_grid(const Vec3& origin, double cell, const std::array<int, 3>& corners) {
    return {origin, cell, corners, std::vector<double>(size_t(corners[0]) * corners[1] * corners[2])};
}

/// Calls visit(i, j, k) for every corner, the layers of k in parallel.
template <class Visit> void for_each_corner(const Grid& grid, Visit&& visit) {
    parallel_for(grid.corners[2], 1, [&](int begin, int end) {
        for (int k = begin; k < end; ++k)
            for (int j = 0; j < grid.corners[1]; ++j)
                for (int i = 0; i < grid.corners[0]; ++i) visit(i, j, k);
    });
}

/// Blocks of `stride` cells that the surface may pass: a block whose corners are all farther from it than the block
/// is wide across holds none. Where the field overestimates distance by up to two this is still safe, because no
/// point of a block is farther from its corners than half of that.
std::vector<bool> near_corners(const Grid& fine, const Grid& coarse, int stride) {
    const double far = coarse.cell * std::sqrt(3.0);
    std::vector<bool> near(fine.value.size(), false);
    for (int k = 0; k + 1 < coarse.corners[2]; ++k)
        for (int j = 0; j + 1 < coarse.corners[1]; ++j)
            for (int i = 0; i + 1 < coarse.corners[0]; ++i) {
                bool is_near = false;
                for (int c = 0; c < 8; ++c)
                    is_near |= !(std::abs(coarse.value[coarse.index(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2))]) > far);
                if (!is_near) continue;
                for (int z = k * stride; z <= (k + 1) * stride; ++z)
                    for (int y = j * stride; y <= (j + 1) * stride; ++y)
                        for (int x = i * stride; x <= (i + 1) * stride; ++x) near[fine.index(x, y, z)] = true;
            }
    return near;
}

/// The field at the corners near the surface; a corner far from it gets the value of one nearby, of the same sign.
Grid sample(const Field& field, const Eigen::AlignedBox3d& box, double cell) {
    constexpr int stride = 3;
    std::array<int, 3> blocks, corners;
    for (int axis = 0; axis < 3; ++axis) {
        blocks[axis] = int(std::ceil((box.sizes()[axis] / cell + 1) / stride)) + 1;
        corners[axis] = (blocks[axis] - 1) * stride + 1;
    }
    // Centred, so that a symmetric field is sampled symmetrically.
    const Vec3 origin = box.center() - 0.5 * cell * Vec3(corners[0] - 1, corners[1] - 1, corners[2] - 1);
    Grid coarse = make_grid(origin, stride * cell, blocks), fine = make_grid(origin, cell, corners);
    for_each_corner(coarse, [&](int i, int j, int k) { coarse.value[coarse.index(i, j, k)] = field(coarse.point(i, j, k)); });
    const std::vector<bool> near = near_corners(fine, coarse, stride);
    for_each_corner(fine, [&](int i, int j, int k) {
        const int c = fine.index(i, j, k);
        fine.value[c] = near[c] ? field(fine.point(i, j, k))
                                : coarse.value[coarse.index(i / stride, j / stride, k / stride)];
    });
    return fine;
}

// A cell's corner c lies at (c & 1, c >> 1 & 1, c >> 2); edge 4 a + n runs along axis a.
constexpr int edge_ends[12][2] = {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3},
                                  {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
// A face's corners in turn, and the edges between them.
constexpr int face_corners[6][4] = {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}};
constexpr int face_edges[6][4] = {{4, 10, 6, 8}, {5, 11, 7, 9}, {0, 9, 2, 8}, {1, 11, 3, 10}, {0, 5, 1, 4}, {2, 7, 3, 6}};

/// The sheets of the surface in one cell: which of them cuts each edge (-1: none), and a point for each.
struct CellSheets {
    std::array<int, 12> of_edge;
    std::vector<Vec3> points; ///< in cells from the cell's corner 0
};

void join(std::array<int, 12>& group, int a, int b) {
    const int from = group[b], to = group[a];
    for (int& g : group)
        if (g == from) g = to;
}

/// Two cuts on a face belong to one sheet. Four can be paired in two ways; the mean of the face's corners decides,
/// on both sides of the face alike.
void join_on_face(const double (&value)[8], int face, std::array<int, 12>& group) {
    const auto& corners = face_corners[face];
    const auto& edges = face_edges[face]; // edge k lies between corners k and k + 1
    int cut[4], count = 0;
    for (int k = 0; k < 4; ++k)
        if (group[edges[k]] >= 0) cut[count++] = k;
    if (count == 2) join(group, edges[cut[0]], edges[cut[1]]);
    if (count != 4) return;
    const bool middle_inside = value[corners[0]] + value[corners[1]] + value[corners[2]] + value[corners[3]] < 0;
    // Corners unlike the middle are cut off, each by the pair of edges at it.
    for (int k = 0; k < 4; ++k)
        if ((value[corners[k]] < 0) != middle_inside) join(group, edges[(k + 3) % 4], edges[k]);
}

/// Sheets of a cell from its corners' values; each one's point is the mean of the places where it cuts edges.
CellSheets sheets_of(const double (&value)[8]) {
    std::array<int, 12> group;
    for (int e = 0; e < 12; ++e)
        group[e] = (value[edge_ends[e][0]] < 0) != (value[edge_ends[e][1]] < 0) ? e : -1;
    for (int face = 0; face < 6; ++face) join_on_face(value, face, group);
    CellSheets sheets;
    sheets.of_edge.fill(-1);
    for (int g = 0; g < 12; ++g) {
        Vec3 sum = Vec3::Zero();
        int count = 0;
        for (int e = 0; e < 12; ++e) {
            if (group[e] != g) continue;
            const auto [c, d] = edge_ends[e];
            const Vec3 p(c & 1, c >> 1 & 1, c >> 2), q(d & 1, d >> 1 & 1, d >> 2);
            sum += p + value[c] / (value[c] - value[d]) * (q - p);
            sheets.of_edge[e] = int(sheets.points.size());
            ++count;
        }
        if (count > 0) sheets.points.push_back(sum / count);
    }
    return sheets;
}

/// One point per sheet of the surface in a cell, one quad per grid edge that it cuts.
TriMesh surface_net(const Grid& grid) {
    TriMesh mesh;
    const auto [nx, ny, nz] = grid.corners;
    std::vector<int> active(grid.value.size(), -1);
    std::vector<std::array<int, 12>> point_at; // of an active cell, by edge
    for (int k = 0; k + 1 < nz; ++k)
        for (int j = 0; j + 1 < ny; ++j)
            for (int i = 0; i + 1 < nx; ++i) {
                double value[8];
                int inside = 0;
                for (int c = 0; c < 8; ++c) {
                    value[c] = grid.value[grid.index(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2))];
                    inside += value[c] < 0;
                }
                if (inside == 0 || inside == 8) continue;
                CellSheets sheets = sheets_of(value);
                for (int& s : sheets.of_edge)
                    if (s >= 0) s += int(mesh.points.size());
                for (const Vec3& p : sheets.points) mesh.points.push_back(grid.point(i, j, k) + grid.cell * p);
                active[grid.index(i, j, k)] = int(point_at.size());
                point_at.push_back(sheets.of_edge);
            }
    // The quad round the edge from corner (i, j, k) along `axis`: its four cells, and which of their edges it is.
    const std::array<int, 3> step{1, nx, nx * ny};
    const auto add_quad = [&](int corner, int axis, bool flip) {
        const int u = step[(axis + 1) % 3], v = step[(axis + 2) % 3];
        const int ubit = 1 << (axis + 1) % 3, vbit = 1 << (axis + 2) % 3;
        const std::array<int, 4> cells{corner - u - v, corner - v, corner, corner - u};
        const std::array<int, 4> at{ubit | vbit, vbit, 0, ubit}; // the edge's first corner in each cell
        std::array<int, 4> q;
        for (int c = 0; c < 4; ++c)
            for (int e = 4 * axis; e < 4 * axis + 4; ++e)
                if (edge_ends[e][0] == at[c]) q[c] = point_at[active[cells[c]]][e];
        if (flip) std::swap(q[1], q[3]);
        const Points& p = mesh.points;
        if ((p[q[0]] - p[q[2]]).squaredNorm() <= (p[q[1]] - p[q[3]]).squaredNorm()) {
            mesh.triangles.push_back({q[0], q[1], q[2]});
            mesh.triangles.push_back({q[0], q[2], q[3]});
        } else {
            mesh.triangles.push_back({q[1], q[2], q[3]});
            mesh.triangles.push_back({q[1], q[3], q[0]});
        }
    };
    for (int k = 1; k + 1 < nz; ++k)
        for (int j = 1; j + 1 < ny; ++j)
            for (int i = 1; i + 1 < nx; ++i) {
                const int c = grid.index(i, j, k);
                for (int axis = 0; axis < 3; ++axis) {
                    const bool here = grid.value[c] < 0, there = grid.value[c + step[axis]] < 0;
                    if (here != there) add_quad(c, axis, !here);
                }
            }
    return mesh;
}

/// Forward differences: the direction only steers, the value that is driven to zero is exact.
Vec3 gradient(const Field& field, const Vec3& p, double value, double step) {
    Vec3 g;
    for (int axis = 0; axis < 3; ++axis) {
        Vec3 q = p;
        q[axis] += step;
        g[axis] = (field(q) - value) / step;
    }
    return g;
}

/// Neighbours of every point, ascending.
std::vector<std::vector<int>> rings(const TriMesh& mesh) {
    std::vector<std::vector<int>> ring(mesh.points.size());
    for (const Triangle& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) {
            ring[t[k]].push_back(t[(k + 1) % 3]);
            ring[t[k]].push_back(t[(k + 2) % 3]);
        }
    for (std::vector<int>& r : ring) {
        std::sort(r.begin(), r.end());
        r.erase(std::unique(r.begin(), r.end()), r.end());
    }
    return ring;
}

/// Every point toward the middle of its neighbours along the surface, then onto the surface.
void relax(TriMesh& mesh, const Field& field, double cell, double share) {
    const std::vector<std::vector<int>> ring = rings(mesh);
    Points moved = mesh.points;
    parallel_for(int(mesh.points.size()), 256, [&](int begin, int end) {
        for (int v = begin; v < end; ++v) {
            Vec3 p = mesh.points[v];
            const Vec3 g = gradient(field, p, field(p), 0.02 * cell);
            const double steepness = g.squaredNorm();
            if (ring[v].empty() || !(steepness > 0)) continue;
            Vec3 middle = Vec3::Zero();
            for (int n : ring[v]) middle += mesh.points[n] / double(ring[v].size());
            Vec3 step = share * (middle - p);
            step -= step.dot(g) / steepness * g;
            p += step;
            // The gradient of the old place serves: the step is small. A bound keeps bad fields from throwing points.
            const double off = std::clamp(field(p) / std::sqrt(steepness), -cell, cell);
            moved[v] = p - off / std::sqrt(steepness) * g;
        }
    });
    mesh.points = std::move(moved);
}

/// Cosine of the angle at c over a - b.
double cosine(const Points& p, int a, int b, int c) { return (p[a] - p[c]).normalized().dot((p[b] - p[c]).normalized()); }

/// Turns edges whose two opposite angles sum to more than 180 degrees, each triangle at most once. Returns how many.
int turn_edges(TriMesh& mesh) {
    struct Side {
        int low, high, triangle, corner;
    };
    std::vector<Side> sides;
    for (int t = 0; t < int(mesh.triangles.size()); ++t)
        for (int k = 0; k < 3; ++k) {
            const int a = mesh.triangles[t][(k + 1) % 3], b = mesh.triangles[t][(k + 2) % 3];
            sides.push_back({std::min(a, b), std::max(a, b), t, k});
        }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
    });
    const std::vector<std::vector<int>> ring = rings(mesh);
    std::vector<bool> touched(mesh.triangles.size(), false);
    int turned = 0;
    for (size_t i = 0; i + 1 < sides.size(); ++i) {
        const Side &s = sides[i], &o = sides[i + 1];
        if (s.low != o.low || s.high != o.high || touched[s.triangle] || touched[o.triangle]) continue;
        Triangle &t = mesh.triangles[s.triangle], &u = mesh.triangles[o.triangle];
        const int c = t[s.corner], d = u[o.corner], a = t[(s.corner + 1) % 3], b = t[(s.corner + 2) % 3];
        if (cosine(mesh.points, a, b, c) + cosine(mesh.points, a, b, d) > -1e-9) continue;
        if (std::binary_search(ring[c].begin(), ring[c].end(), d)) continue;
        t = {c, a, d};
        u = {c, d, b};
        touched[s.triangle] = touched[o.triangle] = true;
        ++turned;
    }
    return turned;
}

/// Joins the ends of edges shorter than `shortest`, where that keeps the surface a surface: ends with exactly two
/// common neighbours. A point takes part in one change.
void collapse_short_edges(TriMesh& mesh, double shortest) {
    const std::vector<std::vector<int>> ring = rings(mesh);
    std::vector<bool> touched(mesh.points.size(), false);
    std::vector<int> stays(mesh.points.size());
    for (int i = 0; i < int(stays.size()); ++i) stays[i] = i;
    for (int a = 0; a < int(mesh.points.size()); ++a)
        for (int b : ring[a]) {
            if (b < a || touched[a] || touched[b] || (mesh.points[a] - mesh.points[b]).norm() > shortest) continue;
            std::vector<int> common;
            std::set_intersection(ring[a].begin(), ring[a].end(), ring[b].begin(), ring[b].end(),
                                  std::back_inserter(common));
            if (common.size() != 2 || ring[common[0]].size() < 4 || ring[common[1]].size() < 4) continue;
            mesh.points[a] = 0.5 * (mesh.points[a] + mesh.points[b]);
            stays[b] = a;
            for (int n : ring[a]) touched[n] = true;
            for (int n : ring[b]) touched[n] = true;
        }
    for (Triangle& t : mesh.triangles)
        for (int& corner : t) corner = stays[corner];
    std::erase_if(mesh.triangles, [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
    drop_unused_points(mesh);
}

/// Two cells that each have both pairs of cuts of their common face on one sheet meet in an edge of four triangles.
/// It is rare, and another position of the grid has others.
TriMesh manifold_net(const Field& field, const Eigen::AlignedBox3d& box, double cell) {
    for (int attempt = 0; attempt < 8; ++attempt) {
        const Vec3 shift = attempt * cell * Vec3(0, 0.37, 0.21);
        TriMesh mesh = surface_net(sample(field, {box.min() - shift, box.max() - shift}, cell));
        if (crowded_edges(mesh) == 0) return mesh;
    }
    throw std::runtime_error("isosurface: the surface is finer than the grid of " + std::to_string(cell) + " m");
}

} // namespace

TriMesh isosurface(const Field& field, const Eigen::AlignedBox3d& box, const IsosurfaceOptions& options) {
    if (!(options.cell > 0) || box.isEmpty()) throw std::invalid_argument("isosurface: a box and a cell size expected");
    TriMesh mesh = manifold_net(field, box, options.cell);
    for (int round = 0; round < options.relaxations; ++round) {
        relax(mesh, field, options.cell, 0.5);
        collapse_short_edges(mesh, 0.4 * options.cell);
        for (int turns = 0; turns < 4 && turn_edges(mesh) > 0; ++turns) {}
    }
    relax(mesh, field, options.cell, 0);
    return mesh;
}

} // namespace toile

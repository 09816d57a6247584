// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/isosurface.h"

#include "geometry/parallel.h"
#include "geometry/solid.h"

#include <algorithm>
#include <cmath>
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

/// Mean of the places where the field changes sign on the cell's edges; false when it does not.
bool cell_point(const Grid& grid, int i, int j, int k, Vec3& point) {
    static constexpr int edges[12][2] = {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3},
                                         {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
    double value[8];
    for (int c = 0; c < 8; ++c) value[c] = grid.value[grid.index(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2))];
    Vec3 sum = Vec3::Zero();
    int count = 0;
    for (const auto& e : edges) {
        const double a = value[e[0]], b = value[e[1]];
        if ((a < 0) == (b < 0)) continue;
        const Vec3 p(e[0] & 1, e[0] >> 1 & 1, e[0] >> 2), q(e[1] & 1, e[1] >> 1 & 1, e[1] >> 2);
        sum += p + a / (a - b) * (q - p);
        ++count;
    }
    if (count == 0) return false;
    point = grid.point(i, j, k) + grid.cell * sum / count;
    return true;
}

/// One point per cell that the surface passes, one quad per grid edge that it cuts.
TriMesh surface_net(const Grid& grid) {
    TriMesh mesh;
    const auto [nx, ny, nz] = grid.corners;
    std::vector<int> point_of_cell(grid.value.size(), -1);
    for (int k = 0; k + 1 < nz; ++k)
        for (int j = 0; j + 1 < ny; ++j)
            for (int i = 0; i + 1 < nx; ++i)
                if (Vec3 p; cell_point(grid, i, j, k, p)) {
                    point_of_cell[grid.index(i, j, k)] = int(mesh.points.size());
                    mesh.points.push_back(p);
                }
    const auto add_quad = [&](std::array<int, 4> q, bool flip) {
        for (int& c : q) c = point_of_cell[c];
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
                const bool inside = grid.value[grid.index(i, j, k)] < 0;
                const int c = grid.index(i, j, k), dx = 1, dy = nx, dz = nx * ny;
                if (inside != (grid.value[grid.index(i + 1, j, k)] < 0))
                    add_quad({c - dy - dz, c - dz, c, c - dy}, !inside);
                if (inside != (grid.value[grid.index(i, j + 1, k)] < 0))
                    add_quad({c - dx - dz, c - dx, c, c - dz}, !inside);
                if (inside != (grid.value[grid.index(i, j, k + 1)] < 0))
                    add_quad({c - dx - dy, c - dy, c, c - dx}, !inside);
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

/// Where the surface runs along a grid's diagonals, rounding lets a cell have two sheets that share its one point.
/// Another position and size of the grid has others.
TriMesh manifold_net(const Field& field, const Eigen::AlignedBox3d& box, double cell) {
    for (int attempt = 0; attempt < 8; ++attempt) {
        const double size = cell * (1 - 0.04 * attempt);
        const Vec3 shift = attempt * size * Vec3(0, 0.37, 0.21);
        TriMesh mesh = surface_net(sample(field, {box.min() - shift, box.max() - shift}, size));
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
        for (int turns = 0; turns < 4 && turn_edges(mesh) > 0; ++turns) {}
    }
    relax(mesh, field, options.cell, 0);
    return mesh;
}

} // namespace toile

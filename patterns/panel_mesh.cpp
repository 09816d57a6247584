// SPDX-License-Identifier: GPL-3.0-or-later
#include "patterns/panel_mesh.h"

#include "patterns/lattice.h"
#include "patterns/plane.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace toile {
namespace {

constexpr double lattice_margin = 0.55; // edges between a border and points that stay where their lattice has them

/// p relative to the line a b: 0 within rounding.
int side(const Vec2& a, const Vec2& b, const Vec2& p) {
    const double area = cross(b - a, p - a), slack = 1e-12 * ((b - a).norm() * (p - a).norm() + 1e-12);
    return area > slack ? 1 : area < -slack ? -1 : 0;
}

bool within_box(const Vec2& a, const Vec2& b, const Vec2& p) {
    return p.x() >= std::min(a.x(), b.x()) && p.x() <= std::max(a.x(), b.x()) &&
           p.y() >= std::min(a.y(), b.y()) && p.y() <= std::max(a.y(), b.y());
}

bool meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
    const int ca = side(a, b, c), da = side(a, b, d), ac = side(c, d, a), bc = side(c, d, b);
    if (ca * da < 0 && ac * bc < 0) return true;
    return (ca == 0 && within_box(a, b, c)) || (da == 0 && within_box(a, b, d)) ||
           (ac == 0 && within_box(c, d, a)) || (bc == 0 && within_box(c, d, b));
}

/// Segments that share a point meet elsewhere only when one folds back onto the other.
bool fold_back(const Vec2& shared, const Vec2& p, const Vec2& q) {
    return side(shared, p, q) == 0 && (p - shared).dot(q - shared) > 0;
}

bool collide(const PanelBorder& border, const BorderSegment& s, const BorderSegment& t) {
    const auto& p = border.points;
    if (s.a == t.a) return s.b == t.b || fold_back(p[s.a], p[s.b], p[t.b]);
    if (s.a == t.b) return s.b == t.a || fold_back(p[s.a], p[s.b], p[t.a]);
    if (s.b == t.a) return fold_back(p[s.b], p[s.a], p[t.b]);
    if (s.b == t.b) return fold_back(p[s.b], p[s.a], p[t.a]);
    return meet(p[s.a], p[s.b], p[t.a], p[t.b]);
}

PlanarMesh seeded(const PanelBorder& border, const std::vector<Vec2>& seeds) {
    std::vector<std::array<int, 2>> outline, inner;
    for (const BorderSegment& s : border.segments)
        (s.outline ? outline : inner).push_back({s.a, s.b});
    return delaunay(border.points, outline, inner, seeds);
}

} // namespace

std::array<int, 2> crossing_segments(const PanelBorder& border) {
    struct Item {
        double low, high;
        int segment;
    };
    std::vector<Item> items;
    for (int k = 0; k < int(border.segments.size()); ++k) {
        const auto [low, high] =
            std::minmax(border.points[border.segments[k].a].x(), border.points[border.segments[k].b].x());
        items.push_back({low, high, k});
    }
    std::sort(items.begin(), items.end(), [](const Item& a, const Item& b) {
        return a.low != b.low ? a.low < b.low : a.segment < b.segment;
    });
    for (std::size_t i = 0; i < items.size(); ++i)
        for (std::size_t j = i + 1; j < items.size() && items[j].low <= items[i].high; ++j)
            if (collide(border, border.segments[items[i].segment], border.segments[items[j].segment]))
                return {std::min(items[i].segment, items[j].segment),
                        std::max(items[i].segment, items[j].segment)};
    return {-1, -1};
}

std::vector<bool> awkward_points(const PlanarMesh& mesh, double edge, const SizeAt& size) {
    std::vector<bool> awkward(mesh.border_points, false);
    std::vector<double> corner(mesh.border_points, 0); // angle of the cloth at a border point
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const int o = mesh.triangles[t][k], a = mesh.triangles[t][(k + 1) % 3],
                      b = mesh.triangles[t][(k + 2) % 3];
            const Vec2 u = mesh.points[a] - mesh.points[o], v = mesh.points[b] - mesh.points[o];
            if (mesh.on_border(o)) corner[o] += std::atan2(cross(u, v), u.dot(v));
            if (!mesh.fixed[t][k]) continue;
            const double wanted = edge * (size ? size(0.5 * (mesh.points[a] + mesh.points[b])) : 1.0);
            const double l = (mesh.points[b] - mesh.points[a]).norm();
            if (l < 0.5 * wanted || l > 2 * wanted) awkward[a] = awkward[b] = true;
        }
    for (int p = 0; p < mesh.border_points; ++p)
        if (corner[p] < EIGEN_PI / 3 - 1e-9) awkward[p] = true;
    return awkward;
}

double mean_edge_ratio(const PlanarMesh& mesh, double edge, const SizeAt& size) {
    const std::vector<bool> awkward = awkward_points(mesh, edge, size);
    auto exempt = [&](int p) { return mesh.on_border(p) && awkward[p]; };
    double sum = 0;
    int count = 0;
    for (int t = 0; t < int(mesh.triangles.size()); ++t)
        for (int k = 0; k < 3; ++k) {
            if (mesh.across[t][k] > t) continue;
            const int a = mesh.triangles[t][(k + 1) % 3], b = mesh.triangles[t][(k + 2) % 3];
            if (exempt(a) || exempt(b)) continue;
            const double wanted = edge * (size ? size(0.5 * (mesh.points[a] + mesh.points[b])) : 1.0);
            sum += (mesh.points[b] - mesh.points[a]).norm() / wanted;
            ++count;
        }
    return count > 0 ? sum / count : 1;
}

PlanarMesh mesh_panel(const PanelBorder& border, double edge, const SizeAt& size, int sweeps) {
    PlanarMesh best;
    double best_error = 1e300, scale = 0.997; // an irregular mesh's mean edge is a little above its lattice's
    for (int attempt = 0; attempt < 4; ++attempt) {
        const double spacing = scale * edge;
        const SizeAt wanted = [&](const Vec2& p) { return spacing * (size ? size(p) : 1.0); };
        const std::vector<Vec2> seeds =
            size ? std::vector<Vec2>{} : lattice_seeds(border, hexagonal_lattice(border, spacing), 0.62 * spacing);
        PlanarMesh mesh = seeded(border, seeds);
        refine(mesh, wanted, 0.8);
        smooth(mesh, size, sweeps);
        if (sweeps > 0) improve_angles(mesh);
        const double ratio = mean_edge_ratio(mesh, edge, size);
        if (std::abs(ratio - 1) < best_error) {
            best_error = std::abs(ratio - 1);
            best = std::move(mesh);
        }
        if (best_error < 0.02) break;
        scale = std::clamp(scale / ratio, 0.5, 1.5);
    }
    return best;
}

PlanarMesh mesh_panel_along_grain(const PanelBorder& border, double edge, double grain, int sweeps) {
    const Lattice lattice = grain_lattice(border, edge, grain);
    const double longer = std::max(lattice.spacing, lattice.height);
    PlanarMesh mesh = seeded(border, lattice_seeds(border, lattice, lattice_margin * longer));
    mesh.still_points = int(mesh.points.size());
    refine(mesh, [&](const Vec2&) { return longer; }, 0.8);
    smooth(mesh, {}, sweeps);
    if (sweeps > 0) improve_angles(mesh);
    return mesh;
}

} // namespace toile

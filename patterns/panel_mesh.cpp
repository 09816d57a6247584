// SPDX-License-Identifier: GPL-3.0-or-later
#include "patterns/panel_mesh.h"

#include "patterns/plane.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace toile {
namespace {

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

/// A lattice of equilateral triangles: rows at y = row * height, every second one shifted by half a spacing.
struct Lattice {
    Vec2 origin = Vec2::Zero();
    Vec2 along = Vec2::UnitX();
    double spacing = 1;

    double height() const { return spacing * std::sqrt(0.75); }
    Vec2 local(const Vec2& p) const { return {along.dot(p - origin), cross(along, p - origin)}; }
    Vec2 point(int row, int column) const {
        const Vec2 q{(column + (row % 2 != 0 ? 0.5 : 0.0)) * spacing, row * height()};
        return origin + q.x() * along + q.y() * Vec2(-along.y(), along.x());
    }
    double column_at(int row, double x) const { return x / spacing - (row % 2 != 0 ? 0.5 : 0.0); }
};

/// The lattice follows the directions (modulo 60 degrees) that most of the border has, so that most of the
/// border meets whole rows.
Lattice fit_lattice(const PanelBorder& border, double spacing) {
    std::array<double, 60> length{};
    auto bin = [&](const BorderSegment& s) {
        const Vec2 d = border.points[s.b] - border.points[s.a];
        const double degrees = std::atan2(d.y(), d.x()) * 180 / EIGEN_PI + 720;
        return int(std::floor(degrees + 0.5)) % 60;
    };
    for (const BorderSegment& s : border.segments)
        length[bin(s)] += (border.points[s.b] - border.points[s.a]).norm();
    const int best = int(std::max_element(length.begin(), length.end()) - length.begin());
    Lattice lattice;
    lattice.spacing = spacing;
    for (const BorderSegment& s : border.segments) {
        if (bin(s) != best) continue;
        lattice.origin = border.points[s.a];
        lattice.along = (border.points[s.b] - border.points[s.a]).normalized();
        break;
    }
    return lattice;
}

/// Lattice points inside the outline and at least `off` from every segment.
std::vector<Vec2> lattice_seeds(const PanelBorder& border, double spacing, double off) {
    const Lattice lattice = fit_lattice(border, spacing);
    std::vector<Vec2> local;
    for (const Vec2& p : border.points)
        local.push_back(lattice.local(p));
    double low = 1e300, high = -1e300;
    for (const Vec2& p : local)
        low = std::min(low, p.y()), high = std::max(high, p.y());
    const int first_row = int(std::ceil(low / lattice.height())),
              last_row = int(std::floor(high / lattice.height()));
    std::vector<std::vector<double>> crossings(std::max(0, last_row - first_row + 1));
    for (const BorderSegment& s : border.segments) {
        if (!s.outline) continue;
        Vec2 a = local[s.a], b = local[s.b];
        if (a.y() > b.y()) std::swap(a, b);
        for (int row = int(std::ceil(a.y() / lattice.height())); row * lattice.height() < b.y();
             ++row) // half open
            crossings[row - first_row].push_back(a.x() + (row * lattice.height() - a.y()) / (b.y() - a.y()) *
                                                             (b.x() - a.x()));
    }
    // Columns first_column[r] .. + keep[r].size() of row r.
    std::vector<int> first_column(crossings.size(), 0);
    std::vector<std::vector<char>> keep(crossings.size());
    for (std::size_t r = 0; r < crossings.size(); ++r) {
        std::vector<double>& x = crossings[r];
        if (x.empty()) continue;
        std::sort(x.begin(), x.end());
        const int row = first_row + int(r);
        first_column[r] = int(std::ceil(lattice.column_at(row, x.front())));
        keep[r].assign(std::max(0, int(std::floor(lattice.column_at(row, x.back()))) - first_column[r] + 1),
                       0);
        for (std::size_t k = 0; k + 1 < x.size(); k += 2)
            for (int c = int(std::ceil(lattice.column_at(row, x[k]))); c <= lattice.column_at(row, x[k + 1]);
                 ++c)
                keep[r][c - first_column[r]] = 1;
    }
    for (const BorderSegment& s : border.segments) {
        const Vec2 &a = local[s.a], &b = local[s.b];
        const int r0 = std::max(first_row, int(std::ceil((std::min(a.y(), b.y()) - off) / lattice.height())));
        const int r1 = std::min(last_row, int(std::floor((std::max(a.y(), b.y()) + off) / lattice.height())));
        for (int row = r0; row <= r1; ++row) {
            std::vector<char>& columns = keep[row - first_row];
            const int c0 = std::max(0, int(std::ceil(lattice.column_at(row, std::min(a.x(), b.x()) - off))) -
                                           first_column[row - first_row]);
            const int c1 = std::min(int(columns.size()) - 1,
                                    int(std::floor(lattice.column_at(row, std::max(a.x(), b.x()) + off))) -
                                        first_column[row - first_row]);
            for (int c = c0; c <= c1; ++c) {
                const Vec2 p = lattice.local(lattice.point(row, c + first_column[row - first_row]));
                if (distance_to_segment(p, a, b) < off) columns[c] = 0;
            }
        }
    }
    std::vector<Vec2> seeds;
    for (std::size_t r = 0; r < keep.size(); ++r)
        for (std::size_t c = 0; c < keep[r].size(); ++c)
            if (keep[r][c]) seeds.push_back(lattice.point(first_row + int(r), first_column[r] + int(c)));
    return seeds;
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
    std::vector<std::array<int, 2>> outline, inner;
    for (const BorderSegment& s : border.segments)
        (s.outline ? outline : inner).push_back({s.a, s.b});
    PlanarMesh best;
    double best_error = 1e300, scale = 0.997; // an irregular mesh's mean edge is a little above its lattice's
    for (int attempt = 0; attempt < 4; ++attempt) {
        const double spacing = scale * edge;
        const SizeAt wanted = [&](const Vec2& p) { return spacing * (size ? size(p) : 1.0); };
        const std::vector<Vec2> seeds =
            size ? std::vector<Vec2>{} : lattice_seeds(border, spacing, 0.62 * spacing);
        PlanarMesh mesh = delaunay(border.points, outline, inner, seeds);
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

} // namespace toile

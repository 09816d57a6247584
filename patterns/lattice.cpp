// SPDX-License-Identifier: GPL-3.0-or-later
#include "patterns/lattice.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace toile {
namespace {

constexpr double straight = 1e-3;        // sine of the angle within which border lies along a direction
constexpr double other_spacing = 4.0 / 3; // times the wanted one, beyond which border does not set the lattice

/// Border along one direction: some point of it, and how it is sampled.
struct Stretch {
    Vec2 at = Vec2::Zero();
    double length = 0;
    int segments = 0;

    double spacing() const { return length / segments; }
};

/// The longest of one interval.
std::optional<Stretch> longest_along(const PanelBorder& border, const Vec2& direction, double spacing) {
    std::map<int, Stretch> of_interval;
    for (const BorderSegment& s : border.segments) {
        const Vec2 d = border.points[s.b] - border.points[s.a];
        if (std::abs(cross(direction, d)) > straight * d.norm()) continue;
        Stretch& stretch = of_interval[s.interval];
        if (stretch.segments++ == 0) stretch.at = border.points[s.a];
        stretch.length += d.norm();
    }
    std::optional<Stretch> longest;
    for (const auto& [interval, s] : of_interval)
        if (s.spacing() < other_spacing * spacing && s.spacing() > spacing / other_spacing &&
            (!longest || s.length > longest->length))
            longest = s;
    return longest;
}

/// By the same comparison as where rows end, or rounding could leave a row without the border that it meets.
int first_row_from(double y, double height) {
    int row = int(std::floor(y / height)) - 1;
    while (row * height < y) ++row;
    return row;
}

} // namespace

Lattice hexagonal_lattice(const PanelBorder& border, double spacing) {
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
    lattice.height = spacing * std::sqrt(0.75);
    lattice.shift = 0.5;
    for (const BorderSegment& s : border.segments) {
        if (bin(s) != best) continue;
        lattice.origin = border.points[s.a];
        lattice.along = (border.points[s.b] - border.points[s.a]).normalized();
        break;
    }
    return lattice;
}

Lattice grain_lattice(const PanelBorder& border, double spacing, double grain) {
    Lattice lattice;
    lattice.along = to_grain(grain).row(0);
    const Vec2 across = to_grain(grain).row(1);
    const auto weft = longest_along(border, lattice.along, spacing), warp = longest_along(border, across, spacing);
    lattice.spacing = weft ? weft->spacing() : spacing;
    lattice.height = warp ? warp->spacing() : spacing;
    // A stretch tells where the lines across it lie, and if nothing else does, those along it.
    const Vec2 any = border.points.front();
    const Vec2 on_column = weft ? weft->at : warp ? warp->at : any, on_row = warp ? warp->at : weft ? weft->at : any;
    lattice.origin = lattice.along.dot(on_column) * lattice.along + across.dot(on_row) * across;
    return lattice;
}

std::vector<Vec2> lattice_seeds(const PanelBorder& border, const Lattice& lattice, double off) {
    std::vector<Vec2> local;
    for (const Vec2& p : border.points)
        local.push_back(lattice.local(p));
    double low = 1e300, high = -1e300;
    for (const Vec2& p : local)
        low = std::min(low, p.y()), high = std::max(high, p.y());
    const int first_row = first_row_from(low, lattice.height), last_row = first_row_from(high, lattice.height);
    std::vector<std::vector<double>> crossings(std::max(0, last_row - first_row + 1));
    for (const BorderSegment& s : border.segments) {
        if (!s.outline) continue;
        Vec2 a = local[s.a], b = local[s.b];
        if (a.y() > b.y()) std::swap(a, b);
        for (int row = first_row_from(a.y(), lattice.height); row * lattice.height < b.y(); ++row) // half open
            crossings[row - first_row].push_back(a.x() + (row * lattice.height - a.y()) / (b.y() - a.y()) *
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
        const int r0 = std::max(first_row, int(std::ceil((std::min(a.y(), b.y()) - off) / lattice.height)));
        const int r1 = std::min(last_row, int(std::floor((std::max(a.y(), b.y()) + off) / lattice.height)));
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

} // namespace toile

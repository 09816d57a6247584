// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Queries for collision detection: the public collection of reference queries, and random ones that are
// degenerate, or nearly so, on purpose.

#include "geometry/toi_cubic.h"
#include "geometry/exact_contact.h"
#include "tests/support/random.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace toile::test {

struct CcdQuery {
    PairKind kind;
    std::array<Vec3, 4> from, to;
    bool touch; ///< the truth that comes with it
};

inline Motion motion_between(const std::array<Vec3, 4>& x0, const std::array<Vec3, 4>& x1) {
    return {x0, {x1[0] - x0[0], x1[1] - x0[1], x1[2] - x0[2], x1[3] - x0[3]}};
}

/// How toi.h is asked whether a pair comes within `min_distance`: almost nothing else is kept.
inline bool toi_touch(PairKind kind, const Motion& m, double min_distance, double keep = 1e-9) {
    const ToiOptions options = {keep, min_distance};
    return (kind == PairKind::point_triangle ? time_of_impact_point_triangle(m, options)
                                             : time_of_impact_edge_edge(m, options)) < 1;
}

inline bool cubic_touch(PairKind kind, const Motion& m, double tolerance) {
    return (kind == PairKind::point_triangle ? cubic_toi_point_triangle(m, tolerance)
                                             : cubic_toi_edge_edge(m, tolerance))
        .has_value();
}

/// All queries below a folder of the collection of Wang, Ferguson et al. (A large-scale benchmark and an
/// inclusion-based algorithm for continuous collision detection, 2021): CSV files in folders `edge-edge` and
/// `vertex-face`, eight rows of x_num,x_den,y_num,y_den,z_num,z_den,truth to a query. Throws
/// std::runtime_error when a file is otherwise.
inline std::vector<CcdQuery> read_ccd_queries(const std::string& folder) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        if (entry.path().extension() == ".csv") files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    std::vector<CcdQuery> queries;
    for (const auto& path : files) {
        std::ifstream file(path);
        std::string line;
        CcdQuery q;
        q.kind =
            path.parent_path().filename() == "edge-edge" ? PairKind::edge_edge : PairKind::point_triangle;
        int row = 0;
        for (; std::getline(file, line); ++row) {
            std::replace(line.begin(), line.end(), ',', ' ');
            std::istringstream in(line);
            for (int c = 0; c < 3; ++c) {
                double num, den;
                in >> num >> den;
                (row % 8 < 4 ? q.from : q.to)[row % 4][c] = num / den;
            }
            if (!(in >> q.touch)) throw std::runtime_error(path.string() + " is no file of queries");
            if (row % 8 == 7) queries.push_back(q);
        }
        if (row % 8 != 0) throw std::runtime_error(path.string() + " ends within a query");
    }
    return queries;
}

/// Families of random queries, each hard in its own way.
enum class CcdFamily {
    generic,        ///< four points and their motions in a cube
    coplanar_start, ///< in one plane to begin with
    sliding,        ///< in one plane all the time, or out of it by very little
    aimed,    ///< a contact inside, on an edge or on a corner at some time of the step, missed by very little
    grazing,  ///< the same, closing speed zero: they touch and part, or just miss
    parallel, ///< parallel edges, triangles without area, at the contact or all the time
    grid,     ///< whole numbers from -2 to 2: all that can coincide does
    count
};

inline const char* name_of(CcdFamily f) {
    constexpr const char* names[] = {"generic", "coplanar start",    "sliding",      "aimed",
                                     "grazing", "parallel, no area", "whole numbers"};
    return names[int(f)];
}

/// A query of the family about 1 across, its motion 1e-12 to 1e3; then, most of the time, anything of: moved
/// by up to 1e6 from the origin, all coordinates changed by some units in the last place, scaled by up to
/// 1e30 or 1e-30. `size` is set to what 1 has become.
inline Motion random_ccd_query(CcdFamily family, PairKind kind, Random& random, double& size) {
    const auto power = [&](double low, double high) { return std::pow(10, random.in(low, high)); };
    const auto maybe = [&](double chance) { return random.unit() < chance; };
    const auto whole = [&](int range) {
        const double x = random.below(2 * range + 1) - range, y = random.below(2 * range + 1) - range,
                     z = random.below(2 * range + 1) - range;
        return Vec3(x, y, z);
    };
    const int first = kind == PairKind::point_triangle ? 1 : 2; // points of the first simplex
    const double speed = maybe(0.5) ? 1 : power(-12, 3);
    const bool on_grid = maybe(0.3); // coordinates of few bits: nothing is rounded in aiming
    const auto place = [&] { return on_grid ? Vec3(whole(8) / 8) : random.vec3(); };
    const double grid_speed = std::exp2(std::round(std::log2(speed)));
    const auto motion = [&] { return on_grid ? Vec3(grid_speed * whole(8) / 8) : random.vec3(speed); };

    Motion m;
    for (int k = 0; k < 4; ++k) {
        m.x[k] = place();
        m.dx[k] = motion();
    }
    // Weights of the corners of each simplex: of a point inside, on an edge or on a corner.
    const auto weights = [&](int n) {
        std::array<double, 3> w{};
        const int corner = random.below(n), how = random.below(3);
        if (how == 0) {
            w[corner] = 1;
        } else {
            const double s = on_grid ? random.below(9) / 8. : random.unit();
            w[corner] = 1 - s;
            w[(corner + 1) % n] = s;
            if (how == 2 && n == 3) {
                const double t = on_grid ? random.below(9) / 8. : random.unit();
                for (double& v : w)
                    v *= 1 - t;
                w[(corner + 2) % n] += t;
            }
        }
        return w;
    };
    const auto parallel = [&](std::array<Vec3, 4>& x) {
        if (kind == PairKind::edge_edge)
            x[3] = x[2] + random.in(-2, 2) * (x[1] - x[0]);
        else
            x[3] = x[1] + random.in(-2, 2) * (x[2] - x[1]);
    };
    // Moves the first simplex so that points of the two coincide at time t, all in doubles, and back to the
    // start.
    const auto aim = [&](bool graze) {
        const auto wa = weights(first), wb = weights(4 - first);
        Vec3 gap = Vec3::Zero(), closing = Vec3::Zero();
        for (int k = 0; k < 4; ++k) {
            const double w = k < first ? wa[k] : -wb[k - first];
            gap += w * m.x[k];
            closing += w * m.dx[k];
        }
        if (maybe(0.4)) gap += random.vec3(power(-17, -3));
        const double t = on_grid ? random.below(9) / 8. : maybe(0.1) ? random.below(2) : random.unit();
        // Grazing: no closing speed along the normal at t, where the points now lie as they are.
        if (graze) {
            const Vec3 n = first == 1 ? Vec3((m.x[2] - m.x[1]).cross(m.x[3] - m.x[1]))
                                      : Vec3((m.x[1] - m.x[0]).cross(m.x[3] - m.x[2]));
            if (n.squaredNorm() > 0) closing = closing.dot(n) / n.squaredNorm() * n;
        }
        for (int k = 0; k < 4; ++k) {
            if (k < first) {
                m.x[k] -= gap;
                if (graze) m.dx[k] -= closing;
            }
            m.x[k] -= t * m.dx[k];
        }
    };

    switch (family) {
    case CcdFamily::coplanar_start:
    case CcdFamily::sliding: {
        const int axis = random.below(3);
        const double level = maybe(0.5) ? 0 : random.in(-1, 1);
        const double out = family == CcdFamily::coplanar_start ? 1 : maybe(0.5) ? 0 : power(-18, -6);
        for (int k = 0; k < 4; ++k) {
            m.x[k][axis] = level;
            m.dx[k][axis] *= out;
        }
        if (maybe(0.3)) { // in a plane that is not a coordinate plane: coplanar but for rounding
            const Vec3 slope = random.vec3();
            for (int k = 0; k < 4; ++k)
                for (int c = 0; c < 3; ++c)
                    if (c != axis) {
                        m.x[k][axis] += slope[c] * m.x[k][c];
                        m.dx[k][axis] += slope[c] * m.dx[k][c];
                    }
        }
        break;
    }
    case CcdFamily::aimed:
        aim(false);
        break;
    case CcdFamily::grazing:
        aim(true);
        break;
    case CcdFamily::parallel:
        parallel(m.x);
        if (maybe(0.5)) // and stay so
            for (Vec3& d : m.dx)
                d = &d < &m.dx[first] ? m.dx[0] : m.dx[3];
        if (maybe(0.8)) aim(false);
        break;
    case CcdFamily::grid:
        for (int k = 0; k < 4; ++k) {
            m.x[k] = whole(2);
            m.dx[k] = whole(2);
        }
        break;
    default:
        break;
    }

    size = 1;
    if (maybe(0.3)) {
        const Vec3 origin =
            maybe(0.5) ? Vec3(std::exp2(random.below(21)) * whole(1)) : random.vec3(power(0, 6));
        for (Vec3& x : m.x)
            x += origin;
    }
    if (maybe(0.2)) // by a few units in the last place
        for (auto* points : {&m.x, &m.dx})
            for (Vec3& p : *points)
                for (double& v : p)
                    for (int k = v == 0 ? 0 : random.below(3); k > 0; --k)
                        v = std::nextafter(v, maybe(0.5) ? 1e300 : -1e300);
    if (maybe(0.3)) {
        size = maybe(0.5) ? std::exp2(random.below(201) - 100) : power(-30, 30);
        for (int k = 0; k < 4; ++k) {
            m.x[k] *= size;
            m.dx[k] *= size;
        }
    }
    return m;
}

} // namespace toile::test

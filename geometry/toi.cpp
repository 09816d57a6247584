// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/toi.h"

#include "geometry/distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace toile {

namespace {

/// How the four points divide into two simplices: the first `first` belong to one, the rest to the other.
struct PointTriangle {
    static constexpr int first = 1;
    static Vec3 gap(const std::array<Vec3, 4>& x) {
        return gap_point_triangle(nearest_point_triangle(x[0], x[1], x[2], x[3]), x);
    }
};

struct EdgeEdge {
    static constexpr int first = 2;
    static Vec3 gap(const std::array<Vec3, 4>& x) {
        return gap_edge_edge(nearest_edge_edge(x[0], x[1], x[2], x[3]), x);
    }
};

// Largest coordinate of a motion; not finite when one of them is not.
double largest_of(const Motion& m) {
    double largest = 0, finite = 0; // v - v is 0, or no number
    for (int k = 0; k < 4; ++k)
        for (int c = 0; c < 3; ++c)
            for (const double v : {m.x[k][c], m.dx[k][c]}) {
                largest = std::max(largest, std::abs(v));
                finite += v - v;
            }
    return largest + finite;
}

// Longest of the vectors of a motion.
double longest_of(const Motion& m) {
    double squared = 0;
    for (int k = 0; k < 4; ++k)
        squared = std::max({squared, m.x[k].squaredNorm(), m.dx[k].squaredNorm()});
    return std::sqrt(squared);
}

// By how much rounding can make a distance appear larger than it is; u = epsilon / 2 is the relative error of
// an operation, L the largest coordinate, l the longest of the differences worked with. Outside of here, x +
// t dx is written down: 3 u L per coordinate, so sqrt(3) times that per point and below 6 epsilon L between
// two. In here: positions at t are wrong by 5 u l (differences of places and of motions, product, sum), two
// points by 10 u l; their projections on a unit vector by 3 u of their length, 12 u l for both places, which
// are below 2 l, and 6 u l for motions; the length of that vector, subtractions, the division and the sum of
// times add 24 u l. In all 6 epsilon L + 26 epsilon l, which 8 epsilon L covers for points of a mesh, much
// nearer to each other than to the origin.
double rounding_of(double largest, double longest_difference) {
    return std::numeric_limits<double>::epsilon() *
           std::max(8 * largest, 6 * largest + 26 * longest_difference);
}

// Time from now at which the projections of the two simplices on `n` come within `target`: until then they
// are at least that far apart, whatever unit vector n is. Every corner moves linearly, so each pair of
// corners gives its own time and the earliest counts.
template <class Kind>
double time_along(const Vec3& n, const std::array<Vec3, 4>& x, const std::array<Vec3, 4>& dx, double target) {
    std::array<double, 4> place, speed;
    for (int k = 0; k < 4; ++k) {
        place[k] = n.dot(x[k]);
        speed[k] = n.dot(dx[k]);
    }
    double earliest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < Kind::first; ++i)
        for (int j = Kind::first; j < 4; ++j) {
            const double room = place[j] - place[i] - target, closing = speed[i] - speed[j];
            if (!(room > 0)) return 0; // nor past what is no number
            if (closing > 0) earliest = std::min(earliest, room / closing);
        }
    return earliest;
}

template <class Kind> double time_of_impact(const Motion& m, const ToiOptions& options) {
    // Relative to one corner in place and motion: differences of near points are exact or nearly so.
    const Motion local = {{Vec3::Zero(), m.x[1] - m.x[0], m.x[2] - m.x[0], m.x[3] - m.x[0]},
                          {Vec3::Zero(), m.dx[1] - m.dx[0], m.dx[2] - m.dx[0], m.dx[3] - m.dx[0]}};
    const double rounding = rounding_of(largest_of(m), longest_of(local));
    Vec3 gap = Kind::gap(local.x);
    double distance = gap.norm();
    const double room = distance - rounding - options.min_distance;
    if (!(room > 0)) return 0; // at rest too near, or not finite
    const double target = rounding + options.min_distance + options.keep * room;
    const double near_enough = target + 0.05 * options.keep * room;

    std::array<Vec3, 4> x = local.x;
    double t = 0;
    for (int k = 0; k < options.max_iterations; ++k) {
        const double step = time_along<Kind>(gap / distance, x, local.dx, target);
        if (t + step >= 1) return 1;
        if (!(step > 0)) break;
        t += step;
        for (int i = 1; i < 4; ++i)
            x[i] = local.x[i] + t * local.dx[i];
        gap = Kind::gap(x);
        distance = gap.norm();
        if (distance <= near_enough) break;
    }
    return t;
}

} // namespace

double time_of_impact_point_triangle(const Motion& m, const ToiOptions& options) {
    return time_of_impact<PointTriangle>(m, options);
}

double time_of_impact_edge_edge(const Motion& m, const ToiOptions& options) {
    return time_of_impact<EdgeEdge>(m, options);
}

} // namespace toile

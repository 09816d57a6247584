// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/fit/goal.h"

#include "draping/energy/grain.h"
#include "geometry/foot.h"
#include "geometry/parallel.h"
#include "geometry/slice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace toile {

namespace {

/// A kind of goal at one state: its mean square of misses, what counts for being met, and the derivative of the former.
struct Misses {
    double square = 0, counts = 0;
    std::vector<std::pair<int, Vec3>> gradient; ///< by node, to be added
};

Misses misses(const ShapeGoal& goal, const Garment&, const Points& x) {
    Misses m;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Vec3 off = x[i] - goal.target[i];
        m.square += goal.share[i] * off.squaredNorm();
        m.gradient.emplace_back(int(i), 2 * goal.share[i] * off);
    }
    m.counts = std::sqrt(m.square);
    return m;
}

Misses misses(const SurfaceGoal& goal, const Garment& garment, const Points& x) {
    const TriMesh cloth{x, node_triangles(garment)};
    const Bvh tree(triangle_boxes(x, cloth.triangles, 0));
    std::vector<Vec3> from_target(x.size()), from_cloth(goal.corners.size());
    std::vector<Foot> on_cloth(goal.corners.size());
    parallel_for(int(x.size()), 256, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) from_target[i] = x[i] - foot_on(goal.target, goal.tree, x[i]).at;
    });
    parallel_for(int(on_cloth.size()), 256, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
            on_cloth[i] = foot_on(cloth, tree, goal.target.points[i]);
            from_cloth[i] = goal.target.points[i] - on_cloth[i].at;
        }
    });
    // Where the nearest point lies is itself at a minimum, so its motion along the surface does not count.
    Misses m;
    for (std::size_t i = 0; i < x.size(); ++i) {
        m.square += goal.share[i] * from_target[i].squaredNorm();
        m.gradient.emplace_back(int(i), 2 * goal.share[i] * from_target[i]);
    }
    for (std::size_t i = 0; i < on_cloth.size(); ++i) {
        m.square += goal.corners[i] * from_cloth[i].squaredNorm();
        for (int k = 0; k < 3; ++k)
            m.gradient.emplace_back(cloth.triangles[on_cloth[i].triangle][k],
                                    -2 * goal.corners[i] * on_cloth[i].nearest.weight[k + 1] * from_cloth[i]);
    }
    m.counts = std::sqrt(m.square);
    return m;
}

Misses misses(const LevelGoal& goal, const Garment&, const Points& x) {
    double mean = 0;
    for (std::size_t k = 0; k < goal.nodes.size(); ++k) mean += goal.share[k] * x[goal.nodes[k]].y();
    const double height = goal.height.value_or(mean);
    Misses m;
    for (std::size_t k = 0; k < goal.nodes.size(); ++k) {
        const double off = x[goal.nodes[k]].y() - height;
        m.square += goal.share[k] * off * off;
        m.counts = std::max(m.counts, std::abs(off));
        m.gradient.emplace_back(goal.nodes[k], Vec3(0, 2 * goal.share[k] * off, 0)); // that of the mean cancels
    }
    return m;
}

/// Where an edge goes through a height: a plus the share of the way to b.
struct Crossing {
    int a, b;
    double share;
    Vec2 at; ///< (x, z)
};

std::vector<Crossing> crossings(const GirthGoal& goal, const Garment& g, const Points& x) {
    std::vector<Crossing> found;
    for (std::size_t t = 0; t < g.triangles.size(); ++t) {
        if (std::find(goal.panels.begin(), goal.panels.end(), g.panel_of_triangle[t]) == goal.panels.end()) continue;
        const Triangle n = g.nodes(int(t));
        for (int k = 0; k < 3; ++k) {
            const auto [a, b] = std::minmax(n[k], n[(k + 1) % 3]);
            const double low = x[a].y() - goal.height, high = x[b].y() - goal.height;
            if ((low >= 0) == (high >= 0)) continue;
            const double share = low / (low - high);
            const Vec3 p = x[a] + share * (x[b] - x[a]);
            found.push_back({a, b, share, {p.x(), p.z()}});
        }
    }
    return found;
}

Misses misses(const GirthGoal& goal, const Garment& g, const Points& x) {
    const std::vector<Crossing> found = crossings(goal, g, x);
    std::vector<Vec2> points;
    std::map<std::array<double, 2>, const Crossing*> crossing_at;
    for (const Crossing& c : found) {
        points.push_back(c.at);
        crossing_at[{c.at.x(), c.at.y()}] = &c;
    }
    Misses m;
    const std::vector<Vec2> hull = convex_hull(points);
    if (hull.size() < 3) {
        m.square = m.counts = std::numeric_limits<double>::infinity();
        return m;
    }
    double girth = 0;
    for (std::size_t k = 0; k < hull.size(); ++k) girth += (hull[(k + 1) % hull.size()] - hull[k]).norm();
    const double off = girth - goal.girth;
    m.square = off * off;
    m.counts = std::abs(off);
    for (std::size_t k = 0; k < hull.size(); ++k) {
        const Vec2& p = hull[k];
        const Vec2 pull = (p - hull[(k + 1) % hull.size()]).normalized() + (p - hull[(k + hull.size() - 1) % hull.size()]).normalized();
        const Crossing& c = *crossing_at.at({p.x(), p.y()});
        // The point moves with a and b, and along the edge as they rise.
        const Vec3 edge = x[c.b] - x[c.a];
        const Vec3 by(pull.x(), -(pull.x() * edge.x() + pull.y() * edge.z()) / edge.y(), pull.y());
        m.gradient.emplace_back(c.a, 2 * off * (1 - c.share) * by);
        m.gradient.emplace_back(c.b, 2 * off * c.share * by);
    }
    return m;
}

Misses misses(const StrainGoal& goal, const Garment& g, const Points& x) {
    Misses m;
    const std::vector<double> areas = rest_areas(g);
    double area = 0; // of the goal's triangles
    for (const int t : goal.triangles) area += areas[t];
    const int column = goal.warp ? 1 : 0;
    for (const int t : goal.triangles) {
        const Triangle n = g.nodes(t);
        const GrainShape shape = grain_shape(g.rest.edges[t]);
        const Vec3 yarn = grain_images(n, shape, x).col(column);
        const double over = yarn.norm() - 1 - goal.most, share = areas[t] / area;
        m.counts = std::max(m.counts, over);
        if (over <= 0) continue;
        m.square += share * over * over;
        for (int k = 0; k < 3; ++k) m.gradient.emplace_back(n[k], 2 * share * over * shape(k, column) * yarn.normalized());
    }
    return m;
}

Misses misses(const FitGoal& goal, const Garment& garment, const Points& x) {
    return std::visit([&](const auto& kind) { return misses(kind, garment, x); }, goal.what);
}

double square_of(double v) { return v * v; }

/// Areas as weights that sum to `sum`.
std::vector<double> shares(std::vector<double> areas, double whole, double sum) {
    for (double& area : areas) area *= sum / whole;
    return areas;
}

double total(const std::vector<double>& areas) { return std::accumulate(areas.begin(), areas.end(), 0.0); }

} // namespace

double miss(const FitGoal& goal, const Garment& garment, const Points& x) { return misses(goal, garment, x).counts; }

double value(const std::vector<FitGoal>& goals, const Garment& garment, const Points& x) {
    double sum = 0;
    for (const FitGoal& goal : goals) sum += misses(goal, garment, x).square / square_of(goal.tolerance);
    return sum;
}

void add_gradient(const std::vector<FitGoal>& goals, const Garment& garment, const Points& x, Eigen::VectorXd& g) {
    for (const FitGoal& goal : goals)
        for (const auto& [node, by] : misses(goal, garment, x).gradient)
            g.segment<3>(3 * node) += by / square_of(goal.tolerance);
}

ShapeGoal shape_goal(const Garment& garment, Points target) {
    return {std::move(target), shares(node_areas(garment), total(rest_areas(garment)), 1)};
}

SurfaceGoal surface_goal(const Garment& garment, TriMesh target) {
    std::vector<double> areas;
    for (const Triangle& t : target.triangles) areas.push_back(triangle_area(target.points, t));
    SurfaceGoal goal;
    goal.share = shape_goal(garment, {}).share;
    for (double& share : goal.share) share /= 2;
    goal.corners = shares(corner_areas(int(target.points.size()), target.triangles, areas), total(areas), 0.5);
    goal.tree = Bvh(triangle_boxes(target.points, target.triangles, 0));
    goal.target = std::move(target);
    return goal;
}

LevelGoal level_goal(const Garment& garment, const std::vector<std::vector<int>>& lines, std::optional<double> height) {
    std::map<int, double> length;
    double sum = 0;
    for (const std::vector<int>& line : lines)
        for (std::size_t k = 0; k + 1 < line.size(); ++k) {
            const double half = 0.5 * (garment.uv[line[k + 1]] - garment.uv[line[k]]).norm();
            for (const int v : {line[k], line[k + 1]}) length[garment.node_of_vertex[v]] += half;
            sum += 2 * half;
        }
    LevelGoal goal{{}, {}, height};
    for (const auto& [node, l] : length) {
        goal.nodes.push_back(node);
        goal.share.push_back(l / sum);
    }
    return goal;
}

} // namespace toile

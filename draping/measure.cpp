// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/measure.h"

#include "geometry/bvh.h"
#include "geometry/distance.h"
#include "geometry/intersections.h"
#include "geometry/parallel.h"
#include "geometry/slice.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace toile {

namespace {

constexpr double most_compression = 0.02; // beyond it cloth counts as compressed

// ---- strain

struct Sample {
    double value, area;
};

Spread spread_of(std::vector<Sample> samples) {
    Spread s;
    double area = 0, moment = 0;
    for (const Sample& k : samples) {
        area += k.area;
        moment += k.value * k.area;
    }
    if (!(area > 0)) return s;
    const auto by_value = [](const Sample& a, const Sample& b) { return a.value < b.value; };
    s.min = std::min_element(samples.begin(), samples.end(), by_value)->value;
    s.max = std::max_element(samples.begin(), samples.end(), by_value)->value;
    s.mean = moment / area;
    std::stable_sort(samples.begin(), samples.end(),
                     [](const Sample& a, const Sample& b) { return std::abs(a.value) < std::abs(b.value); });
    double below = 0;
    for (const Sample& k : samples) {
        s.p99 = std::abs(k.value);
        below += k.area;
        if (below >= 0.99 * area) break;
    }
    return s;
}

struct TriangleStrain {
    double warp, weft, larger, smaller; ///< stretches - 1
    double shear;
};

TriangleStrain strain_of(const Mat2& rest, const Vec3& a, const Vec3& b, const Vec3& c) {
    Eigen::Matrix<double, 3, 2> now;
    now << b - a, c - a;
    const Eigen::Matrix<double, 3, 2> f = now * rest.inverse();
    const double xx = f.col(0).squaredNorm(), yy = f.col(1).squaredNorm(), xy = f.col(0).dot(f.col(1));
    // Singular values from their sum of squares and their product: the smaller one keeps its digits.
    const double larger = std::sqrt(0.5 * (xx + yy + std::hypot(xx - yy, 2 * xy)));
    const double area = f.col(0).cross(f.col(1)).norm();
    const double scale = std::sqrt(xx * yy);
    const double shear = scale > 0 ? std::asin(std::clamp(xy / scale, -1.0, 1.0)) : 0;
    return {std::sqrt(yy) - 1, std::sqrt(xx) - 1, larger - 1, (larger > 0 ? area / larger : 0) - 1, shear};
}

/// Cloth that is gathered is not strained.
double counted(double strain, bool eased) { return eased ? std::max(strain, 0.0) : strain; }

double tighter(double limit, double other) {
    return limit > 0 && (other <= 0 || limit < other) ? limit : other;
}

// ---- developability

double angle_at(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Vec3 u = a - p, v = b - p;
    return std::atan2(u.cross(v).norm(), u.dot(v));
}

// Nodes with cloth all around and no seam or dart at them.
std::vector<bool> inner_nodes_off_seams(const Garment& garment) {
    std::vector<bool> inner(garment.node_count, false);
    for (int e = 0; e < garment.edges.size(); ++e)
        for (int n : garment.edges.ends[e])
            inner[n] = true;
    for (int e = 0; e < garment.edges.size(); ++e)
        if (garment.edges.triangles_at(e) != 2 || garment.seam_edge[e])
            for (int n : garment.edges.ends[e])
                inner[n] = false;
    return inner;
}

// ---- ease

// A horizontal section of the garment as a graph: crossings of edges, joined through triangles.
struct Section {
    std::vector<Vec2> points;
    std::vector<std::array<int, 2>> lines;
};

Section section_at(const Garment& garment, const Points& x, double height) {
    Section section;
    std::vector<int> crossing(garment.edges.size(), -1);
    for (int e = 0; e < garment.edges.size(); ++e) {
        const Vec3 &a = x[garment.edges.ends[e][0]], &b = x[garment.edges.ends[e][1]];
        if ((a[1] >= height) == (b[1] >= height)) continue;
        const double t = (height - a[1]) / (b[1] - a[1]);
        crossing[e] = int(section.points.size());
        section.points.push_back({a[0] + t * (b[0] - a[0]), a[2] + t * (b[2] - a[2])});
    }
    for (const auto& edges : garment.edges.of_triangle) {
        std::array<int, 2> line;
        int ends = 0;
        for (int e : edges)
            if (crossing[e] >= 0) line[ends++] = crossing[e];
        if (ends == 2) section.lines.push_back(line);
    }
    return section;
}

double turn(const Vec2& from, const Vec2& to) {
    return std::atan2(from[0] * to[1] - from[1] * to[0], from.dot(to));
}

// Parts of the section that go round `axis`. Walking along the lines turns about the axis; a part goes round
// when two ways to one point differ by a full turn. This needs neither order nor orientation nor loops
// without branches, and an open front does not close by itself.
std::vector<std::vector<Vec2>> parts_around(const Section& section, const Vec2& axis) {
    const int n = int(section.points.size());
    std::vector<std::vector<int>> next(n);
    for (const auto& [a, b] : section.lines) {
        next[a].push_back(b);
        next[b].push_back(a);
    }
    constexpr double unknown = std::numeric_limits<double>::infinity();
    std::vector<double> angle(n, unknown);
    std::vector<std::vector<Vec2>> parts;
    for (int seed = 0; seed < n; ++seed) {
        if (angle[seed] != unknown) continue;
        angle[seed] = 0;
        std::vector<int> queue = {seed};
        bool around = false;
        for (std::size_t k = 0; k < queue.size(); ++k)
            for (int to : next[queue[k]]) {
                const Vec2 from = section.points[queue[k]] - axis;
                const double reached = angle[queue[k]] + turn(from, section.points[to] - axis);
                if (angle[to] == unknown) {
                    angle[to] = reached;
                    queue.push_back(to);
                } else if (std::abs(reached - angle[to]) > EIGEN_PI) {
                    around = true;
                }
            }
        if (!around) continue;
        parts.emplace_back();
        for (int i : queue)
            parts.back().push_back(section.points[i]);
    }
    return parts;
}

// ---- clearance

std::vector<Vec3> used_points(const TriMesh& mesh) {
    std::vector<bool> used(mesh.points.size(), false);
    for (const Triangle& t : mesh.triangles)
        for (int i : t)
            used[i] = true;
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < used.size(); ++i)
        if (used[i]) points.push_back(mesh.points[i]);
    return points;
}

// Each search starts with the nearest found so far as its limit, so that all but a few end at the root.
void nearest_points_to_faces(const std::vector<Vec3>& points, const TriMesh& faces, double& squared) {
    const Bvh tree(triangle_boxes(faces.points, faces.triangles, 0));
    for (const Vec3& p : points)
        tree.nearest(p, squared, [&](int t) {
            const auto& [a, b, c] = faces.triangles[t];
            return nearest_point_triangle(p, faces.points[a], faces.points[b], faces.points[c]).squared;
        });
}

std::vector<std::array<int, 2>> edges_of(const TriMesh& mesh) {
    std::vector<std::array<int, 2>> edges;
    for (const Triangle& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) {
            const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
            edges.push_back({low, high});
        }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
}

void nearest_edges(const TriMesh& a, const TriMesh& b, double& squared) {
    const auto edges_a = edges_of(a), edges_b = edges_of(b);
    const Bvh tree(edge_boxes(b.points, edges_b, 0));
    for (const auto& e : edges_a) {
        const Vec3 &p = a.points[e[0]], &q = a.points[e[1]];
        tree.nearest(Box(p.cwiseMin(q), p.cwiseMax(q)), squared, [&](int k) {
            return nearest_edge_edge(p, q, b.points[edges_b[k][0]], b.points[edges_b[k][1]]).squared;
        });
    }
}

} // namespace

StrainMeasure measure_strain(const Garment& garment, const Points& x, const PanelFabrics& fabrics) {
    StrainMeasure measure;
    std::vector<Sample> warp, weft, principal, shear;
    double off_seams = 0, compressed = 0, narrowed = 0;
    for (int t = 0; t < int(garment.triangles.size()); ++t) {
        const Mat2& rest = garment.rest.edges[t];
        const double area = rest_area(rest);
        if (!(area > 0)) continue;
        const auto [a, b, c] = garment.nodes(t);
        const TriangleStrain s = strain_of(rest, x[a], x[b], x[c]);
        const bool eased = garment.eased_triangle[t];
        warp.push_back({counted(s.warp, eased), area});
        weft.push_back({counted(s.weft, eased), area});
        principal.push_back({counted(s.larger, eased), area});
        principal.push_back({counted(s.smaller, eased), area});
        shear.push_back({s.shear, area});
        if (eased) continue;
        off_seams += area;
        if (std::min(s.warp, s.weft) < -most_compression) compressed += area;
        if (s.smaller < -most_compression) narrowed += area;
    }
    measure.warp = spread_of(std::move(warp));
    measure.weft = spread_of(std::move(weft));
    measure.principal = spread_of(std::move(principal));
    measure.shear = spread_of(std::move(shear));
    measure.compressed_area = off_seams > 0 ? compressed / off_seams : 0;
    measure.narrowed_area = off_seams > 0 ? narrowed / off_seams : 0;
    for (const Fabric& f : fabrics) {
        measure.limit_warp = tighter(f.limit_warp, measure.limit_warp);
        measure.limit_weft = tighter(f.limit_weft, measure.limit_weft);
        measure.limit_shear = tighter(f.limit_shear, measure.limit_shear);
    }
    return measure;
}

std::vector<Vec2> yarn_strains(const Garment& garment, const Points& x) {
    std::vector<Vec2> strains(garment.triangles.size(), Vec2::Zero());
    for (int t = 0; t < int(garment.triangles.size()); ++t) {
        const Mat2& rest = garment.rest.edges[t];
        if (!(rest_area(rest) > 0)) continue;
        const auto [a, b, c] = garment.nodes(t);
        const TriangleStrain s = strain_of(rest, x[a], x[b], x[c]);
        const bool eased = garment.eased_triangle[t];
        strains[t] = {counted(s.weft, eased), counted(s.warp, eased)};
    }
    return strains;
}

DevelopabilityMeasure measure_developability(const Garment& garment, const Points& x) {
    std::vector<double> angles(garment.node_count, 0);
    for (int t = 0; t < int(garment.triangles.size()); ++t) {
        const Triangle n = garment.nodes(t);
        for (int k = 0; k < 3; ++k)
            angles[n[k]] += angle_at(x[n[k]], x[n[(k + 1) % 3]], x[n[(k + 2) % 3]]);
    }
    const std::vector<bool> inner = inner_nodes_off_seams(garment);
    DevelopabilityMeasure measure;
    int count = 0;
    for (int n = 0; n < garment.node_count; ++n) {
        if (!inner[n]) continue;
        const double defect = std::abs(2 * EIGEN_PI - angles[n]);
        measure.angle_defect_mean += defect;
        measure.angle_defect_max = std::max(measure.angle_defect_max, defect);
        ++count;
    }
    if (count > 0) measure.angle_defect_mean /= count;
    return measure;
}

EaseMeasure measure_ease(const Garment& garment, const Points& x, const TriMesh& body, double height) {
    const auto loops = slice(body, height);
    if (loops.empty()) return {};
    const auto torso = std::max_element(loops.begin(), loops.end(), [](const auto& a, const auto& b) {
        return loop_area(a).area < loop_area(b).area;
    });
    EaseMeasure measure;
    measure.body = hull_length(*torso);
    for (const auto& part : parts_around(section_at(garment, x, height), loop_area(*torso).centroid)) {
        const double girth = hull_length(part);
        if (!measure.found || girth < measure.garment) measure.garment = girth;
        measure.found = true;
    }
    if (measure.found) measure.ease = measure.garment - measure.body;
    return measure;
}

double seam_gap_max(const Garment& garment, const Points& x) {
    double gap = 0;
    for (const Stitch& s : garment.stitches)
        gap = std::max(gap, stitch_gap(s, x));
    return gap;
}

IntersectingPairs find_intersections(const std::vector<Triangle>& cloth, const Points& x, const TriMesh& body,
                                     const std::vector<Stitch>& stitches) {
    const TriMesh mesh = {x, cloth};
    std::set<std::array<int, 2>> sewn; // a node and an end of the edge it is sewn to, both ways round
    for (const Stitch& s : stitches)
        if (s.r > 0 && s.r < 1)
            for (const int end : s.b)
                sewn.insert({{s.a, end}, {end, s.a}});
    const auto joined = [&](const std::array<int, 2>& pair) {
        for (const int a : cloth[pair[0]])
            for (const int b : cloth[pair[1]])
                if (sewn.count({a, b})) return true;
        return false;
    };
    IntersectingPairs pairs;
    parallel_both([&] { pairs.cloth_avatar = intersecting_pairs(mesh, body); },
                  [&] { pairs.cloth_cloth = self_intersecting_pairs(mesh); });
    if (!sewn.empty()) std::erase_if(pairs.cloth_cloth, joined);
    return pairs;
}

IntersectionCount count_intersections(const std::vector<Triangle>& cloth, const Points& x, const TriMesh& body,
                                      const std::vector<Stitch>& stitches) {
    const IntersectingPairs pairs = find_intersections(cloth, x, body, stitches);
    return {int(pairs.cloth_avatar.size()), int(pairs.cloth_cloth.size())};
}

int count_pieces(const Garment& garment) {
    std::vector<Triangle> connected = node_triangles(garment);
    for (const Stitch& s : garment.stitches)
        if (s.r > 0 && s.r < 1) connected.push_back({s.a, s.b[0], s.b[1]});
    return count_pieces(connected, garment.node_count);
}

double clearance_min(const std::vector<Triangle>& cloth, const Points& x, const TriMesh& body) {
    const TriMesh mesh = {x, cloth};
    if (!intersecting_pairs(mesh, body).empty()) return 0;
    double squared = std::numeric_limits<double>::infinity();
    nearest_points_to_faces(used_points(mesh), body, squared);
    nearest_points_to_faces(used_points(body), mesh, squared);
    nearest_edges(mesh, body, squared);
    return std::sqrt(squared);
}

} // namespace toile

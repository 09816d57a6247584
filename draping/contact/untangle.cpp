// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/contact/untangle.h"

#include "geometry/parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <limits>
#include <tuple>

namespace toile {

namespace {

constexpr double straight = 0.2; // length of the summed directions below which a contour counts as straight
constexpr double flat_enough = 0.5; // length of the mean normal from which a contour lies in one sheet
constexpr int most_rounds = 10; // of untangling and moving apart
constexpr int more_rings = 3; // beyond a part's own depth to which the cloth before it comes along

Vec3 normal_of(const Points& x, const Triangle& t) { return (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]); }

/// Sum over the triangles at the edge of the unit directions in which the crossing goes on from the edge into each.
Vec3 contour_direction(const TangledCloth& cloth, const Points& x, const ClothCrossing& c, const Vec3& normal) {
    const auto& ends = cloth.edges.ends[c.edge];
    const Vec3 edge = (x[ends[1]] - x[ends[0]]).normalized();
    Vec3 sum = Vec3::Zero();
    for (int k = cloth.edges.first[c.edge]; k < cloth.edges.first[c.edge + 1]; ++k) {
        const Triangle& t = cloth.triangles[cloth.edges.incident[k]];
        const int opposite = *std::find_if(t.begin(), t.end(), [&](int i) { return i != ends[0] && i != ends[1]; });
        const Vec3 along = normal.cross(normal_of(x, t));
        if (!(along.squaredNorm() > 0)) continue;
        const Vec3 arm = x[opposite] - x[ends[0]], inward = arm - arm.dot(edge) * edge;
        sum += (along.dot(inward) < 0 ? -1.0 : 1.0) * along.normalized();
    }
    return sum;
}

/// Halfway to the mean of the neighbours: cloth round a crossing comes along, or it would be crumpled.
Points averaged(const TangledCloth& cloth, const Points& v) {
    Points sum(v.size(), Vec3::Zero());
    std::vector<int> count(v.size(), 0);
    for (const auto& [a, b] : cloth.edges.ends) {
        sum[a] += v[b], sum[b] += v[a];
        ++count[a], ++count[b];
    }
    for (std::size_t i = 0; i < v.size(); ++i) sum[i] = count[i] > 0 ? Vec3((v[i] + sum[i] / count[i]) / 2) : v[i];
    return sum;
}

// ---- parts that have gone through

/// The neighbours of every node.
std::vector<std::vector<int>> neighbours(const TangledCloth& cloth, int nodes) {
    std::vector<std::vector<int>> next(nodes);
    for (const auto& [a, b] : cloth.edges.ends) {
        next[a].push_back(b);
        next[b].push_back(a);
    }
    return next;
}

/// The contours that crossings lie on, and on which of the two sheets along its contour the edge of each is.
struct Contours {
    std::vector<int> of, sheet; ///< by crossing
    int count = 0;
};

Contours trace_contours(const TangledCloth& cloth, const std::vector<ClothCrossing>& crossings) {
    const int n = int(crossings.size());
    const auto find = [&](int edge, int triangle) {
        const auto at = std::lower_bound(crossings.begin(), crossings.end(), std::pair(edge, triangle),
                                         [](const ClothCrossing& c, const std::pair<int, int>& key) {
                                             return std::pair(c.edge, c.triangle) < key;
                                         });
        return at != crossings.end() && at->edge == edge && at->triangle == triangle ? int(at - crossings.begin()) : -1;
    };
    Contours contours{std::vector<int>(n, -1), std::vector<int>(n, 0), 0};
    for (int seed = 0; seed < n; ++seed) {
        if (contours.of[seed] >= 0) continue;
        std::vector<int> queue{seed};
        contours.of[seed] = contours.count;
        for (std::size_t q = 0; q < queue.size(); ++q) {
            const int c = queue[q], edge = crossings[c].edge, triangle = crossings[c].triangle;
            const auto go = [&](int to, int sheet) {
                if (to < 0 || contours.of[to] >= 0) return;
                contours.of[to] = contours.count;
                contours.sheet[to] = sheet;
                queue.push_back(to);
            };
            for (int k = cloth.edges.first[edge]; k < cloth.edges.first[edge + 1]; ++k) {
                const int own = cloth.edges.incident[k];
                for (const int e : cloth.edges.of_triangle[own]) go(find(e, triangle), contours.sheet[c]);
                for (const int e : cloth.edges.of_triangle[triangle]) go(find(e, own), 1 - contours.sheet[c]);
            }
        }
        ++contours.count;
    }
    return contours;
}

/// A part of the cloth that a contour cuts off, and the way back.
struct CutOff {
    std::vector<int> nodes;      ///< of the part, from the contour on
    std::vector<int> before;     ///< the nodes next to it on the other side of the contour
    std::vector<std::array<int, 2>> cut; ///< the edges between them, sorted
    int depth = 0;               ///< rings
    Vec3 back = Vec3::Zero();
};

bool is_cut(const std::vector<std::array<int, 2>>& cut, int a, int b) {
    return std::binary_search(cut.begin(), cut.end(), std::array<int, 2>{std::min(a, b), std::max(a, b)});
}

/// Walks over the cloth from two sides of a contour by turns, ring by ring, without going over it. Returns the part that
/// is finished first; no nodes when both meet.
CutOff smaller_part(const std::vector<std::vector<int>>& next, const std::array<std::vector<int>, 2>& ends,
                    std::vector<std::array<int, 2>> cut, const Vec3& normal) {
    std::vector<char> reached(next.size(), 0);
    std::array<std::vector<int>, 2> part, ring = ends;
    for (int s = 0; s < 2; ++s)
        for (const int i : ends[s]) {
            if (reached[i] == 2 - s) return {};
            reached[i] = char(1 + s);
        }
    for (int depth = 1;; ++depth)
        for (int s = 0; s < 2; ++s) {
            std::vector<int> further;
            part[s].insert(part[s].end(), ring[s].begin(), ring[s].end());
            for (const int i : ring[s])
                for (const int j : next[i]) {
                    if (is_cut(cut, i, j) || reached[j] == 1 + s) continue;
                    if (reached[j] == 2 - s) return {};
                    reached[j] = char(1 + s);
                    further.push_back(j);
                }
            ring[s] = std::move(further);
            if (ring[s].empty()) return {std::move(part[s]), ends[1 - s], std::move(cut), depth, s == 0 ? normal : Vec3(-normal)};
        }
}

/// The smaller of the parts that a contour cuts off its two sheets, if it can be drawn back straight.
CutOff part_to_withdraw(const TangledCloth& cloth, const Points& x, const std::vector<std::vector<int>>& next,
                        const std::vector<ClothCrossing>& crossings, const Contours& contours, const std::vector<int>& contour) {
    CutOff best;
    for (int sheet = 0; sheet < 2; ++sheet) {
        std::array<std::vector<int>, 2> ends; // behind the triangles passed through, and before them
        std::vector<std::array<int, 2>> cut;
        Vec3 normal = Vec3::Zero();
        for (const int c : contour) {
            if (contours.sheet[c] != sheet) continue;
            const Triangle& t = cloth.triangles[crossings[c].triangle];
            const auto& [a, b] = cloth.edges.ends[crossings[c].edge];
            const Vec3 n = normal_of(x, t).normalized();
            const bool b_before = n.dot(x[b] - x[a]) > 0;
            ends[b_before].push_back(b);
            ends[!b_before].push_back(a);
            cut.push_back({a, b});
            normal += n;
        }
        if (cut.empty() || !(normal.norm() > flat_enough * double(cut.size()))) continue;
        std::sort(cut.begin(), cut.end());
        for (auto& e : ends) {
            std::sort(e.begin(), e.end());
            e.erase(std::unique(e.begin(), e.end()), e.end());
        }
        CutOff part = smaller_part(next, ends, std::move(cut), normal.normalized());
        if (part.nodes.empty() || (!best.nodes.empty() && best.nodes.size() <= part.nodes.size())) continue;
        best = std::move(part);
    }
    return best;
}

/// Moves the part back, and the cloth before it the less the farther it is, to about twice the part's depth, so that it
/// is not crumpled there.
void add_withdrawal(const CutOff& part, const std::vector<std::vector<int>>& next, double longest, Points& step,
                    std::vector<double>& weight) {
    const auto add = [&](int node, double share) {
        step[node] += share * longest * part.back;
        weight[node] += 1;
    };
    std::vector<char> reached(next.size(), 0);
    for (const int i : part.nodes) {
        reached[i] = 1;
        add(i, 1);
    }
    const double reach = 2.0 * part.depth + more_rings;
    std::vector<int> ring = part.before;
    for (const int i : ring) reached[i] = 1;
    for (int k = 1; k < reach && !ring.empty(); ++k) {
        std::vector<int> further;
        for (const int i : ring) {
            add(i, 1 - k / reach);
            for (const int j : next[i])
                if (!reached[j]) {
                    reached[j] = 1;
                    further.push_back(j);
                }
        }
        ring = std::move(further);
    }
}

} // namespace

// ---- looking for crossings

CrossingFinder::CrossingFinder(const TangledCloth& cloth) : cloth_(cloth) {
    for (const auto& [node, end0, end1] : cloth.sewn_to_edge)
        for (const int end : {end0, end1}) sewn_.push_back({std::min(node, end), std::max(node, end)});
    std::sort(sewn_.begin(), sewn_.end());
}

bool CrossingFinder::joined(int a, int b) const {
    return a == b || (!sewn_.empty() && is_cut(sewn_, a, b));
}

/// Of edges and triangles of which one has a node that has moved.
std::vector<ClothCrossing> CrossingFinder::crossings_of(const std::vector<char>& moved, const Points& x) {
    const auto has_moved = [&](const auto& simplex) {
        return std::any_of(simplex.begin(), simplex.end(), [&](int i) { return moved[i]; });
    };
    const auto& edges = cloth_.edges.ends;
    const auto& triangles = cloth_.triangles;
    const auto passes = [&](int e, int t, std::vector<ClothCrossing>& found) {
        const auto& [a, b] = edges[e];
        const Triangle& k = triangles[t];
        if (std::any_of(k.begin(), k.end(), [&](int i) { return joined(i, a) || joined(i, b); })) return;
        if (const auto at = segment_through_triangle(x[a], x[b], x[k[0]], x[k[1]], x[k[2]])) found.push_back({e, t, *at});
    };
    std::vector<int> moved_edges, moved_triangles;
    for (int e = 0; e < int(edges.size()); ++e)
        if (has_moved(edges[e])) moved_edges.push_back(e);
    for (int t = 0; t < int(triangles.size()); ++t)
        if (has_moved(triangles[t])) moved_triangles.push_back(t);
    const int of_edges = int(moved_edges.size()), queries = of_edges + int(moved_triangles.size()), chunk = 128;
    std::vector<std::vector<ClothCrossing>> found(chunk_count(queries, chunk));
    parallel_for(queries, chunk, [&](int begin, int end) {
        for (int q = begin; q < end; ++q) {
            std::vector<ClothCrossing>& to = found[begin / chunk];
            Box box;
            if (q < of_edges) {
                const int e = moved_edges[q];
                for (const int i : edges[e]) box.extend(x[i]);
                triangle_tree_.overlapping(box, [&](int t) { passes(e, t, to); });
            } else {
                const int t = moved_triangles[q - of_edges];
                for (const int i : triangles[t]) box.extend(x[i]);
                edge_tree_.overlapping(box, [&](int e) {
                    if (!has_moved(edges[e])) passes(e, t, to);
                });
            }
        }
    });
    std::vector<ClothCrossing> all;
    for (const auto& f : found) all.insert(all.end(), f.begin(), f.end());
    return all;
}

const std::vector<ClothCrossing>& CrossingFinder::look(const Points& x) {
    const auto triangle_boxes = toile::triangle_boxes(x, cloth_.triangles, 0);
    const auto edge_boxes = toile::edge_boxes(x, cloth_.edges.ends, 0);
    std::vector<char> moved(x.size(), 1);
    if (looked_at_.empty()) {
        triangle_tree_ = Bvh(triangle_boxes);
        edge_tree_ = Bvh(edge_boxes);
    } else {
        triangle_tree_.refit(triangle_boxes);
        edge_tree_.refit(edge_boxes);
        for (std::size_t i = 0; i < x.size(); ++i) moved[i] = x[i] != looked_at_[i];
    }
    const auto has_moved = [&](int i) { return moved[i] != 0; };
    std::erase_if(found_, [&](const ClothCrossing& c) {
        const auto& e = cloth_.edges.ends[c.edge];
        const Triangle& t = cloth_.triangles[c.triangle];
        return std::any_of(e.begin(), e.end(), has_moved) || std::any_of(t.begin(), t.end(), has_moved);
    });
    const std::vector<ClothCrossing> fresh = crossings_of(moved, x);
    found_.insert(found_.end(), fresh.begin(), fresh.end());
    std::sort(found_.begin(), found_.end(), [](const ClothCrossing& a, const ClothCrossing& b) {
        return std::tie(a.edge, a.triangle) < std::tie(b.edge, b.triangle);
    });
    looked_at_ = x;
    return found_;
}

std::vector<ClothCrossing> find_crossings(const TangledCloth& cloth, const Points& x) {
    return CrossingFinder(cloth).look(x);
}

Untangled untangle(const TangledCloth& cloth, Points& x, const UntangleOptions& options) {
    Untangled result;
    CrossingFinder finder(cloth);
    const auto next = options.withdraw ? neighbours(cloth, int(x.size())) : std::vector<std::vector<int>>();
    Points best = x;
    int best_round = 0;
    for (;; ++result.rounds) {
        const std::vector<ClothCrossing>& crossings = finder.look(x);
        const int count = int(crossings.size());
        if (result.rounds == 0) result.before = result.after = count;
        if (count < result.after) {
            result.after = count;
            best = x;
            best_round = result.rounds;
        }
        if (crossings.empty() || result.rounds == options.max_rounds ||
            result.rounds - best_round >= options.patience || (options.go_on && !options.go_on())) {
            x = std::move(best);
            return result;
        }
        Points step(x.size(), Vec3::Zero());
        std::vector<double> weight(x.size(), 0.0);
        std::vector<char> withdrawn(crossings.size(), 0);
        if (options.withdraw) {
            const Contours contours = trace_contours(cloth, crossings);
            std::vector<std::vector<int>> of(contours.count);
            for (int c = 0; c < count; ++c) of[contours.of[c]].push_back(c);
            for (const std::vector<int>& contour : of) {
                const CutOff part = part_to_withdraw(cloth, x, next, crossings, contours, contour);
                if (part.nodes.empty()) continue;
                add_withdrawal(part, next, options.longest_step * cloth.edge_length, step, weight);
                for (const int c : contour) withdrawn[c] = 1;
            }
        }
        for (int k = 0; k < count; ++k) {
            if (withdrawn[k]) continue;
            const ClothCrossing& c = crossings[k];
            const auto& ends = cloth.edges.ends[c.edge];
            const Triangle& t = cloth.triangles[c.triangle];
            const Vec3 normal = normal_of(x, t).normalized(), edge = (x[ends[1]] - x[ends[0]]).normalized();
            const Vec3 r = contour_direction(cloth, x, c, normal);
            Vec3 g = r - 2 * edge.dot(r) / edge.dot(normal) * normal;
            if (!(g.norm() > 0) || !g.allFinite()) continue;
            g *= options.longest_step * cloth.edge_length * std::min(1.0, r.norm() / straight) / g.norm();
            const auto add = [&](int node, double share, double sign) {
                step[node] += sign * share * g;
                weight[node] += share;
            };
            add(ends[0], 1 - c.at.along, 0.5);
            add(ends[1], c.at.along, 0.5);
            for (int i = 0; i < 3; ++i) add(t[i], c.at.corner[i], -0.5);
        }
        for (std::size_t i = 0; i < x.size(); ++i)
            if (weight[i] > 0) step[i] /= std::max(weight[i], 0.5);
        for (int k = 0; k < options.spread; ++k) step = averaged(cloth, step);
        for (std::size_t i = 0; i < x.size(); ++i) x[i] += step[i];
    }
}

bool take_apart(const TangledCloth& cloth, Contact& contact, Points& x, const UntangleOptions& options, int& most) {
    for (int round = 0; round < most_rounds && (!options.go_on || options.go_on()); ++round) {
        const Untangled u = untangle(cloth, x, options);
        most = std::max(most, u.before);
        if (u.after > 0) return false;
        if (contact.widen(x) == 0 && find_crossings(cloth, x).empty()) return true;
    }
    return false;
}

std::vector<char> tangle_of(const TangledCloth& cloth, Contact& contact, const Points& x) {
    std::vector<char> tangle(x.size(), 0);
    for (const ClothCrossing& c : find_crossings(cloth, x)) {
        for (const int i : cloth.edges.ends[c.edge]) tangle[i] = 1;
        for (const int i : cloth.triangles[c.triangle]) tangle[i] = 1;
    }
    contact.leave_out({});
    for (const ContactPair& p : contact.violations(x))
        if (!p.with_body)
            for (const int i : p.p) tangle[i] = 1;
    return tangle;
}

} // namespace toile

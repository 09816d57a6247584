// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/place.h"

#include "draping/pieces.h"
#include "geometry/bvh.h"
#include "geometry/disjoint_sets.h"
#include "geometry/distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

namespace toile {

namespace {

constexpr double height_step = 0.01; // m
constexpr double highest = 0.2;      // m
constexpr double height_gain = 2;    // metres of seam that a metre of height must free
constexpr double no_length = 1e-6;   // m, below which a stitch is closed

using Corners = std::array<Vec3, 3>;

Corners corners_of(const Points& x, const Triangle& t) {
    return {x[t[0]], x[t[1]], x[t[2]]};
}

/// Whether the segment from a to b passes through the triangle.
bool pierces(const Vec3& a, const Vec3& b, const Corners& t) {
    return segment_through_triangle(a, b, t[0], t[1], t[2]).has_value();
}

/// Whether the segment from a to b passes through a triangle of a tree, whose items have the corners that `corners` gives.
bool passes(const Bvh& tree, const Vec3& a, const Vec3& b, auto&& corners) {
    Box segment;
    segment.extend(a);
    segment.extend(b);
    bool through = false;
    tree.overlapping(segment, [&](int k) { through = through || pierces(a, b, corners(k)); });
    return through;
}

/// Whether two triangles cross or are nearer than `distance`.
bool nearer_than(const Corners& a, const Corners& b, double distance) {
    const double limit = distance * distance;
    for (int i = 0; i < 3; ++i) {
        if (nearest_point_triangle(a[i], b[0], b[1], b[2]).squared < limit) return true;
        if (nearest_point_triangle(b[i], a[0], a[1], a[2]).squared < limit) return true;
        for (int j = 0; j < 3; ++j)
            if (nearest_edge_edge(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]).squared < limit) return true;
        if (pierces(a[i], a[(i + 1) % 3], b) || pierces(b[i], b[(i + 1) % 3], a)) return true;
    }
    return false;
}

double distance_to(const Vec3& p, const Corners& t) {
    return nearest_point_triangle(p, t[0], t[1], t[2]).squared;
}

/// A piece on its way to its place.
struct PlacedPiece : Piece {
    Vec3 push = Vec3::Zero();
    Bvh tree = {}; ///< of its triangles where the file puts them
    bool placed = false;
};

struct Placing {
    const Garment& garment;
    const Points& x;
    const TriMesh& body;
    const PlaceOptions& options;
    std::vector<PlacedPiece> pieces = {};
    Bvh body_tree = {};
    std::vector<int> piece_of_node = {};
    std::vector<int> group = {};             ///< of a node: nodes that stitches of no length join
    std::vector<double> reach = {};          ///< m, of a node: smallest altitude of the triangles round it
    std::vector<std::vector<int>> ring = {}; ///< groups next to a group, sorted

    Corners corners(int t, const Vec3& push) const {
        Corners c = corners_of(x, garment.nodes(t));
        for (Vec3& p : c)
            p += push;
        return c;
    }

    Box box(int t, const Vec3& push, double margin) const {
        Box b;
        for (const Vec3& p : corners(t, push))
            b.extend(p);
        b.min().array() -= margin;
        b.max().array() += margin;
        return b;
    }
};

void find_groups(Placing& p) {
    const Garment& g = p.garment;
    DisjointSets joined(g.node_count);
    for (const Stitch& s : g.stitches) {
        if (s.r != 0 || (p.x[s.a] - p.x[s.b[0]]).norm() > no_length) continue;
        joined.join(s.a, s.b[0]);
    }
    p.group = joined.all();
    p.ring.resize(g.node_count);
    for (const auto& [a, b] : g.edges.ends) {
        p.ring[p.group[a]].push_back(p.group[b]);
        p.ring[p.group[b]].push_back(p.group[a]);
    }
    for (auto& ring : p.ring)
        std::sort(ring.begin(), ring.end());
}

void find_reach(Placing& p) {
    p.reach.assign(p.garment.node_count, std::numeric_limits<double>::infinity());
    for (int t = 0; t < int(p.garment.triangles.size()); ++t) {
        const Corners c = p.corners(t, Vec3::Zero());
        const double doubled = (c[1] - c[0]).cross(c[2] - c[0]).norm();
        const double longest = std::max({(c[1] - c[0]).norm(), (c[2] - c[1]).norm(), (c[0] - c[2]).norm()});
        for (int i : p.garment.nodes(t))
            p.reach[i] = std::min(p.reach[i], longest > 0 ? doubled / longest : 0);
    }
}

/// What two triangles of different panels must keep between them: less where stitches of no length hold the
/// panels together and neither has been moved against the other, nothing where the triangles share such a
/// stitch.
double wanted_distance(const Placing& p, int s, int t) {
    double wanted = p.options.from_cloth;
    for (int i : p.garment.nodes(s))
        for (int j : p.garment.nodes(t)) {
            if (p.group[i] == p.group[j]) return 0;
            const auto& ring = p.ring[p.group[i]];
            if (std::binary_search(ring.begin(), ring.end(), p.group[j]))
                wanted = std::min({wanted, 0.5 * p.reach[i], 0.5 * p.reach[j]});
        }
    return wanted;
}

void collect_pieces(Placing& p) {
    for (Piece& piece : pieces_of(p.garment, p.x)) {
        p.pieces.push_back({std::move(piece)});
        std::vector<Box> boxes;
        for (int t : p.pieces.back().triangles) boxes.push_back(p.box(t, Vec3::Zero(), 0));
        p.pieces.back().tree = Bvh(boxes);
    }
    p.piece_of_node.resize(p.garment.node_count);
    for (int i = 0; i < int(p.pieces.size()); ++i)
        for (int node : p.pieces[i].nodes) p.piece_of_node[node] = i;
}

/// Turns that the body's surface takes round a point, by where a ray upward leaves and enters it.
bool inside_body(const Placing& p, const Vec3& at) {
    if (p.body_tree.size() == 0) return false;
    Vec3 end = at;
    end.y() = p.body_tree.bounds().max().y() + 1;
    Box ray;
    ray.extend(at);
    ray.extend(end);
    int turns = 0;
    p.body_tree.overlapping(ray, [&](int t) {
        const Corners c = corners_of(p.body.points, p.body.triangles[t]);
        if (pierces(at, end, c)) turns += (c[1] - c[0]).cross(c[2] - c[0]).y() > 0 ? 1 : -1;
    });
    return turns != 0;
}

bool near_body(const Placing& p, const Piece& piece, const Vec3& push) {
    if (p.body_tree.size() == 0) return false;
    for (int t : piece.triangles) {
        bool near = false;
        const Corners c = p.corners(t, push);
        p.body_tree.overlapping(p.box(t, push, p.options.from_body), [&](int s) {
            near =
                near || nearer_than(c, corners_of(p.body.points, p.body.triangles[s]), p.options.from_body);
        });
        if (near) return true;
    }
    return !piece.nodes.empty() && inside_body(p, p.x[piece.nodes[0]] + push);
}

bool near_cloth(const Placing& p, const Piece& piece, const Vec3& push) {
    for (const PlacedPiece& other : p.pieces) {
        if (!other.placed || &other == &piece) continue;
        const Vec3 relative = push - other.push;
        const bool together = relative.norm() < no_length;
        for (int t : piece.triangles) {
            bool near = false;
            const Corners c = p.corners(t, relative);
            other.tree.overlapping(p.box(t, relative, p.options.from_cloth), [&](int k) {
                if (near) return;
                const int s = other.triangles[k];
                const double wanted = together ? wanted_distance(p, s, t) : p.options.from_cloth;
                near = wanted > 0 && nearer_than(c, p.corners(s, Vec3::Zero()), wanted);
            });
            if (near) return true;
        }
    }
    return false;
}

bool outside(const Placing& p, const Piece& piece) { return any_of_panels(piece, p.options.outside); }

/// Whether a thread between placed pieces passes through the piece.
bool in_threads(const Placing& p, const PlacedPiece& piece, const Vec3& push) {
    for (const Stitch& s : p.garment.stitches) {
        const PlacedPiece &one = p.pieces[p.piece_of_node[s.a]], &other = p.pieces[p.piece_of_node[s.b[0]]];
        if (!one.placed || !other.placed || outside(p, one) || outside(p, other)) continue;
        const Vec3 a = p.x[s.a] + one.push - push, b = seam_point(s, p.x) + other.push - push;
        if (passes(piece.tree, a, b, [&](int k) { return corners_of(p.x, p.garment.nodes(piece.triangles[k])); }))
            return true;
    }
    return false;
}

bool clear(const Placing& p, const PlacedPiece& piece, const Vec3& push) {
    return !near_cloth(p, piece, push) && !near_body(p, piece, push) &&
           !(outside(p, piece) && in_threads(p, piece, push));
}

/// Distance from a panel's nodes to the body; negative by how deep its deepest node lies inside.
double distance_from_body(const Placing& p, const Piece& piece) {
    double nearest = std::numeric_limits<double>::infinity();
    for (int i : piece.nodes) {
        double limit = std::numeric_limits<double>::infinity();
        const auto squared = [&](int t) {
            return distance_to(p.x[i], corners_of(p.body.points, p.body.triangles[t]));
        };
        if (p.body_tree.nearest(p.x[i], limit, squared) < 0) return nearest;
        nearest = std::min(nearest, inside_body(p, p.x[i]) ? -std::sqrt(limit) : std::sqrt(limit));
    }
    return nearest;
}

bool fixed(const Placing& p, const Piece& piece) { return any_of_panels(piece, p.options.fixed); }

std::vector<int> order_of_placing(const Placing& p) {
    std::vector<std::tuple<bool, bool, int, double>> key; // fixed ones first, outside ones last, layer by layer
    for (const Piece& piece : p.pieces)
        key.emplace_back(!fixed(p, piece), outside(p, piece), p.garment.panel_layers[piece.panels[0]],
                         distance_from_body(p, piece));
    std::vector<int> order(p.pieces.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return key[a] < key[b]; });
    return order;
}

/// The smallest push that clears the panel; false when there is none.
bool find_push(const Placing& p, PlacedPiece& piece, const Vec3& axis) {
    Vec3 outward = piece.middle - axis;
    outward.y() = 0;
    std::vector<Vec3> ways{piece.normal, -piece.normal};
    if (piece.normal.dot(outward) < 0) std::swap(ways[0], ways[1]);
    if (outward.norm() > no_length) ways.push_back(outward.normalized());
    for (int k = 1; k * p.options.step <= p.options.farthest; ++k)
        for (const Vec3& way : ways)
            if (clear(p, piece, k * p.options.step * way)) {
                piece.push = k * p.options.step * way;
                return true;
            }
    return false;
}

/// A body that threads may pass through.
struct Obstacle {
    const TriMesh& body;
    Bvh tree = Bvh(triangle_boxes(body.points, body.triangles, 0));

    bool in_the_way(const Vec3& a, const Vec3& b) const {
        return passes(tree, a, b, [&](int t) { return corners_of(body.points, body.triangles[t]); });
    }
};

/// Which stitches' threads pass through the body once the garment is moved.
std::vector<char> blocked_threads(const Garment& garment, const Points& x, const Obstacle& obstacle, const Vec3& move) {
    std::vector<char> blocked;
    for (const Stitch& s : garment.stitches) blocked.push_back(obstacle.in_the_way(x[s.a] + move, seam_point(s, x) + move));
    return blocked;
}

} // namespace

double free_height(const Garment& garment, const Points& x, const TriMesh& body) {
    const Obstacle obstacle{body};
    const std::vector<char> at_first = blocked_threads(garment, x, obstacle, Vec3::Zero());
    std::array<std::vector<char>, 2> passed; // threads free at first that went into the body on the way up, on the way down
    passed.fill(std::vector<char>(at_first.size(), 0));
    const auto length = [&](const std::vector<char>& blocked, const std::vector<char>& gone) {
        double sum = 0;
        for (std::size_t k = 0; k < blocked.size(); ++k)
            if (blocked[k] || gone[k]) sum += garment.stitches[k].length;
        return sum;
    };
    double best = 0, least = length(at_first, passed[0]);
    for (int k = 1; k * height_step <= highest; ++k)
        for (int down = 0; down < 2; ++down) {
            const double height = (down ? -k : k) * height_step;
            const std::vector<char> now = blocked_threads(garment, x, obstacle, {0, height, 0});
            for (std::size_t s = 0; s < now.size(); ++s) passed[down][s] |= now[s] && !at_first[s];
            const double blocked = length(now, passed[down]);
            if (blocked > least - height_gain * (std::abs(height) - std::abs(best))) continue;
            least = blocked;
            best = height;
        }
    return best;
}

std::vector<char> stitches_through_body(const Garment& garment, const Points& x, const TriMesh& body) {
    return blocked_threads(garment, x, Obstacle{body}, Vec3::Zero());
}

std::optional<double> height_free_for(const Garment& garment, const Points& x, const TriMesh& body, const std::vector<char>& stitches) {
    const Obstacle obstacle{body};
    const std::vector<char> at_first = blocked_threads(garment, x, obstacle, Vec3::Zero());
    std::vector<char> theirs; // seams that have some of the stitches
    for (std::size_t k = 0; k < stitches.size(); ++k) {
        theirs.resize(std::max(theirs.size(), std::size_t(garment.stitches[k].seam + 1)), 0);
        theirs[garment.stitches[k].seam] |= stitches[k];
    }
    std::array<bool, 2> shut{}; // another seam would pass through the body on the way up, on the way down
    for (int k = 0; k * height_step <= highest; ++k)
        for (const int down : {1, 0}) {
            const double height = (down ? -k : k) * height_step;
            const std::vector<char> now = blocked_threads(garment, x, obstacle, {0, height, 0});
            bool any = false;
            for (std::size_t s = 0; s < now.size(); ++s) {
                any = any || (now[s] && stitches[s]);
                if (now[s] && !at_first[s] && !theirs[garment.stitches[s].seam]) shut[down] = true;
            }
            if (!any && !shut[down]) return height;
        }
    return std::nullopt;
}

std::vector<char> seams_through_body(const Garment& garment, const Points& x, const TriMesh& body) {
    const std::vector<char> blocked = stitches_through_body(garment, x, body);
    std::vector<char> through;
    for (std::size_t k = 0; k < blocked.size(); ++k) {
        const int seam = garment.stitches[k].seam;
        through.resize(std::max(through.size(), std::size_t(seam + 1)), 0);
        if (blocked[k]) through[seam] = 1;
    }
    return through;
}

PlacedClear place_clear(const Garment& garment, const Points& x, const TriMesh& body,
                        const PlaceOptions& options) {
    Placing p{.garment = garment, .x = x, .body = body, .options = options};
    p.body_tree = Bvh(triangle_boxes(body.points, body.triangles, 0));
    const Vec3 axis = body.points.empty() ? Vec3(Vec3::Zero()) : Vec3(p.body_tree.bounds().center());
    find_groups(p);
    find_reach(p);
    collect_pieces(p);
    PlacedClear result;
    for (int i : order_of_placing(p)) {
        PlacedPiece& piece = p.pieces[i];
        if (!fixed(p, piece) && !clear(p, piece, Vec3::Zero())) {
            const bool from_body = near_body(p, piece, Vec3::Zero()), found = find_push(p, piece, axis);
            for (int panel : piece.panels) {
                if (found)
                    result.pushed.push_back({panel, piece.push, from_body});
                else
                    result.left.push_back(panel);
            }
        }
        piece.placed = true;
    }
    result.x = x;
    for (const PlacedPiece& piece : p.pieces)
        for (int i : piece.nodes)
            result.x[i] += piece.push;
    return result;
}

} // namespace toile

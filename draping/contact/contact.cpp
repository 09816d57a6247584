// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/contact/contact.h"

#include "geometry/parallel.h"
#include "geometry/toi.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace toile {

namespace {

constexpr double keep_of_gap = 0.2;       // a step leaves at least this share of every gap
constexpr double least_slack = 0.0015;    // m; a list serves at least for motions of this size
constexpr double slack_per_step = 3;      // and for this many steps of the present size, but no more than
constexpr double most_slack = 0.005;      // m, or
constexpr double most_slack_share = 0.5;  // of an edge, or lists would grow too long
constexpr double most_moved = 0.5;        // share of the nodes; if more have moved, everything is looked for anew
constexpr double spare_slack = 2;         // times what a node needs, beyond which its slack is taken in
constexpr int query_chunk = 64;
constexpr double floor_share = 0.1;       // of the contact distance that is never entered
constexpr double all_but_parallel = 1e-12; // squared sine, below which a normal is made of rounding
constexpr double barrier_stiffness = 1e7; // Pa/m for a cloth of 0.15 kg/m2 at a distance of half a millimetre
constexpr double cloth_stiffness = 0.1;   // of the barrier, between cloth and cloth, which press lightly

/// By how much the plane of the triangle, or the two parallel planes through the edges, show a pair to be apart.
double apart_by_planes(const std::array<Vec3, 4>& x, bool edge_edge) {
    const Vec3 u = edge_edge ? x[1] - x[0] : x[2] - x[1], v = x[3] - x[edge_edge ? 2 : 1];
    const Vec3 normal = u.cross(v);
    const double height = normal.dot(edge_edge ? x[2] - x[0] : x[1] - x[0]), squared = normal.squaredNorm();
    if (squared <= all_but_parallel * u.squaredNorm() * v.squaredNorm()) return 0;
    return 0.999999 * std::abs(height) / std::sqrt(squared);
}

/// The most that the two of a pair come nearer to each other in a motion.
double approach(const std::array<Vec3, 4>& dx, bool edge_edge) {
    const int split = edge_edge ? 2 : 1;
    double squared = 0;
    for (int a = 0; a < split; ++a)
        for (int b = split; b < 4; ++b) squared = std::max(squared, (dx[a] - dx[b]).squaredNorm());
    return 1.000001 * std::sqrt(squared);
}

ListedPair::Kind kind_of(const ListedPair& p) { return ListedPair::Kind(p.kind); }
bool of_edges(ListedPair::Kind kind) { return kind == ListedPair::edge_edge || kind == ListedPair::edge_body_edge; }
bool with_body(ListedPair::Kind kind) { return kind != ListedPair::node_triangle && kind != ListedPair::edge_edge; }

// Of lengths; those below 0 count as 0.
float rounded_down(double d) { return float(std::max(d, 0.0)) * (1 - std::numeric_limits<float>::epsilon()); }
float rounded_up(double d) { return float(d) * (1 + std::numeric_limits<float>::epsilon()); }

/// How much nearer the two of a pair can have come by their travel.
double moved(const Travel& t, const ListedPair& l) {
    const auto of_body = [](const std::vector<double>& v, unsigned i) { return v.empty() ? 0 : v[i]; };
    switch (l.kind) {
    case ListedPair::node_triangle: return t.node[l.first] + t.triangle[l.second];
    case ListedPair::node_body_triangle: return t.node[l.first] + of_body(t.body_triangle, l.second);
    case ListedPair::body_point_triangle: return of_body(t.body_point, l.first) + t.triangle[l.second];
    case ListedPair::edge_edge: return t.edge[l.first] + t.edge[l.second];
    default: return t.edge[l.first] + of_body(t.body_edge, l.second);
    }
}

template <std::size_t N>
std::vector<double> most_of_each(const std::vector<std::array<int, N>>& simplices, const double* distance) {
    std::vector<double> most(simplices.size());
    for (std::size_t k = 0; k < simplices.size(); ++k)
        for (const int i : simplices[k]) most[k] = std::max(most[k], distance[i]);
    return most;
}

Box ball_box(const Vec3& p, double r) { return Box(p.array() - r, p.array() + r); }

template <std::size_t N> Box simplex_box(const Points& x, const std::array<int, N>& s, const std::vector<double>& slack) {
    Box box;
    for (int i : s) box.extend(ball_box(x[i], slack[i]));
    return box;
}

Box grown(Box box, double margin) {
    box.min().array() -= margin;
    box.max().array() += margin;
    return box;
}

using Matrix12 = Eigen::Matrix<double, 12, 12>;

/// What the second derivative of a pair's energy has beside that of the barrier along the normal: the curvature of
/// the distance, and the fade of edges that are all but parallel.
Matrix12 curvature_of_distance(const std::array<Vec3, 4>& x, const ActivePair& a, const ContactPair& p,
                               const Barrier& b) {
    const PairGeometry& g = a.geometry;
    const double slope = p.weight * b.slope(g.d);
    Matrix12 h = a.fade.value * slope * distance_hessian(x, g, p.edge_edge);
    if (!a.fade.fading) return h;
    h += p.weight * b.energy(g.d) * parallel_fade_hessian(x, p.fade);
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
            h.block<3, 3>(3 * i, 3 * j) += slope * (a.fade.gradient[i] * (g.weight[j] * g.normal).transpose() +
                                                    g.weight[i] * g.normal * a.fade.gradient[j].transpose());
    return h;
}

template <std::size_t N>
std::vector<Box> simplex_boxes(const Points& x, const std::vector<std::array<int, N>>& s,
                               const std::vector<double>& slack) {
    std::vector<Box> boxes(s.size());
    for (std::size_t k = 0; k < s.size(); ++k) boxes[k] = simplex_box(x, s[k], slack);
    return boxes;
}

} // namespace

ContactOptions barriers_at(double distance, double density) {
    ContactOptions c;
    c.body.distance = distance;
    c.body.floor = floor_share * distance;
    c.body.stiffness = barrier_stiffness * density / 0.15 * (0.5e-3 / distance);
    c.cloth = c.body;
    c.cloth.stiffness *= cloth_stiffness;
    return c;
}

Contact::Contact(ContactCloth cloth, const TriMesh& body, const ContactOptions& options)
    : cloth_(std::move(cloth)), options_(options), nodes_(int(cloth_.node_area.size())),
      body_triangles_(body.triangles), body_(body.points) {
    const EdgeTable edges = make_edges(body.triangles, int(body.points.size()));
    body_edges_ = edges.ends;
    body_area_.assign(body.points.size(), 0.0);
    body_edge_area_.assign(edges.size(), 0.0);
    for (std::size_t t = 0; t < body.triangles.size(); ++t) {
        const Triangle& k = body.triangles[t];
        const double area =
            0.5 * (body.points[k[1]] - body.points[k[0]]).cross(body.points[k[2]] - body.points[k[0]]).norm();
        for (int c = 0; c < 3; ++c) {
            body_area_[k[c]] += area / 3;
            body_edge_area_[edges.of_triangle[t][c]] += area / 3;
        }
    }
    body_slack_.assign(body_.size(), 0.0);
    make_body_trees();
    double edges_length = 0;
    for (const double l : cloth_.edge_length) edges_length += l;
    if (edges_length > 0)
        most_slack_ = std::min(most_slack, most_slack_share * edges_length / double(cloth_.edge_length.size()));
    triangle_of_node_.assign(nodes_, -1);
    for (std::size_t t = 0; t < cloth_.triangles.size(); ++t)
        for (const int i : cloth_.triangles[t]) triangle_of_node_[i] = int(t);

    int groups = 0;
    for (int g : cloth_.group) groups = std::max(groups, g + 1);
    ring_.resize(groups);
    for (const auto& e : cloth_.edges) {
        const int a = cloth_.group[e[0]], b = cloth_.group[e[1]];
        ring_[a].push_back(b);
        ring_[b].push_back(a);
    }
    sewn_.resize(groups);
    std::vector<std::pair<int, int>> near;
    for (const auto& [node, end0, end1] : cloth_.sewn_to_edge)
        for (const int end : {end0, end1}) {
            const int a = cloth_.group[node], b = cloth_.group[end];
            sewn_[a].push_back(b);
            sewn_[b].push_back(a);
            for (int next : ring_[a]) near.emplace_back(next, b);
            for (int next : ring_[b]) near.emplace_back(next, a);
        }
    for (const auto& [a, b] : near) {
        ring_[a].push_back(b);
        ring_[b].push_back(a);
    }
    for (auto& r : ring_) std::sort(r.begin(), r.end());
    for (auto& r : sewn_) std::sort(r.begin(), r.end());
}

void Contact::set_options(const ContactOptions& options) {
    options_ = options;
    built_ = false;
}

void Contact::make_body_trees() {
    body_built_at_ = body_;
    body_moved_ = false;
    body_serves_ = true;
    const bool fresh = body_point_tree_.size() == 0;
    const auto update = [fresh](Bvh& tree, const std::vector<Box>& boxes) {
        if (fresh)
            tree = Bvh(boxes);
        else
            tree.refit(boxes);
    };
    parallel_both([&] { update(body_edge_tree_, simplex_boxes(body_, body_edges_, body_slack_)); },
                  [&] {
                      std::vector<Box> points(body_.size());
                      for (std::size_t v = 0; v < body_.size(); ++v) points[v] = ball_box(body_[v], body_slack_[v]);
                      update(body_point_tree_, points);
                      update(body_triangle_tree_, simplex_boxes(body_, body_triangles_, body_slack_));
                  });
}

void Contact::set_body(const Points& body) {
    body_ = body;
    body_moved_ = true;
    body_serves_ = true;
    for (std::size_t v = 0; v < body_.size() && body_serves_; ++v)
        body_serves_ = (body_[v] - body_built_at_[v]).norm() <= body_slack_[v];
    active_at_.clear();
}

std::array<Vec3, 4> Contact::corners(const Points& x, const std::array<int, 4>& p) const {
    return {at(x, p[0]), at(x, p[1]), at(x, p[2]), at(x, p[3])};
}

std::array<Vec3, 4> Contact::corners(const Points& x, const ContactPair& p) const { return corners(x, p.p); }

Barrier Contact::barrier(const ContactPair& p) const {
    Barrier b = p.with_body ? options_.body : options_.cloth;
    b.floor *= p.distance / b.distance; // neighbours with little room between them keep the barrier's shape
    b.distance = p.distance;
    return b;
}

double Contact::reach(ListedPair::Kind kind) const { return (with_body(kind) ? options_.body : options_.cloth).distance; }

std::array<int, 4> Contact::points(const ListedPair& p) const {
    const int i = int(p.first), j = int(p.second), n = nodes_;
    switch (p.kind) {
    case ListedPair::node_triangle: {
        const Triangle& k = cloth_.triangles[j];
        return {i, k[0], k[1], k[2]};
    }
    case ListedPair::node_body_triangle: {
        const Triangle& k = body_triangles_[j];
        return {i, n + k[0], n + k[1], n + k[2]};
    }
    case ListedPair::body_point_triangle: {
        const Triangle& k = cloth_.triangles[j];
        return {n + i, k[0], k[1], k[2]};
    }
    case ListedPair::edge_edge: {
        const auto &a = cloth_.edges[i], &b = cloth_.edges[j];
        return {a[0], a[1], b[0], b[1]};
    }
    default: {
        const auto &a = cloth_.edges[i], &b = body_edges_[j];
        return {a[0], a[1], n + b[0], n + b[1]};
    }
    }
}

ContactPair Contact::pair(const ListedPair& l) const {
    const ListedPair::Kind kind = kind_of(l);
    ContactPair p;
    p.p = points(l);
    p.edge_edge = of_edges(kind);
    p.with_body = with_body(kind);
    p.distance = l.near_in_cloth ? limited_distance(p.p) : reach(kind);
    if (!p.edge_edge) {
        p.weight = kind == ListedPair::body_point_triangle ? body_area_[l.first] : cloth_.node_area[l.first];
        return p;
    }
    const double length2 = cloth_.edge_length[l.first] * cloth_.edge_length[l.first];
    if (p.with_body) {
        p.weight = std::min(cloth_.edge_area[l.first], body_edge_area_[l.second]);
        p.fade = length2 * (body_[p.p[3] - nodes_] - body_[p.p[2] - nodes_]).squaredNorm();
    } else {
        p.weight = std::min(cloth_.edge_area[l.first], cloth_.edge_area[l.second]);
        p.fade = length2 * cloth_.edge_length[l.second] * cloth_.edge_length[l.second];
    }
    return p;
}

bool Contact::near_in_cloth(bool edge_edge, const std::array<int, 4>& points) const {
    const int split = edge_edge ? 2 : 1;
    for (int a = 0; a < split; ++a)
        for (int b = split; b < 4; ++b) {
            const auto& ring = ring_[cloth_.group[points[a]]];
            if (std::binary_search(ring.begin(), ring.end(), cloth_.group[points[b]])) return true;
        }
    return false;
}

/// Of a pair too near each other on the cloth for the barrier's full distance.
double Contact::limited_distance(const std::array<int, 4>& points) const {
    double distance = options_.cloth.distance;
    for (const int k : points) distance = std::min(distance, 0.5 * cloth_.node_reach[k]);
    return distance;
}

/// From those of the nodes, which those of the body's points follow when it moves.
Travel Contact::travel(std::vector<double> distance) const {
    Travel t;
    if (int(distance.size()) > nodes_) {
        t.body_point.assign(distance.begin() + nodes_, distance.end());
        t.body_edge = most_of_each(body_edges_, t.body_point.data());
        t.body_triangle = most_of_each(body_triangles_, t.body_point.data());
        distance.resize(nodes_);
    }
    t.edge = most_of_each(cloth_.edges, distance.data());
    t.triangle = most_of_each(cloth_.triangles, distance.data());
    t.node = std::move(distance);
    return t;
}

Travel Contact::travel_since_built(const Points& x) const {
    std::vector<double> d(nodes_ + (body_moved_ ? body_.size() : 0));
    for (int i = 0; i < nodes_; ++i) d[i] = (x[i] - built_at_[i]).norm();
    if (body_moved_)
        for (std::size_t v = 0; v < body_.size(); ++v) d[nodes_ + v] = (body_[v] - body_built_at_[v]).norm();
    return travel(std::move(d));
}

Travel Contact::travel_of(const Eigen::VectorXd& dx, const Points* body_dx) const {
    std::vector<double> step(nodes_ + (body_dx ? body_.size() : 0));
    for (int i = 0; i < nodes_; ++i) step[i] = dx.segment<3>(3 * i).norm();
    if (body_dx)
        for (std::size_t v = 0; v < body_.size(); ++v) step[nodes_ + v] = (*body_dx)[v].norm();
    return travel(std::move(step));
}

bool Contact::body_serves(const Points* body_dx) const {
    if (!body_serves_ || !body_dx) return body_serves_;
    for (std::size_t v = 0; v < body_.size(); ++v)
        if ((body_[v] - body_built_at_[v] + (*body_dx)[v]).norm() > body_slack_[v]) return false;
    return true;
}

// A little more than the step, or rounding would take its end for out of reach.
double Contact::slack_for(double step) const {
    return std::max(1.01 * step, std::min(slack_per_step * step, most_slack_));
}

bool Contact::prepare(const Points& x, const Eigen::VectorXd& dx, const Points* body_dx) {
    const Stopwatch::Lap lap(clock_);
    // Pairs of nodes that stay within their slack serve on; those of the others are looked for anew, and those of
    // nodes that need less slack by now, whose pairs are many.
    const double least = std::min(least_slack, most_slack_);
    const auto wanted = [&](int i) { return std::max(least, slack_for(dx.segment<3>(3 * i).norm())); };
    std::vector<char> moved(nodes_, 1);
    const bool body_serves = this->body_serves(body_dx);
    if (built_ && body_serves) {
        bool serves = true;
        for (int i = 0; i < nodes_; ++i) {
            const Vec3 now = x[i] - built_at_[i];
            moved[i] = now.norm() > slack_[i] || (now + dx.segment<3>(3 * i)).norm() > slack_[i];
            serves = serves && !moved[i];
        }
        if (serves) return false;
        for (int i = 0; i < nodes_; ++i) moved[i] = moved[i] || slack_[i] > spare_slack * wanted(i);
    }
    if (std::count(moved.begin(), moved.end(), 1) > most_moved * nodes_) {
        std::fill(moved.begin(), moved.end(), 1);
        built_ = false;
    }
    slack_.resize(nodes_);
    built_at_.resize(nodes_);
    for (int i = 0; i < nodes_; ++i) {
        if (!moved[i]) continue;
        slack_[i] = wanted(i);
        built_at_[i] = x[i];
    }
    if (!body_serves) {
        for (std::size_t v = 0; v < body_.size(); ++v) body_slack_[v] = body_dx ? slack_for((*body_dx)[v].norm()) : 0;
        make_body_trees();
    }
    find_pairs(moved);
    return built_ = true;
}

/// Finds the pairs that have a node that has moved, in place of those that the list has of them.
void Contact::find_pairs(const std::vector<char>& moved_node) {
    active_at_.clear();
    const Points& x = built_at_;
    const int triangles = int(cloth_.triangles.size()), edges = int(cloth_.edges.size());
    const double reach_body = options_.body.distance, reach_cloth = options_.cloth.distance;

    const auto triangle_boxes = simplex_boxes(x, cloth_.triangles, slack_);
    const auto edge_boxes = simplex_boxes(x, cloth_.edges, slack_);
    if (options_.self && built_) {
        cloth_triangle_tree_.refit(triangle_boxes);
        cloth_edge_tree_.refit(edge_boxes);
    } else if (options_.self) {
        cloth_triangle_tree_ = Bvh(triangle_boxes);
        cloth_edge_tree_ = Bvh(edge_boxes);
    }

    std::vector<double> slack = slack_;
    slack.insert(slack.end(), body_slack_.begin(), body_slack_.end());
    const Travel room = travel(std::move(slack));
    const auto has_moved = [&](const auto& simplex) {
        return std::any_of(simplex.begin(), simplex.end(), [&](int i) { return i < nodes_ && moved_node[i]; });
    };
    if (built_)
        std::erase_if(pairs_, [&](const ListedPair& p) { return has_moved(points(p)); });
    else
        pairs_.clear();

    // Each query keeps what it finds; queries are put together in their order, whatever thread ran them.
    const auto collect = [&](int queries, auto&& find) {
        const int chunks = (queries + query_chunk - 1) / query_chunk;
        std::vector<std::vector<ListedPair>> found(chunks);
        parallel_for(chunks, 1, [&](int begin, int end) {
            for (int c = begin; c < end; ++c)
                for (int q = c * query_chunk; q < std::min(queries, (c + 1) * query_chunk); ++q)
                    find(q, [&](ListedPair::Kind kind, int first, int second) {
                        ListedPair l{kind, 0, unsigned(first), unsigned(second), 0, 0};
                        const std::array<int, 4> p = points(l);
                        const bool body = with_body(kind), edge_edge = of_edges(kind);
                        const auto out = [&](int i) { return !left_out_.empty() && left_out_[i]; };
                        if (!body && std::any_of(p.begin(), p.end(), out)) return;
                        const auto still = [&](int i) { return i >= nodes_ || cloth_.still[i]; };
                        if (!cloth_.still.empty() && std::all_of(p.begin(), p.end(), still)) return;
                        const std::array<Vec3, 4> corner = corners(x, p);
                        const double reach = this->reach(kind) + moved(room, l);
                        if (apart_by_planes(corner, edge_edge) > reach) return;
                        const double d = pair_geometry(corner, edge_edge).d;
                        if (d > reach) return;
                        l.near_in_cloth = !body && near_in_cloth(edge_edge, p);
                        l.built = rounded_down(d);
                        l.distance = rounded_up(l.near_in_cloth ? limited_distance(p) : this->reach(kind));
                        found[c].push_back(l);
                    });
        });
        std::size_t total = pairs_.size();
        for (const auto& f : found) total += f.size();
        pairs_.reserve(total);
        for (auto& f : found) {
            pairs_.insert(pairs_.end(), f.begin(), f.end());
            std::vector<ListedPair>().swap(f); // lists of millions are not to lie about twice
        }
    };
    const auto sewn_to = [&](int i, int j) {
        const auto& sewn = sewn_[cloth_.group[i]];
        return !sewn.empty() && std::binary_search(sewn.begin(), sewn.end(), cloth_.group[j]);
    };
    const auto shares_group = [&](std::initializer_list<int> a, std::initializer_list<int> b) {
        for (int i : a)
            for (int j : b)
                if (cloth_.group[i] == cloth_.group[j] || sewn_to(i, j)) return true;
        return false;
    };
    const auto keep_own = [&](int i, int t, auto&& keep) {
        const Triangle& k = cloth_.triangles[t];
        if (!shares_group({i}, {k[0], k[1], k[2]})) keep(ListedPair::node_triangle, i, t);
    };

    collect(nodes_, [&](int i, auto&& keep) {
        if (!moved_node[i]) return;
        const Box box = ball_box(x[i], slack_[i]);
        body_triangle_tree_.overlapping(grown(box, reach_body), [&](int t) { keep(ListedPair::node_body_triangle, i, t); });
        if (options_.self) cloth_triangle_tree_.overlapping(grown(box, reach_cloth), [&](int t) { keep_own(i, t, keep); });
    });
    collect(triangles, [&](int t, auto&& keep) {
        if (!has_moved(cloth_.triangles[t])) return;
        body_point_tree_.overlapping(grown(triangle_boxes[t], reach_body),
                                     [&](int v) { keep(ListedPair::body_point_triangle, v, t); });
        if (!options_.self) return;
        const Box box = grown(triangle_boxes[t], reach_cloth);
        cloth_triangle_tree_.overlapping(box, [&](int u) { // nodes that have not moved themselves
            for (const int i : cloth_.triangles[u])
                if (!moved_node[i] && triangle_of_node_[i] == u && box.intersects(ball_box(x[i], slack_[i])))
                    keep_own(i, t, keep);
        });
    });
    collect(edges, [&](int e, auto&& keep) {
        const auto& a = cloth_.edges[e];
        if (!has_moved(a)) return;
        body_edge_tree_.overlapping(grown(edge_boxes[e], reach_body), [&](int f) { keep(ListedPair::edge_body_edge, e, f); });
        if (options_.self)
            cloth_edge_tree_.overlapping(grown(edge_boxes[e], reach_cloth), [&](int f) {
                const auto& b = cloth_.edges[f];
                if (f == e || (f < e && has_moved(b))) return; // found by the other
                if (shares_group({a[0], a[1]}, {b[0], b[1]})) return;
                keep(ListedPair::edge_edge, a < b ? e : f, a < b ? f : e);
            });
    });
}

const std::vector<ActivePair>& Contact::active(const Points& x) const {
    if (x == active_at_) return active_;
    const Stopwatch::Lap lap(clock_);
    const Travel travel = travel_since_built(x);
    const int n = int(pairs_.size()), chunk = 1024, chunks = (n + chunk - 1) / chunk;
    std::vector<std::vector<ActivePair>> found(chunks);
    apart_.resize(n);
    parallel_for(chunks, 1, [&](int begin, int end) {
        for (int c = begin; c < end; ++c)
            for (int i = c * chunk; i < std::min(n, (c + 1) * chunk); ++i) {
                const ListedPair& l = pairs_[i];
                apart_[i] = rounded_down(l.built - moved(travel, l));
                if (apart_[i] >= l.distance) continue;
                const bool edge_edge = of_edges(kind_of(l));
                const std::array<Vec3, 4> corner = corners(x, points(l));
                apart_[i] = std::max(apart_[i], rounded_down(apart_by_planes(corner, edge_edge)));
                if (apart_[i] >= l.distance) continue;
                ActivePair a{i, pair_geometry(corner, edge_edge), {}};
                apart_[i] = rounded_down(a.geometry.d);
                if (a.geometry.d >= l.distance) continue;
                const ContactPair p = pair(l);
                if (a.geometry.d >= p.distance) continue;
                if (p.edge_edge) a.fade = parallel_fade(corner, p.fade);
                found[c].push_back(a);
            }
    });
    active_.clear();
    for (const auto& f : found) active_.insert(active_.end(), f.begin(), f.end());
    active_at_ = x;
    return active_;
}

double Contact::value(const std::vector<ActivePair>& active) const {
    const Stopwatch::Lap lap(clock_);
    double sum = 0;
    for (const ActivePair& a : active) {
        const ContactPair p = pair(a.pair);
        sum += p.weight * a.fade.value * barrier(p).energy(a.geometry.d);
    }
    return sum;
}

void Contact::add_gradient(const std::vector<ActivePair>& active, Eigen::VectorXd& g) const {
    const Stopwatch::Lap lap(clock_);
    for (const ActivePair& a : active) {
        const ContactPair p = pair(a.pair);
        const Barrier b = barrier(p);
        const double slope = p.weight * a.fade.value * b.slope(a.geometry.d);
        const double energy = a.fade.fading ? p.weight * b.energy(a.geometry.d) : 0;
        for (int k = 0; k < 4; ++k) {
            if (p.p[k] >= nodes_) continue;
            auto gk = g.segment<3>(3 * p.p[k]);
            gk += slope * a.geometry.weight[k] * a.geometry.normal;
            if (a.fade.fading) gk += energy * a.fade.gradient[k];
        }
    }
}

bool Contact::add_hessian(const Points& x, const std::vector<ActivePair>& active, bool exact, BlockMatrix& h) const {
    const Stopwatch::Lap lap(clock_);
    bool complete = true;
    for (const ActivePair& a : active) {
        const ContactPair p = pair(a.pair);
        const Barrier b = barrier(p);
        const double scale = p.weight * a.fade.value;
        const double curvature = scale * b.curvature(a.geometry.d);
        Matrix12 bend;
        if (exact) bend = curvature_of_distance(corners(x, p), a, p, b);
        const Mat3 normal = curvature * a.geometry.normal * a.geometry.normal.transpose();
        for (int i = 0; i < 4; ++i) {
            if (p.p[i] >= nodes_) continue;
            for (int j = 0; j < 4; ++j) {
                if (p.p[j] >= nodes_ || p.p[j] > p.p[i]) continue;
                Mat3 block = a.geometry.weight[i] * a.geometry.weight[j] * normal;
                if (exact) block += bend.block<3, 3>(3 * i, 3 * j);
                if (i == j) {
                    h.add_diagonal(p.p[i], block);
                } else if (const int slot = h.find(p.p[i], p.p[j]); slot >= 0) {
                    h.add_off_diagonal(p.p[j], slot, block);
                } else {
                    complete = false;
                }
            }
        }
    }
    return complete;
}

void Contact::couplings(const std::vector<ActivePair>& active, std::vector<std::pair<int, int>>& pairs) const {
    const Stopwatch::Lap lap(clock_);
    const auto couple = [&](const ListedPair& l) {
        const std::array<int, 4> p = points(l);
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < i; ++j) pairs.emplace_back(p[i], p[j]);
    };
    // Pairs with the body couple nodes of one edge or triangle, which the sheet couples.
    for (const ActivePair& a : active)
        if (!with_body(kind_of(pairs_[a.pair]))) couple(pairs_[a.pair]);
    for (const ListedPair& l : pairs_)
        if (!with_body(kind_of(l)) && l.built < 2 * l.distance) couple(l);
}

std::vector<int> Contact::within_reach(const Points& x, const Eigen::VectorXd& dx, const Points* body_dx) const {
    const Stopwatch::Lap lap(clock_);
    active(x); // works out how far apart they are
    const Travel step = travel_of(dx, body_dx);
    std::vector<int> found;
    for (int i = 0; i < int(pairs_.size()); ++i)
        if (apart_[i] - moved(step, pairs_[i]) < pairs_[i].distance) found.push_back(i);
    return found;
}

double Contact::feasible_step(const Points& x, const Eigen::VectorXd& dx, const Points* body_dx, int* blocking,
                              std::vector<double>* shares) const {
    const Stopwatch::Lap lap(clock_);
    active(x); // works out how far apart they are
    const Travel step = travel_of(dx, body_dx);
    const auto motion_of = [&](int i) -> Vec3 {
        if (i < nodes_) return dx.segment<3>(3 * i);
        return body_dx ? (*body_dx)[i - nodes_] : Vec3::Zero();
    };

    const int n = int(pairs_.size()), chunk = 1024, chunks = (n + chunk - 1) / chunk;
    using Limit = std::pair<double, int>; // share of the step, and the pair that allows no more
    std::vector<std::vector<Limit>> limits(chunks);
    parallel_for(chunks, 1, [&](int begin, int end) {
        for (int c = begin; c < end; ++c)
            for (int i = c * chunk; i < std::min(n, (c + 1) * chunk); ++i) {
                const ListedPair& l = pairs_[i];
                if (apart_[i] - moved(step, l) > l.distance) continue;
                const bool edge_edge = of_edges(kind_of(l));
                const std::array<int, 4> points = this->points(l);
                Motion m;
                for (int k = 0; k < 4; ++k) m.dx[k] = motion_of(points[k]);
                if (apart_[i] - approach(m.dx, edge_edge) > l.distance) continue;
                const ContactPair p = pair(l);
                m.x = corners(x, points);
                ToiOptions options;
                options.keep = keep_of_gap;
                options.min_distance = barrier(p).floor;
                const double t = edge_edge ? time_of_impact_edge_edge(m, options)
                                             : time_of_impact_point_triangle(m, options);
                if (t < 1) limits[c].emplace_back(t, i);
            }
    });
    Limit least{1.0, -1};
    if (shares) shares->assign(nodes_ + (body_dx ? body_.size() : 0), 1.0);
    for (const auto& found : limits)
        for (const auto& [t, i] : found) {
            if (t < least.first) least = {t, i};
            if (!shares) continue;
            for (const int k : points(pairs_[i]))
                if (k < int(shares->size())) (*shares)[k] = std::min((*shares)[k], t);
        }
    if (blocking) *blocking = least.second;
    return least.first;
}

Points Contact::body_forces(const std::vector<ActivePair>& active) const {
    const Stopwatch::Lap lap(clock_);
    Points force(nodes_, Vec3::Zero());
    for (const ActivePair& a : active) {
        const ContactPair p = pair(a.pair);
        if (!p.with_body) continue;
        const double slope = p.weight * a.fade.value * barrier(p).slope(a.geometry.d);
        for (int k = 0; k < 4; ++k)
            if (p.p[k] < nodes_) force[p.p[k]] -= slope * a.geometry.weight[k] * a.geometry.normal;
    }
    return force;
}

std::vector<PairForce> Contact::cloth_forces(const std::vector<ActivePair>& active) const {
    const Stopwatch::Lap lap(clock_);
    std::vector<PairForce> forces;
    for (const ActivePair& a : active) {
        const ContactPair p = pair(a.pair);
        if (p.with_body) continue;
        const double press = -p.weight * a.fade.value * barrier(p).slope(a.geometry.d);
        if (press > 0) forces.push_back({p.p, a.geometry.weight, p.edge_edge, press * a.geometry.normal});
    }
    std::sort(forces.begin(), forces.end(), [](const PairForce& a, const PairForce& b) {
        return std::tie(a.edge_edge, a.point) < std::tie(b.edge_edge, b.point);
    });
    return forces;
}

int Contact::widen(Points& x) {
    const Stopwatch::Lap lap(clock_);
    constexpr int sweeps = 30;
    int near = 1;
    for (int sweep = 0; sweep < sweeps && near > 0; ++sweep) {
        if (sweep % 10 == 0) violations(x); // makes a new list
        near = 0;
        for (const ListedPair& l : pairs_) {
            if (with_body(kind_of(l))) continue;
            const ContactPair p = pair(l);
            const double room = 2 * barrier(p).floor;
            const PairGeometry g = pair_geometry(corners(x, p), p.edge_edge);
            if (g.d >= room) continue;
            near += g.d <= barrier(p).floor;
            double squares = 0;
            for (const double w : g.weight) squares += w * w;
            for (int k = 0; k < 4; ++k) x[p.p[k]] += g.weight[k] / squares * (1.1 * room - g.d) * g.normal;
        }
    }
    return near;
}

std::vector<ContactPair> Contact::violations(const Points& x) {
    const Stopwatch::Lap lap(clock_);
    built_ = false;
    prepare(x, Eigen::VectorXd::Zero(3 * nodes_));
    std::vector<ContactPair> violated;
    for (const ListedPair& l : pairs_) {
        if (l.built > l.distance) continue;
        const ContactPair p = pair(l);
        if (pair_geometry(corners(x, p), p.edge_edge).d <= barrier(p).floor) violated.push_back(p);
    }
    return violated;
}

void Contact::leave_out(std::vector<char> nodes) {
    left_out_ = std::move(nodes);
    built_ = false;
}

} // namespace toile

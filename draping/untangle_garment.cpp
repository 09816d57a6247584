// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/untangle_garment.h"

#include "draping/cloth.h"
#include "draping/contact/untangle.h"
#include "draping/grow.h"
#include "draping/one_surface.h"
#include "draping/solve/settle.h"
#include "geometry/inside.h"
#include "geometry/intersections.h"
#include "geometry/parallel.h"
#include "geometry/solid.h"
#include "geometry/text.h"
#include "sewing/mesh_grain.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace toile {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int stuck_patience = 2;         // rounds that the body waits where cloth goes through the body and will be in the way
constexpr double hold_stiffness = 3e3;    // Pa/m, of what draws every node to where it was
constexpr double least_altitude = 0.1;    // of a triangle's longest side that its rest shape has
constexpr double closed_gap = 1e-3;       // m, below which a stitch to the inside of an edge is kept closed
constexpr int passes = 3;                 // of taking apart and pressing out, for each reach, while each helps
constexpr double thin_share = 0.45;       // of the body's thickness by which it is drawn in at most
constexpr int rest_iterations = 60;
constexpr double rest_motion = 2e-5;      // m, an iteration's longest motion of cloth that counts as at rest

/// A sheet that keeps its lengths and has no grain.
Fabric plain_sheet() {
    Fabric f;
    f.name = "plain sheet";
    f.density = 0.15;
    f.stretch_warp = f.stretch_weft = 500;
    f.poisson = 0.2;
    f.shear = 200;
    f.bend_warp = f.bend_weft = 1e-5;
    f.bend_twist = 4e-6;
    f.bend_poisson = 0.2;
    f.compression = 1;
    return f;
}

/// Two sides of a triangle laid flat. Slivers are taken for wider than they are, or nothing could be reckoned with them.
Mat2 flat_sides(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const double length = std::max((b - a).norm(), least_altitude * longest);
    const Vec3 along = (b - a).normalized();
    const double foot = (c - a).dot(along);
    const double altitude = std::max(((c - a) - foot * along).norm(), least_altitude * longest);
    Mat2 sides;
    sides << length, foot, 0, altitude;
    return sides;
}

/// The surface as a garment of one panel whose rest shape it is.
Garment at_rest(const TriMesh& mesh, const std::vector<Stitch>& stitches) {
    std::vector<Mat2> edges;
    for (const auto& [a, b, c] : mesh.triangles) edges.push_back(flat_sides(mesh.points[a], mesh.points[b], mesh.points[c]));
    Garment g = mesh_garment(mesh.triangles, int(mesh.points.size()), std::move(edges));
    for (const Stitch& s : stitches)
        if (s.r > 0 && s.r < 1 && stitch_gap(s, mesh.points) < closed_gap) g.stitches.push_back(s);
    return g;
}

/// A body that is one surface, outside by the right-hand rule.
struct Solid {
    TriMesh mesh;
    bool closed = false;
};

Solid solid_of(const TriMesh& body) {
    Solid s{body, false};
    join_equal_points(s.mesh);
    drop_flat_triangles(s.mesh);
    s.closed = !s.mesh.triangles.empty() && border_loops(s.mesh).empty();
    if (s.closed) orient_outward(s.mesh);
    drop_unused_points(s.mesh);
    return s;
}

/// How far it is through the body from each of its points, m; `most` when it is more.
std::vector<double> thickness(const TriMesh& body, const Points& normals, double most) {
    const Bvh tree(triangle_boxes(body.points, body.triangles, 0));
    std::vector<double> through(body.points.size(), most);
    parallel_for(int(body.points.size()), 64, [&](int begin, int end) {
        for (int v = begin; v < end; ++v) {
            const Vec3 &from = body.points[v], to = from - most * normals[v];
            Box box(from);
            box.extend(to);
            tree.overlapping(box, [&](int t) {
                const Triangle& k = body.triangles[t];
                if (std::find(k.begin(), k.end(), v) != k.end()) return;
                if (const auto at = segment_through_triangle(from, to, body.points[k[0]], body.points[k[1]], body.points[k[2]]))
                    through[v] = std::min(through[v], at->along * most);
            });
        }
    });
    return through;
}

/// What is wrong with a state, by exact predicates.
struct Faults {
    int crossings = 0, inside = 0;
    int sum() const { return crossings + inside; }
};

struct Run {
    const UntangleGarmentOptions& options;
    Garment garment; ///< one surface, its own rest shape
    Points start;    ///< of its nodes
    Solid body;
    TangledCloth tangled;
    PanelFabrics fabrics{plain_sheet()};
    Cholesky factor = {};
    Clock::time_point started = Clock::now();
    bool stopped = false;
    double done = 0;
    Points best = {};
    Faults best_faults = {};
    double drawn_in = 0; ///< m, most by which the body was
    int taken_apart = 0; ///< most crossings of edges and triangles that were

    bool tell(const char* stage, double residual) {
        const double seconds = std::chrono::duration<double>(Clock::now() - started).count();
        if (seconds > options.max_seconds) stopped = true;
        if (options.progress) {
            DrapeProgress p;
            p.stage = stage;
            p.residual = residual;
            p.done = done;
            p.seconds_left = std::numeric_limits<double>::infinity();
            if (!options.progress(p)) stopped = true;
        }
        return !stopped;
    }

    Faults faults_of(const Points& x) const {
        const IntersectionCount n = count_intersections(garment.triangles, x, body.mesh, garment.stitches);
        return {n.cloth_avatar + n.cloth_cloth, int(inside(x, body.mesh).size())};
    }

    /// Nodes in the body as it is or drawn in.
    std::vector<int> inside(const Points& x, const TriMesh& solid) const {
        std::vector<int> nodes;
        if (!body.closed) return nodes;
        const std::vector<int> winding = winding_numbers(solid, x);
        for (int i = 0; i < int(x.size()); ++i)
            if (winding[i] > 0) nodes.push_back(i);
        return nodes;
    }

    Faults keep_if_best(const Points& x) {
        const Faults f = faults_of(x);
        if (f.sum() < best_faults.sum()) {
            best = x;
            best_faults = f;
        }
        return f;
    }

    ContactOptions contact_options() const { return barriers_at(options.clearance, fabrics[0].density); }
};

// ---- cloth that crosses itself

/// Parts that have gone through go back as a whole; what has none is shortened, by large motions or by small ones. Each
/// goes on from the best that those before it have reached.
void take_apart(Run& run, Points& x) {
    Contact contact(contact_cloth(run.garment), {}, run.contact_options());
    int least = int(find_crossings(run.tangled, x).size());
    if (least == 0 && contact.violations(x).empty()) return;
    UntangleOptions withdraw{0.3, 1};
    withdraw.withdraw = true;
    for (UntangleOptions how : {withdraw, UntangleOptions{0.4, 8}, UntangleOptions{0.1, 2}}) {
        how.patience = 60;
        how.go_on = [&] { return run.tell("untangle", std::numeric_limits<double>::infinity()); };
        Points trial = x;
        const bool apart = take_apart(run.tangled, contact, trial, how, run.taken_apart);
        const int left = int(find_crossings(run.tangled, trial).size());
        if (apart || left < least) x = trial;
        if (apart) return;
        least = std::min(least, left);
    }
}

/// Nodes to be left out of contact with other cloth.
std::vector<char> tangle_of(const Run& run, const Points& x) {
    Contact contact(contact_cloth(run.garment), {}, run.contact_options());
    return tangle_of(run.tangled, contact, x);
}

// ---- cloth in the body

/// A body on its way back to its full size.
struct Obstacle {
    TriMesh drawn; ///< in
    Points full;   ///< where its points belong
    bool clear = true; ///< of the cloth, without having lost a triangle
};

/// Takes the triangles out of the obstacle that `out` names, and the points that have none left.
void remove_triangles(Obstacle& o, const std::vector<char>& out) {
    std::vector<Triangle> kept;
    for (std::size_t t = 0; t < o.drawn.triangles.size(); ++t)
        if (!out[t]) kept.push_back(o.drawn.triangles[t]);
    TriMesh full{o.full, kept};
    o.drawn.triangles = std::move(kept);
    drop_unused_points(o.drawn);
    drop_unused_points(full);
    o.full = std::move(full.points);
}

/// Takes what the cloth goes through even so out of the obstacle: the cloth cannot be pressed out there.
void remove_what_crosses(const Run& run, const Points& x, Obstacle& o) {
    std::vector<char> out(o.drawn.triangles.size(), 0);
    for (const auto& pair : intersecting_pairs({x, run.garment.triangles}, o.drawn)) out[pair[1]] = 1;
    for (bool any = std::count(out.begin(), out.end(), 1) > 0; any;) {
        remove_triangles(o, out);
        out.assign(o.drawn.triangles.size(), 0);
        any = false;
        if (o.drawn.triangles.empty()) return;
        std::vector<char> near(o.drawn.points.size(), 0);
        ContactOptions alone = run.contact_options();
        alone.self = false;
        Contact contact(contact_cloth(run.garment), o.drawn, alone);
        for (const ContactPair& p : contact.violations(x))
            for (const int i : p.p)
                if (i >= run.garment.node_count) near[i - run.garment.node_count] = 1;
        for (std::size_t t = 0; t < out.size(); ++t)
            for (const int i : o.drawn.triangles[t])
                if (near[i]) {
                    out[t] = 1;
                    any = true;
                }
    }
}

/// The body drawn in until the cloth is clear of it, each point by no more than a share of the body's thickness there.
Obstacle draw_in(Run& run, const Points& x) {
    const TriMesh& body = run.body.mesh;
    const Points normals = vertex_normals(body);
    constexpr double depths[] = {0.0, 0.002, 0.005, 0.01, 0.02, 0.04, 0.08, 0.16, 0.32};
    std::vector<double> through;
    Obstacle o{body, body.points, true};
    ContactOptions alone = run.contact_options();
    alone.self = false;
    Contact contact(contact_cloth(run.garment), body, alone);
    for (const double depth : depths) {
        if (depth > 0 && through.empty()) through = thickness(body, normals, 1.0);
        for (std::size_t v = 0; v < body.points.size(); ++v)
            o.drawn.points[v] = body.points[v] - (depth > 0 ? std::min(depth, thin_share * through[v]) : 0) * normals[v];
        run.drawn_in = std::max(run.drawn_in, depth);
        contact.set_body(o.drawn.points);
        if (!contact.violations(x).empty() || !intersecting_pairs({x, run.garment.triangles}, o.drawn).empty()) continue;
        if (run.inside(x, o.drawn).empty()) return o;
    }
    remove_what_crosses(run, x, o);
    o.clear = false;
    return o;
}

SettleResult settle_some(Run& run, ClothProblem& problem, Points& x, const char* stage, SettleOptions o) {
    o.max_step = std::min(o.max_step, run.tangled.edge_length);
    o.exact_below = 0;
    o.progress = [&, stage](int, double r) { return run.tell(stage, r); };
    return settle(problem, x, run.factor, o);
}

/// Lets the obstacle grow to its full size, pushing the cloth ahead of it.
void grow(Run& run, ClothProblem& problem, const Obstacle& obstacle, Points& x) {
    if (obstacle.full.empty()) return;
    grow_body(problem, obstacle.full, x, obstacle.clear ? grow_patience : stuck_patience, [&](const SettleOptions& o) {
        settle_some(run, problem, x, "grow", o);
        return !run.stopped;
    });
}

/// Every node within some rings of one that is in trouble: crossing, too near, in the body, or moved already. Less than
/// none: all.
std::vector<char> free_nodes(const Run& run, const Points& x, const std::vector<char>& tangle, int rings) {
    std::vector<char> free(x.size(), rings < 0);
    if (rings < 0) return free;
    free = tangle;
    for (std::size_t i = 0; i < x.size(); ++i) free[i] = free[i] || x[i] != run.start[i];
    for (const int i : run.inside(x, run.body.mesh)) free[i] = 1;
    for (const auto& pair : intersecting_pairs({x, run.garment.triangles}, run.body.mesh))
        for (const int i : run.garment.triangles[pair[0]]) free[i] = 1;
    ContactOptions alone = run.contact_options();
    alone.self = false;
    Contact contact(contact_cloth(run.garment), run.body.mesh, alone);
    for (const ContactPair& p : contact.violations(x))
        for (const int i : p.p)
            if (i < run.garment.node_count) free[i] = 1;
    for (int k = 0; k < rings; ++k) {
        const std::vector<char> before = free;
        for (const auto& [a, b] : run.garment.edges.ends) {
            free[a] = free[a] || before[b];
            free[b] = free[b] || before[a];
        }
    }
    return free;
}

/// Springs to where the nodes were, set off by what the sheet itself pulls with there: where nothing is in the way, the
/// cloth rests as it was.
std::vector<HookSpring> holds(const Run& run, ClothProblem& problem) {
    Points pull(run.start.size(), Vec3::Zero());
    sheet_gradient(*problem.sheet(), run.start, pull);
    const std::vector<double> area = contact_cloth(run.garment).node_area;
    std::vector<HookSpring> springs;
    for (int i = 0; i < run.garment.node_count; ++i) {
        const double k = hold_stiffness * area[i];
        springs.push_back({i, run.start[i] + pull[i] / k, Vec3::Ones(), k, std::numeric_limits<double>::max()});
    }
    return springs;
}

/// Presses the cloth out of the body and lets it come to rest with contact.
void press_out(Run& run, Points& x, int rings) {
    const std::vector<char> tangle = tangle_of(run, x);
    const std::vector<char> free = free_nodes(run, x, tangle, rings);
    const Obstacle obstacle = draw_in(run, x);
    const ContactOptions final = run.contact_options();
    ClothProblem problem(run.garment, run.fabrics, obstacle.drawn, while_growing(final));
    problem.sheet()->limits.clear();
    problem.contact().leave_out(tangle);
    for (int i = 0; i < run.garment.node_count; ++i)
        if (!free[i]) problem.pin(i);
    problem.hooks = holds(run, problem);
    for (const Stitch& s : run.garment.stitches) problem.stitches.push_back({s.a, s.b, s.r, 1e5, 1e3});
    grow(run, problem, obstacle, x);
    if (run.stopped) return;
    problem.contact().set_options(final);
    SettleOptions o;
    o.tolerance = 1;
    o.max_iterations = rest_iterations;
    o.still = rest_motion;
    settle_some(run, problem, x, "settle", o);
}

/// The surface without the points that no triangle has.
struct Compact {
    TriMesh mesh;
    std::vector<int> point; ///< of the mesh, by point of the surface; -1: none
    std::vector<Stitch> stitches;
};

Compact compact(const OneSurface& surface) {
    Compact c{surface.mesh, std::vector<int>(surface.mesh.points.size(), -1), {}};
    drop_unused_points(c.mesh);
    for (std::size_t t = 0; t < c.mesh.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) c.point[surface.mesh.triangles[t][k]] = c.mesh.triangles[t][k];
    for (Stitch s : surface.stitches) {
        s.a = c.point[s.a];
        s.b = {c.point[s.b[0]], c.point[s.b[1]]};
        if (s.a >= 0 && s.b[0] >= 0 && s.b[1] >= 0) c.stitches.push_back(s);
    }
    return c;
}

void untangle_all(Run& run) {
    // What moves is kept near what crosses, and let go farther where that is not enough.
    constexpr int reaches[] = {6, 24, -1};
    int tried = 0;
    for (const int rings : reaches) {
        Points x = run.start;
        int last = std::numeric_limits<int>::max();
        run.done = double(tried++) / std::size(reaches);
        for (int pass = 0; pass < passes && !run.stopped; ++pass) {
            take_apart(run, x);
            press_out(run, x, rings);
            const int now = run.keep_if_best(x).sum();
            if (now == 0) return;
            if (now >= last) break;
            last = now;
        }
    }
}

} // namespace

const char* to_string(UntangleStatus status) {
    switch (status) {
    case UntangleStatus::clear: return "clear";
    case UntangleStatus::tangled: return "tangled";
    case UntangleStatus::limit: return "limit";
    }
    return "tangled";
}

Change change_of(const Garment& garment, const Points& before, const Points& after) {
    Change c;
    for (std::size_t i = 0; i < before.size(); ++i) {
        const double d = (after[i] - before[i]).norm();
        c.moved += after[i] != before[i];
        c.mean += d / double(before.size());
        if (d <= c.largest) continue;
        c.largest = d;
        c.at = before[i];
    }
    const double least = mean_length(garment.edges, before) / 10;
    for (const auto& [a, b] : garment.edges.ends) {
        const double was = (before[a] - before[b]).norm(), is = (after[a] - after[b]).norm();
        if (was == is) continue;
        const double change = std::abs(is - was) / std::max(was, least);
        c.edge_mean += change / garment.edges.size();
        if (change <= c.edge_largest) continue;
        c.edge_largest = change;
        c.edge_at = 0.5 * (after[a] + after[b]);
    }
    return c;
}

UntangledGarment untangle_garment(const Garment& garment, const Points& x, const TriMesh& body,
                                  const UntangleGarmentOptions& options) {
    const OneSurface surface = one_surface(garment, x);
    const Compact cloth = compact(surface);
    Garment rest = at_rest(cloth.mesh, cloth.stitches);
    Run run{.options = options, .garment = rest, .start = cloth.mesh.points, .body = solid_of(body),
            .tangled = tangled_cloth(rest, mean_length(rest.edges, cloth.mesh.points))};
    run.best = run.start;
    run.best_faults = run.faults_of(run.start);
    if (run.best_faults.sum() > 0) untangle_all(run);

    UntangledGarment result;
    result.x = x;
    for (std::size_t i = 0; i < x.size(); ++i)
        if (const int p = cloth.point[surface.node[i]]; p >= 0) result.x[i] = run.best[p];
    result.crossings = run.best_faults.crossings;
    result.inside = run.best_faults.inside;
    result.status = run.best_faults.sum() == 0 ? UntangleStatus::clear
                    : run.stopped              ? UntangleStatus::limit
                                               : UntangleStatus::tangled;
    result.change = change_of(garment, x, result.x);
    if (run.taken_apart > 0)
        result.decisions.push_back(text("cloth that crossed itself was taken apart: %d edges passed through triangles", run.taken_apart));
    if (run.drawn_in > 0)
        result.decisions.push_back(text("the body was drawn in by up to %.0f mm and pushed the cloth out as it grew back", 1e3 * run.drawn_in));
    return result;
}

} // namespace toile

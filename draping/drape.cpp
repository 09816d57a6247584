// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/drape.h"

#include "draping/cloth.h"
#include "draping/contact/untangle.h"
#include "draping/decisions.h"
#include "draping/hooks.h"
#include "draping/lay.h"
#include "draping/place.h"
#include "draping/solve/settle.h"
#include "draping/wait.h"
#include "draping/where.h"
#include "geometry/memory.h"
#include "geometry/simplify.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <tuple>

namespace toile {

namespace {

using Clock = std::chrono::steady_clock;

constexpr double seam_stiffness = 500;   // N/m per metre of seam while it is far open
constexpr double seam_pull = 6;          // N per metre of seam: what a far open seam pulls with
constexpr double most_pull = 30;         // times that, to which it grows where a seam does not close
constexpr double stiffest_seam = 2e4;    // N/m per newton that a stitch may pull with
constexpr double weld_gap = 2e-4;        // m, below which a seam is closed for good
constexpr double contact_share = 0.06;   // of the edge length: contact distance of levels that are not the last
constexpr double barrier_stiffness = 1e7; // Pa/m for a cloth of 0.15 kg/m2 at a distance of half a millimetre
constexpr double cloth_stiffness = 0.1;   // of the barrier, between cloth and cloth, which press lightly
constexpr double sewing_softness = 0.1;   // of the barrier while seams are pulled shut, which takes little force
constexpr double body_edge_share = 0.8;  // of the edge length: mean edge of the body on levels that are not the last
constexpr double body_error_share = 0.5; // of their contact distance: by which it may be moved
constexpr double floor_share = 0.1;      // of the contact distance that is never entered
constexpr double grow_distance = 2e-3;   // m, contact distance while the body grows back
constexpr double grow_share = 0.5;       // of the way to the cloth that the body takes at once, lest it get stuck there
constexpr double soft_limit = 0.7;    // turn of the strain limits' barrier that cloth can meet from beyond them
constexpr double hard_limit = 0.9;    // and the one to end with, hardened further where the cloth needs it
constexpr double hardest_limit = 0.998;  // from there on limits are not hardened but
constexpr double least_tighter = 2.5e-4; // drawn in by such shares of theirs
constexpr double most_tighter = 2e-3;
constexpr double gaping = 0.2;           // m, a gap from which cloth hangs by nothing
constexpr double hanging_step = 0.03;    // m, an iteration's longest motion of cloth that hangs down
constexpr int hanging_iterations = 400;  // at most, each of
constexpr int most_hangings = 3;         // times that it does
constexpr double machine_gap = 0.1;      // of the edge length: what sewing by machine leaves behind it
constexpr int machine_patience = 30;     // rounds that it waits for a gap to close
constexpr int machine_stitches = 2;      // sewn at a time
constexpr double slid = 0.10;            // m below its place at which a held edge counts as slid off
constexpr double coarse_compression = 0.2; // of the fabric's, on levels that are not the last
constexpr double coarse_residual = 10;    // to which levels that are not the last are settled

constexpr int untangle_every = 20;      // iterations after which cloth that did not come apart is tried again,
constexpr int most_untangles = 5;       // in each pass
constexpr int most_iterations = 1000;      // of the last pass of a level
constexpr double forced_share = 0.05;    // of the edge length: a gap below which a seam may be joined by force
constexpr double near_share = 0.04;      // and one below which it is, when pulling on closes it slowly
constexpr double inner_stitch_stiffness = 1e5; // N/m, of stitches to the inside of an edge once seams are closed
constexpr double near = 0.9;             // of the memory limit; the rest is for what is taken between two looks
constexpr double growth = 1.2;           // power of the vertices with which memory grows; factors outgrow meshes
constexpr double least_bytes = 5e3;      // times that power: what a level takes, before more was seen
constexpr double tight = 2e-3;           // m by which a section must be too short to count as too small

double total(const std::vector<double>& v) {
    double sum = 0;
    for (double e : v) sum += e;
    return sum;
}

std::string text(const char* format, auto... values) {
    char buffer[512];
    std::snprintf(buffer, sizeof buffer, format, values...);
    return buffer;
}

Points vertex_normals(const TriMesh& mesh) {
    Points n(mesh.points.size(), Vec3::Zero());
    for (const Triangle& t : mesh.triangles) {
        const Vec3 a = (mesh.points[t[1]] - mesh.points[t[0]]).cross(mesh.points[t[2]] - mesh.points[t[0]]);
        for (int i : t) n[i] += a;
    }
    for (Vec3& v : n) v.normalize();
    return n;
}

double mean_gap(const Garment& g, const Points& x) {
    double sum = 0;
    for (const Stitch& s : g.stitches) sum += stitch_gap(s, x);
    return g.stitches.empty() ? 0 : sum / double(g.stitches.size());
}

/// One drape on its way: what the stages share.
struct Run {
    const Staging& staging;
    const TriMesh& avatar;
    const PanelFabrics& fabrics;
    const DrapeOptions& options;
    DrapeResult result = {};

    Clock::time_point started = Clock::now();
    MemoryUse memory_before = memory_use();
    double used_before = 0, per_power = least_bytes; ///< see fits_memory()
    double density = 0;
    bool stopped = false;      ///< by the caller or by time
    std::string stopped_by = {};
    int iterations_left = 0;
    double share_begin = 0, share_end = 0; ///< of the whole, of the stage at work
    double done = 0;
    std::string stage = {};
    int level = 0;

    TriMesh body = {};         ///< that the level at work touches, see choose_body()
    Garment garment = {};      ///< of the level at work, closed
    std::vector<int> joined = {}; ///< its node of every one of the open garment, on the coarsest level
    Points x = {};             ///< its nodes
    Laid laid = {};            ///< the coarsest level where it starts out
    bool grown = true;         ///< the body has its full size
    std::vector<std::string> held = {}, carried = {}; ///< labels of hooks that stay, and of those that are let go
    std::map<std::string, double> carried_at = {}; ///< mean height of each of these where the file puts it
    bool open = false;         ///< a seam could not be closed
    DrapeFacts facts = {};

    double seconds() const { return std::chrono::duration<double>(Clock::now() - started).count(); }
    int levels() const { return int(staging.levels.size()); }
    double edge_length() const { return staging.levels[level].edge_length; }
    bool last_level() const { return level + 1 == levels(); }

    void begin(const char* name, double share) {
        stage = name;
        share_begin = share_end;
        share_end = std::min(1.0, share_begin + share);
    }

    void stop(const std::string& by) {
        stopped = true;
        if (stopped_by.empty())
            stopped_by = text("stopped by %s after %.3g s at the stage ", by.c_str(), seconds()) + stage;
    }

    /// What is in use, or was for a moment since the drape began.
    double memory() const {
        const MemoryUse use = memory_use();
        return use.peak > memory_before.peak ? use.peak : use.now;
    }

    /// Stops the run when level `next` would not fit. What it adds is estimated from what `last`, the level before it,
    /// has added.
    bool fits_memory(int next, int last = -1) {
        const auto power = [&](int l) {
            return l < 0 ? 0.0 : std::pow(double(staging.levels[l].garment.uv.size()), growth);
        };
        const double used = memory();
        if (last > 0) per_power = std::max(per_power, (used - used_before) / (power(last) - power(last - 1)));
        used_before = used;
        const double needed = used + per_power * (power(next) - power(last));
        if (needed > options.max_memory)
            stop(text("the memory limit of %.0f MB, before level %d would have taken about %.0f MB,",
                      options.max_memory / 1e6, next + 1, needed / 1e6));
        return !stopped;
    }

    bool tell(double within, double residual) {
        done = std::max(done, share_begin + (share_end - share_begin) * std::clamp(within, 0.0, 1.0));
        const double so_far = seconds();
        if (so_far > options.max_seconds) stop("the time limit");
        if (const double used = memory(); used > near * options.max_memory)
            stop(text("the memory limit of %.0f MB, with %.0f MB in use,", options.max_memory / 1e6, used / 1e6));
        if (options.progress) {
            DrapeProgress p;
            p.stage = stage;
            p.level = level;
            p.levels = levels();
            p.residual = residual;
            p.done = done;
            p.seconds_left = done > 0.02 ? so_far * (1 - done) / done : std::numeric_limits<double>::infinity();
            if (!options.progress(p)) stop("the caller");
        }
        return !stopped;
    }

    /// Settles and books the work on the level.
    SettleResult settle_some(ClothProblem& problem, Points& at, Cholesky& factor, SettleOptions o) {
        o.max_iterations = std::min(o.max_iterations, iterations_left);
        o.max_step = std::min(o.max_step, edge_length()); // farther, and lists of what may touch grow too long
        const double from = share_begin, span = share_end - share_begin;
        o.progress = [&, base = done](int i, double r) {
            const double within = (base - from) / std::max(span, 1e-9);
            return tell(within + (1 - within) * (1 - std::exp(-i / 60.0)), r);
        };
        const SettleResult r = settle(problem, at, factor, o);
        result.residual = r.residual;
        iterations_left -= r.iterations;
        result.levels.back().iterations += r.iterations;
        result.levels.back().factorisations += r.factorisations;
        return r;
    }

    /// A coarse mesh cannot fold as finely as the cloth would and must be let shrink instead, or it locks.
    PanelFabrics level_fabrics() const {
        PanelFabrics level = fabrics;
        if (!last_level())
            for (Fabric& f : level) f.compression *= coarse_compression;
        return level;
    }

    ContactOptions contact_options() const {
        const double distance = last_level() ? options.clearance
                                             : std::max(options.clearance,
                                                        contact_share * edge_length());
        ContactOptions c;
        c.body.distance = distance;
        c.body.floor = floor_share * distance;
        c.body.stiffness = barrier_stiffness * std::max(0.05, density) / 0.15 * (0.5e-3 / distance);
        c.cloth = c.body;
        c.cloth.stiffness *= cloth_stiffness;
        return c;
    }
};

/// A level touches the body that it can tell from the avatar: the last the avatar itself, the others one of triangles
/// like theirs.
void choose_body(Run& run) {
    run.body = run.last_level() ? run.avatar
                                : simplified(run.avatar, body_edge_share * run.edge_length(),
                                             body_error_share * run.contact_options().body.distance);
}

/// Hooks with no more than twice the garment's weight in all, or what its open seams pull with.
std::vector<HookSpring> hooks_on(const Run& run, const Garment& g, const std::vector<std::string>& labels,
                                 const ClothProblem& problem) {
    std::map<std::string, double> heights;
    for (const std::string& label : labels) heights[label] = run.carried_at.at(label);
    double strength = 2 * 9.81 * total(problem.node_mass());
    for (const Stitch& s : g.stitches) strength += seam_pull * s.length;
    return make_hooks(g, heights, strength);
}

std::vector<std::string> all_hooked(const Run& run) {
    std::vector<std::string> all = run.held;
    all.insert(all.end(), run.carried.begin(), run.carried.end());
    return all;
}

/// Which edges hooks hold, and at what height.
void choose_hooks(Run& run) {
    const StagedLevel& staged = run.staging.levels[run.level];
    const std::vector<std::string> labels = labels_of(staged.garment);
    for (const std::string& word : run.options.hold)
        for (const std::string& label : labels_called(word, labels))
            if (std::find(run.held.begin(), run.held.end(), label) == run.held.end()) run.held.push_back(label);
    for (const std::string& label : labels)
        if (carries(label) && std::find(run.held.begin(), run.held.end(), label) == run.held.end())
            run.carried.push_back(label);
    const bool anew = run.level == 0 && !run.laid.x.empty();
    run.carried_at = label_heights(staged.garment, anew ? run.laid.x : staged.placed, all_hooked(run));
}

/// What acts on a closed garment at every level beside cloth, contact and weight: pins, bands, hooks that stay and
/// stitches that cannot become shared nodes.
void add_fixtures(Run& run, ClothProblem& problem) {
    for (const auto& [node, place] : pinned_places(run.staging, run.level, run.garment)) {
        problem.pin(node);
        run.x[node] = place;
    }
    problem.elastics = elastic_segments(run.staging, run.garment);
    problem.hooks = hooks_on(run, run.garment, run.held, problem);
    for (const Stitch& s : run.garment.stitches)
        problem.stitches.push_back({s.a, s.b, s.r, inner_stitch_stiffness, 1e3});
}

/// Bands are softened with the cloth, which they would crumple otherwise.
void soften(const Run& run, ClothProblem& problem, double softness) {
    problem.sheet().softness = softness;
    problem.elastics = elastic_segments(run.staging, run.garment);
    for (ElasticSegment& s : problem.elastics) s.stiffness *= softness;
}

void note_release(Run& run) {
    const std::map<std::string, double> now = label_heights(run.garment, run.x, run.carried);
    for (const std::string& label : run.carried)
        run.facts.hooks.push_back({label, false, run.carried_at[label], now.at(label), 0});
}

/// Whether cloth at this height, or nearer to it than `reach`, touches the body.
bool touches_body(const ClothProblem& problem, const Points& x, double height, double reach) {
    const Points force = problem.contact().body_forces(problem.contact().active(x));
    for (std::size_t i = 0; i < x.size(); ++i)
        if (force[i].squaredNorm() > 0 && std::abs(x[i].y() - height) < reach) return true;
    return false;
}

/// The pairs that touch at x.
std::vector<ContactPair> touching_pairs(const ClothProblem& problem, const Points& x) {
    std::vector<ContactPair> pairs;
    for (const ActivePair& a : problem.contact().active(x)) pairs.push_back(problem.contact().pair(a.pair));
    return pairs;
}

/// Merges the nodes of closed seams; every group of nodes goes to its mean.
Points merge(const Garment& closed, const std::vector<int>& map, const Points& x) {
    Points merged(closed.node_count, Vec3::Zero());
    std::vector<int> count(closed.node_count, 0);
    for (std::size_t i = 0; i < x.size(); ++i) {
        merged[map[i]] += x[i];
        ++count[map[i]];
    }
    for (int i = 0; i < closed.node_count; ++i) merged[i] /= count[i];
    return merged;
}

/// Closes the stitches that are as good as closed and leaves the others open.
void close_what_is_closed(Run& run, const Garment& open, const Points& x) {
    Garment closable = open;
    const auto gapes = [&](const Stitch& s) {
        return stitch_gap(s, x) >= weld_gap;
    };
    std::erase_if(closable.stitches, gapes);
    std::vector<int> map;
    run.garment = close_seams(closable, &map);
    for (Stitch s : open.stitches) {
        if (!gapes(s)) continue;
        s.a = map[s.a], s.b = {map[s.b[0]], map[s.b[1]]};
        run.garment.stitches.push_back(s);
    }
    run.x = merge(run.garment, map, x);
}

/// Lets the body grow on straight lines from where it is to its full size, pushing the cloth ahead of it. Returns
/// whether it got there.
bool grow(Run& run, ClothProblem& problem, Points& x, Cholesky& factor) {
    Contact& contact = problem.contact();
    SettleOptions o;
    o.tolerance = 1;
    o.max_iterations = 3;
    o.exact_below = 0;
    const Eigen::VectorXd still = Eigen::VectorXd::Zero(3 * problem.points());
    bool grown = false;
    for (int k = 0; k < 200 && !run.stopped && !grown; ++k) {
        Points motion(run.body.points.size());
        double longest = 0;
        for (std::size_t v = 0; v < motion.size(); ++v) {
            motion[v] = run.body.points[v] - contact.body()[v];
            longest = std::max(longest, motion[v].norm());
        }
        const double part = std::min(1.0, 2 * contact.options().body.distance / longest);
        for (Vec3& m : motion) m *= part;
        contact.prepare(x, still, &motion);
        double t = contact.feasible_step(x, still, &motion);
        if (t < 1) t *= grow_share;
        grown = part * t == 1;
        Points next = contact.body();
        for (std::size_t v = 0; v < motion.size(); ++v) next[v] = grown ? run.body.points[v] : Vec3(next[v] + t * motion[v]);
        contact.set_body(next);
        run.settle_some(problem, x, factor, o);
    }
    return grown;
}

/// Pairs of triangles of a closed garment that cross.
int crossings(const Garment& closed, const Points& x) {
    return count_intersections(node_triangles(closed), x, {}, closed.stitches).cloth_cloth;
}

/// The same of what is sewn, when its seams are joined as they are.
int crossings_when_joined(const Run& run, const Points& x) {
    return crossings(run.garment, merge(run.garment, run.joined, x));
}

/// Pulls the seams of the coarsest level shut around the body; returns the widest gap left, m.
double close_open_seams(Run& run, const Garment& open, ClothProblem& problem, Points& x, Cholesky& factor) {
    SettleOptions o;
    o.tolerance = 1e-2;
    o.max_iterations = 6;
    o.exact_below = 0;
    constexpr int rounds = 60;
    double last = std::numeric_limits<double>::infinity(), last_mean = last, cap_scale = 1;
    int locked = 0;
    for (int round = 0; round < rounds && !run.stopped; ++round) {
        o.time_step = std::min(0.02 * std::pow(2.0, round / 3), 1.0);
        run.settle_some(problem, x, factor, o);
        const double gap = seam_gap_max(open, x);
        if (gap < weld_gap) return gap;
        // The last tenths of a millimetre may take as long as all the rest, where cloth is sewn to bulky cloth.
        if (gap < near_share * run.edge_length() && gap > 0.8 * last && crossings_when_joined(run, x) == 0) return gap;
        // A seam that does not pull with all it may is pulled harder.
        for (auto& s : problem.stitches)
            if (s.stiffness * gap < s.cap) s.stiffness = std::min(3 * s.stiffness, stiffest_seam * s.cap);
        // One place that waits must not end what still goes on elsewhere; where pulling harder moves nothing at
        // all, something is in the way.
        const double mean = mean_gap(open, x);
        locked = std::min(gap / last, mean / last_mean) > 0.995 ? locked + 1 : 0;
        if (locked == 4) return gap;
        if (gap > 0.95 * last) {
            if (cap_scale > most_pull && mean > 0.95 * last_mean) return gap;
            if (cap_scale <= most_pull) {
                cap_scale *= 1.5;
                for (auto& s : problem.stitches) s.cap *= 1.5;
            }
        }
        last = gap;
        last_mean = mean;
    }
    return last;
}

/// A start of the coarsest level.
struct Start {
    double lift = 0; ///< m, by which the garment was moved up as a whole
    PlacedClear placed;
};

/// How seams are closed.
struct Sewing {
    bool self = true; ///< with contact between panels
    Waiting waiting;  ///< until the other seams are closed and the cloth hangs
};

struct Sewn {
    Start start;
    Sewing way;
    Points x;                ///< nodes of the open garment
    double gap = 0;          ///< m, the widest that is left
    int crossings = 0;       ///< pairs of triangles of the closed garment
    bool open = false;       ///< it is too wide to be joined
    DrapeStatus status = DrapeStatus::stalled; ///< if it is open, and
    std::string where = {};  ///< what keeps it so
};

/// A seam stays open because its cloth does not reach round the body, or because something is in the way.
void note_open_seam(const Run& run, const ClothProblem& problem, Sewn& sewn) {
    const Garment& open = run.staging.levels[0].garment;
    const double missing = missing_at_open_seam(open, sewn.x, run.fabrics);
    const int s = widest_stitch(open, sewn.x);
    const double height = sewn.x[open.stitches[s].a].y();
    const bool small = missing > tight && touches_body(problem, sewn.x, height, run.edge_length());
    sewn.status = small ? DrapeStatus::too_small : DrapeStatus::stalled;
    sewn.where = open_seam(open, sewn.x, run.staging.seam_names, run.body, touching_pairs(problem, sewn.x));
    if (small)
        sewn.where += text("; with the fabric stretched to its limit %.1f cm are missing round the garment there",
                           100 * missing);
}

std::vector<bool> pinned_panels(const Run& run) {
    std::vector<bool> pinned(run.staging.levels[0].garment.panel_names.size(), false);
    for (const Pin& pin : run.staging.pins) pinned[pin.span.panel] = true;
    return pinned;
}

/// Lays panels anew that lie far from what they are sewn to.
void lay(Run& run) {
    const StagedLevel& staged = run.staging.levels[0];
    LayOptions o;
    o.fixed = pinned_panels(run);
    run.laid = lay_anew(staged.garment, staged.placed, run.body, o);
    for (const LaidPanel& p : run.laid.moved)
        run.result.decisions.push_back(
            text("panel \"%s\" was moved %.0f mm and turned %.0f degrees before sewing, to what it is sewn to",
                 staged.garment.panel_names[p.panel].c_str(), 1e3 * p.moved, p.turned * 180 / EIGEN_PI));
}

void note_pushes(Run& run, const PlacedClear& placed) {
    const std::vector<std::string>& names = run.staging.levels[0].garment.panel_names;
    for (const PanelPush& p : placed.pushed)
        run.result.decisions.push_back(text("panel \"%s\" was moved %.0f mm %s before sewing",
                                            names[p.panel].c_str(), 1e3 * p.push.norm(),
                                            p.from_body ? "out of the body" : "clear of another panel"));
}

Start place(const Run& run, double lift, const std::vector<bool>& outside = {}) {
    Points lifted = run.laid.x;
    for (Vec3& p : lifted) p.y() += lift;
    PlaceOptions o;
    o.fixed = pinned_panels(run);
    o.outside = outside;
    return {lift, place_clear(run.staging.levels[0].garment, lifted, run.body, o)};
}

SettleOptions hanging_options() {
    SettleOptions o;
    o.max_step = hanging_step;
    o.exact_below = 0;
    return o;
}

void start_to_pull(ClothProblem& problem, const Garment& open, int stitch) {
    const double length = open.stitches[stitch].length;
    problem.stitches[stitch].stiffness = seam_stiffness * length;
    problem.stitches[stitch].cap = seam_pull * length;
}

/// Lets what is sewn hang down until the body is no longer between the sides of seams that wait.
void hang(Run& run, const Garment& open, const Waiting& waiting, ClothProblem& problem, Points& x, Cholesky& factor) {
    SettleOptions o = hanging_options();
    o.tolerance = 1;
    o.max_iterations = 20;
    problem.gravity = run.options.gravity;
    for (int k = 0; k < hanging_iterations / o.max_iterations && !run.stopped; ++k) {
        run.settle_some(problem, x, factor, o);
        const std::vector<char> through = seams_through_body(open, x, run.body);
        bool in_the_way = false;
        for (std::size_t s = 0; s < through.size(); ++s) in_the_way = in_the_way || (through[s] && waiting.seams[s]);
        if (!in_the_way) break;
    }
    problem.gravity = 0;
}

/// When a seam is sewn: what lies inside first, then what hangs from it, then the sides that wait until it hangs.
int turn_of(const Garment& open, const Waiting& waiting, const Stitch& s) {
    if (waiting.seams.empty()) return 0;
    if (waiting.seams[s.seam]) return 2;
    return waiting.outside[open.panel_of_vertex[s.a]] || waiting.outside[open.panel_of_vertex[s.b[0]]];
}

/// A seam that is sewn stitch by stitch.
struct MachineSeam {
    std::vector<int> stitches = {}; ///< of the garment, in the order of sewing
    std::size_t sewn = 0;           ///< of them pull
};

/// Lets the next stitches of a seam pull, if what is sewn of it has closed, and pulls harder on what has not. A seam
/// begins at an end that is closed on. Returns whether there were any.
bool sew_on(const Run& run, const Garment& open, MachineSeam& seam, ClothProblem& problem, const Points& x) {
    const auto gap = [&](int k) { return stitch_gap(open.stitches[k], x); };
    if (seam.sewn == 0) {
        if (gap(seam.stitches.back()) < gap(seam.stitches.front()))
            std::reverse(seam.stitches.begin(), seam.stitches.end());
        if (gap(seam.stitches.front()) > run.edge_length()) return false;
    }
    const double near = machine_gap * run.edge_length();
    bool closed = true;
    for (std::size_t n = 0; n < seam.sewn; ++n) {
        const int k = seam.stitches[n];
        closed = closed && gap(k) < near;
        if (gap(k) < 0.2 * near) continue;
        auto& spring = problem.stitches[k];
        spring.cap = std::min(1.2 * spring.cap, most_pull * seam_pull * open.stitches[k].length);
        spring.stiffness = std::min(1.5 * spring.stiffness, stiffest_seam * spring.cap);
    }
    const std::size_t next = closed ? std::min(seam.sewn + machine_stitches, seam.stitches.size()) : seam.sewn;
    const bool any = next > seam.sewn;
    for (; seam.sewn < next; ++seam.sewn) start_to_pull(problem, open, seam.stitches[seam.sewn]);
    return any;
}

/// Sews waiting seams as on a machine, each after the one that it follows on: sides pulled shut all along at once
/// pinch the folds that hang between them.
void sew_by_machine(Run& run, const Garment& open, const Waiting& waiting, ClothProblem& problem, Points& x,
                    Cholesky& factor) {
    std::vector<MachineSeam> seams(waiting.seams.size());
    for (std::size_t k = 0; k < open.stitches.size(); ++k)
        if (waiting.seams[open.stitches[k].seam]) seams[open.stitches[k].seam].stitches.push_back(int(k));
    std::erase_if(seams, [](const MachineSeam& s) { return s.stitches.empty(); });
    SettleOptions o = hanging_options();
    o.tolerance = 1e-2;
    o.max_iterations = 4;
    o.time_step = 0.1;
    problem.gravity = run.options.gravity;
    for (int waited = 0; waited < machine_patience && !run.stopped; ++waited) {
        bool all = true;
        for (MachineSeam& s : seams) {
            if (sew_on(run, open, s, problem, x)) waited = 0;
            all = all && s.sewn == s.stitches.size();
        }
        run.settle_some(problem, x, factor, o);
        if (all) break;
    }
    problem.gravity = 0;
}

Sewn sew_open(Run& run, const Start& start, const Sewing& way) {
    const Garment& open = run.staging.levels[0].garment;
    Sewn sewn{start, way, start.placed.x};
    ContactOptions contact = run.contact_options();
    contact.self = way.self;
    contact.body.stiffness *= sewing_softness;
    contact.cloth.stiffness *= sewing_softness;
    ClothProblem problem(open, run.fabrics, run.body, contact);
    problem.sheet().softness = 1.0 / 16;
    if (start.lift == 0) problem.hooks = hooks_on(run, open, all_hooked(run), problem);
    for (const auto& [node, place] : pinned_places(run.staging, 0, open)) problem.pin(node);
    Cholesky factor;
    for (const Stitch& s : open.stitches) problem.stitches.push_back({s.a, s.b, s.r, 0, 0});
    // What has been closed keeps what it took to close it.
    const auto close = [&](int turn) {
        Garment some = open;
        some.stitches.clear();
        for (std::size_t k = 0; k < open.stitches.size(); ++k) {
            const Stitch& s = open.stitches[k];
            const int its = turn_of(open, way.waiting, s);
            if (its > turn) continue;
            some.stitches.push_back(s);
            if (its < turn || problem.stitches[k].stiffness > 0) continue;
            start_to_pull(problem, open, int(k));
        }
        return close_open_seams(run, some, problem, sewn.x, factor);
    };
    const bool some_wait = !way.waiting.seams.empty();
    double gap = close(0);
    if (some_wait) gap = close(1);
    for (int k = 0; some_wait && k < most_hangings && gap < gaping && !run.stopped; ++k) {
        hang(run, open, way.waiting, problem, sewn.x, factor);
        if (k == 0) sew_by_machine(run, open, way.waiting, problem, sewn.x, factor);
        gap = close(2);
        if (gap < forced_share * run.edge_length()) break;
    }
    sewn.gap = seam_gap_max(open, sewn.x); // of those that wait as well, if it was stopped before their turn
    sewn.open = sewn.gap >= forced_share * run.edge_length();
    if (sewn.open) note_open_seam(run, problem, sewn);
    return sewn;
}

/// Places and sews the coarsest level: where the file puts the garment, else moved up or down as a whole to where
/// fewer threads pass through the body. The cloth may pass through itself on the way when it cannot close otherwise;
/// what counts is that the sewn garment does not cross itself.
void sew_coarsest(Run& run) {
    const auto start = Clock::now();
    const StagedLevel& staged = run.staging.levels[0];
    run.result.levels.push_back({staged.edge_length, int(staged.garment.uv.size()), 0, 0, 0});
    run.begin("sew", 0.15);
    if (!run.fits_memory(0)) {
        run.open = true;
        close_what_is_closed(run, staged.garment, staged.placed);
        return;
    }
    run.garment = close_seams(staged.garment, &run.joined);
    Sewn sewn;
    const auto closes = [&](const Start& from, const Sewing& way) {
        Sewn next = sew_open(run, from, way);
        next.crossings = crossings_when_joined(run, next.x);
        const auto badness = [](const Sewn& s) { return std::tuple(s.open, s.open ? 0 : s.crossings, s.gap); };
        if (sewn.x.empty() || badness(next) < badness(sewn)) sewn = std::move(next);
        return run.stopped || (!sewn.open && sewn.crossings == 0);
    };
    const Start as_filed = place(run, 0);
    bool done = closes(as_filed, {true, {}});
    done = done || closes(as_filed, {false, {}});
    const Waiting waiting = done || !sewn.open ? Waiting()
                                               : what_waits(staged.garment, sewn.x, run.body, forced_share * run.edge_length());
    if (!done && sewn.open && run.staging.pins.empty())
        if (const double lift = free_height(staged.garment, run.laid.x, run.body); lift != 0) {
            const Start lifted = place(run, lift);
            done = closes(lifted, {true, {}}) || closes(lifted, {false, {}});
        }
    if (!done && sewn.open && !waiting.seams.empty()) closes(place(run, 0, waiting.outside), {true, waiting});
    run.x = merge(run.garment, run.joined, sewn.x);
    if (sewn.start.lift != 0)
        run.result.decisions.push_back(
            text("the garment was moved %s by %.0f mm before sewing: where the file puts it threads of seams that "
                 "could not close pass through the body",
                 sewn.start.lift > 0 ? "up" : "down", 1e3 * std::abs(sewn.start.lift)));
    note_pushes(run, sewn.start.placed);
    run.open = sewn.open;
    if (run.open) { // joined by force it would cut itself or the body
        run.result.status = sewn.status;
        run.result.where = sewn.where;
        close_what_is_closed(run, staged.garment, sewn.x);
    } else if (!run.stopped) {
        if (!sewn.way.waiting.seams.empty())
            run.result.decisions.push_back("seams with the body in their way were sewn when the others were closed and the cloth "
                                           "hung down: all at once could not close");
        if (!sewn.way.self && sewn.crossings == 0)
            run.result.decisions.push_back("cloth passed through itself while seams closed: with contact "
                                           "between panels a seam could not close; the sewn garment does "
                                           "not cross itself (0 pairs)");
        if (sewn.gap >= weld_gap)
            run.result.decisions.push_back(
                text("seams were joined when %.1f mm were left of them, on a mesh of %.0f mm: the rest closed slowly, and "
                     "what was joined crosses itself in %d pairs",
                     1e3 * sewn.gap, 1e3 * run.edge_length(), sewn.crossings));
    }
    const double s = std::chrono::duration<double>(Clock::now() - start).count();
    run.result.levels.back().seconds += s;
    run.result.seconds.push_back({"sew", s});
}

/// Carries the drape of one level to the next finer one.
void refine(Run& run) {
    const Garment coarse = std::move(run.garment);
    const StagedLevel& staged = run.staging.levels[run.level];
    run.garment = close_seams(staged.garment);
    Points fine(run.garment.node_count, Vec3::Zero());
    std::vector<int> count(run.garment.node_count, 0);
    for (std::size_t v = 0; v < run.garment.uv.size(); ++v) {
        const Interpolation& p = run.staging.prolongation[run.level - 1][v];
        const int node = run.garment.node_of_vertex[v];
        for (int k = 0; k < 3; ++k) fine[node] += p.weight[k] * run.x[coarse.node_of_vertex[p.from[k]]];
        ++count[node];
    }
    for (int i = 0; i < run.garment.node_count; ++i) fine[i] /= count[i];
    run.x = std::move(fine);
    run.result.levels.push_back({staged.edge_length, int(run.garment.uv.size()), 0, 0, 0});
}

/// Draws the body in until the cloth is clear of it, and lets it grow back under contact. Fine triangles cut the
/// creases and curves of the coarse ones they come from, by a millimetre or so.
void clear_of_body(Run& run, ClothProblem& problem, Cholesky& factor) {
    const ContactOptions final = problem.contact().options();
    ContactOptions wide = final; // a body that grows pushes cloth along, the farther per step the wider
    wide.body.distance = std::max(final.body.distance, grow_distance);
    wide.body.floor = floor_share * final.body.distance;
    wide.body.stiffness *= final.body.distance / wide.body.distance;
    problem.contact().set_options(wide);
    const std::vector<Triangle> cloth = node_triangles(run.garment);
    const Points normals = vertex_normals(run.body);
    TriMesh drawn = run.body;
    double depth = 0;
    for (const double d : {0.0, 0.002, 0.005, 0.01, 0.02, 0.04}) {
        depth = d;
        for (std::size_t v = 0; v < drawn.points.size(); ++v) drawn.points[v] = run.body.points[v] - d * normals[v];
        problem.contact().set_body(drawn.points);
        if (problem.contact().violations(run.x).empty() &&
            count_intersections(cloth, run.x, drawn).cloth_avatar == 0)
            break;
    }
    run.grown = depth == 0;
    run.facts.drawn_in.push_back(depth);
    run.begin("grow", 0);
    run.grown = run.grown || grow(run, problem, run.x, factor);
    problem.contact().set_options(final);
}

TangledCloth tangled_cloth(const Run& run) {
    ContactCloth cloth = contact_cloth(run.garment);
    return {std::move(cloth.triangles), run.garment.edges, run.edge_length(), std::move(cloth.sewn_to_edge)};
}

/// Cloth that crosses itself after sewing, or only on the finer mesh, is taken apart before contact takes over.
/// Returns whether nothing crosses and nothing is too near.
bool take_apart(Run& run, Contact& contact, const UntangleOptions& how) {
    const TangledCloth tangled = tangled_cloth(run);
    for (int round = 0; round < 10; ++round) {
        const Untangled u = untangle(tangled, run.x, how);
        run.facts.untangled = std::max(run.facts.untangled, u.before);
        if (u.after > 0) return false;
        if (contact.widen(run.x) == 0 && find_crossings(tangled, run.x).empty()) return true;
    }
    return false;
}

/// What crosses or is too near is left out of contact with other cloth.
void leave_out_tangle(const Run& run, Contact& contact) {
    std::vector<char> tangle(run.garment.node_count, 0);
    const std::vector<Triangle> triangles = node_triangles(run.garment);
    for (const ClothCrossing& c : find_crossings(tangled_cloth(run), run.x)) {
        for (const int i : run.garment.edges.ends[c.edge]) tangle[i] = 1;
        for (const int i : triangles[c.triangle]) tangle[i] = 1;
    }
    contact.leave_out({});
    for (const ContactPair& p : contact.violations(run.x))
        if (!p.with_body)
            for (const int i : p.p) tangle[i] = 1;
    contact.leave_out(tangle);
}

/// Takes the cloth apart unless that would push it into the body; what then still crosses is left out of contact, and
/// false returned.
bool take_apart_or_leave_out(Run& run, Contact& contact) {
    const std::vector<Triangle> cloth = node_triangles(run.garment);
    const auto in_body = [&](const Points& x) { return count_intersections(cloth, x, run.body).cloth_avatar; };
    const Points before = run.x;
    // A few crossings in a tight place need small motions, folds that lie in each other large ones. A level starts
    // with some of the cloth in the body, where fine triangles cut the curves of coarse ones.
    for (const UntangleOptions& how : {UntangleOptions{0.4, 8}, UntangleOptions{0.1, 2}}) {
        contact.leave_out({});
        if (take_apart(run, contact, how) && (run.x == before || in_body(run.x) <= 2 * in_body(before))) return true;
        run.x = before;
    }
    leave_out_tangle(run, contact);
    return false;
}

/// Says where a drape that has not converged is held up: too little cloth, what blocks the step, or the worst force.
void note_where(Run& run, const ClothProblem& problem, const SettleResult& r) {
    std::string& where = run.result.where;
    where = text("residual %.3g on ", r.residual) + place_of_node(run.garment, run.x, problem.worst_node());
    if (r.end == SettleEnd::stalled && problem.blocking_pair() >= 0)
        where += "; no step is possible, " +
                 place_of_pair(run.garment, run.x, problem.contact().pair(problem.blocking_pair())) + " is in the way";
    const Tightness t = find_tightness(run.garment, run.x, run.fabrics);
    if (t.triangle < 0) return;
    const std::string stretched =
        place_of_triangle(run.garment, run.x, t.triangle) +
        text(" is stretched by %.1f %% along the %s, more than the %.1f %% that ", 100 * t.strain,
             t.warp ? "warp" : "weft", 100 * t.limit) +
        run.fabrics[run.garment.panel_of_triangle[t.triangle]].name + " allows";
    if (t.missing > tight && run.result.status == DrapeStatus::stalled &&
        touches_body(problem, run.x, run.x[run.garment.nodes(t.triangle)[0]].y(), run.edge_length()))
        run.result.status = DrapeStatus::too_small;
    where = stretched + (t.missing > tight ? text("; %.1f cm are missing round the garment there", 100 * t.missing)
                                           : "; " + where);
}

void note_facts(Run& run, const ClothProblem& problem) {
    DrapeFacts& f = run.facts;
    f.touch = count_touching(problem.contact(), run.x);
    f.friction = run.result.friction;
    f.clearance = run.options.clearance;
    f.pins = int(pinned_places(run.staging, run.level, run.garment).size());
    f.band_segments = int(problem.elastics.size());
    for (const ElasticSegment& s : problem.elastics) {
        f.band_rest += s.rest;
        f.band_length += (run.x[s.b] - run.x[s.a]).norm();
        f.band_pull = std::max(f.band_pull, s.stiffness * strain(s, run.x));
    }
    f.inner_stitches = int(run.garment.stitches.size());
    f.inner_gap = seam_gap_max(run.garment, run.x);
}

/// Settles on where cloth at rest is beyond its limits: these are hardened, and where the coordinates' last digits no
/// longer tell the forces of harder ones, drawn in by what the cloth is beyond them.
SettleResult settle_within_limits(Run& run, ClothProblem& problem, Cholesky& factor, const SettleOptions& o,
                                  SettleResult r) {
    double turn = hard_limit;
    const auto again = [&](double tighter) {
        problem.limit_strain(turn, tighter);
        r = run.settle_some(problem, run.x, factor, o);
    };
    const auto beyond = [&] { return !run.stopped && !problem.beyond_limits(run.x).empty(); };
    while (beyond() && turn < hardest_limit) {
        turn = 1 - (1 - turn) / 3;
        again(0);
    }
    for (double tighter = least_tighter; beyond() && tighter < most_tighter; tighter *= 2) again(tighter);
    return r;
}

/// Brings one level to rest: softened membrane first, whose longer steps find the lower drape.
void settle_level(Run& run) {
    const auto start = Clock::now();
    const ContactOptions contact = run.contact_options();
    ClothProblem problem(run.garment, run.level_fabrics(), run.body, contact);
    problem.gravity = run.options.gravity;
    add_fixtures(run, problem);
    Cholesky factor;
    const bool first = run.level == 0;
    const std::vector<HookSpring> kept = problem.hooks;
    if (first) problem.hooks = hooks_on(run, run.garment, all_hooked(run), problem);
    run.begin("settle", 0.85 * std::pow(4.0, run.level) / ((std::pow(4.0, run.levels()) - 1) / 3));
    problem.rest_here(run.x, run.result.friction, run.facts.restarted);
    problem.sheet().softness = run.facts.restarted ? 1 : first ? 1.0 / 16 : 1.0 / 4;
    bool tangled = true;
    const auto untangle = [&] {
        tangled = !take_apart_or_leave_out(run, problem.contact());
        clear_of_body(run, problem, factor);
        run.stage = "settle";
    };
    untangle();

    struct Pass {
        double softness;
        int iterations;
        bool hooked;
    };
    // A carrying edge finds the height at which it fits before friction may hold it, since a tight band on a slight
    // cone is held by friction at any height.
    std::vector<Pass> passes{{1.0 / 4, 8, false}, {1, most_iterations, false}};
    if (first) passes = {{1.0 / 16, 100, true}, {1.0 / 4, 60, true}, {1, run.last_level() ? most_iterations : 150, false}};
    if (run.facts.restarted) passes = {{1, most_iterations, false}};
    if (problem.hooks.size() > kept.size()) {
        passes.insert(passes.end() - 1, {1, 100, true});
        problem.friction.coefficient = 0;
    }
    SettleResult r;
    for (const Pass& pass : passes) {
        if (run.stopped) break;
        const bool last_pass = &pass == &passes.back();
        soften(run, problem, pass.softness);
        if (!pass.hooked && problem.hooks.size() > kept.size()) {
            note_release(run);
            problem.hooks = kept;
            problem.rest_here(run.x, run.result.friction);
        }
        SettleOptions o;
        o.tolerance = run.last_level() && last_pass ? run.options.tolerance : coarse_residual;
        o.max_iterations = pass.iterations;
        o.exact_below = last_pass ? 20 : 0;
        if (pass.softness == 1 || !first) problem.limit_strain(last_pass && run.last_level() ? hard_limit : soft_limit);
        // What did not come apart may do so when the cloth has moved.
        for (int k = 0; tangled && k < most_untangles && !run.stopped; ++k) {
            SettleOptions some = o;
            some.max_iterations = std::min(o.max_iterations, untangle_every);
            run.settle_some(problem, run.x, factor, some);
            untangle();
        }
        r = run.settle_some(problem, run.x, factor, o);
        if (last_pass && run.last_level()) r = settle_within_limits(run, problem, factor, o, r);
    }
    run.result.residual = r.residual;
    run.result.barrier = {contact.body.distance, contact.body.stiffness, contact.cloth.stiffness};
    if (run.last_level()) {
        const int beyond = int(problem.beyond_limits(run.x).size());
        note_facts(run, problem);
        if (run.stopped || (run.iterations_left <= 0 && beyond == 0))
            run.result.status = DrapeStatus::limit;
        else if (!run.grown)
            run.result.status = DrapeStatus::too_small;
        else if (r.end == SettleEnd::settled && beyond == 0)
            run.result.status = DrapeStatus::converged;
        else
            run.result.status = DrapeStatus::stalled;
        if (run.result.status != DrapeStatus::converged) note_where(run, problem, r);
        if (beyond > 0)
            run.result.warnings.push_back(
                text("%d triangles are stretched beyond their fabric's limit", beyond));
    }
    const double s = std::chrono::duration<double>(Clock::now() - start).count();
    run.result.levels.back().seconds += s;
    run.result.seconds.push_back({text("settle %g mm", 1e3 * run.edge_length()), s});
}

/// The largest strain that a fabric of the garment allows; a limit of 0 is none.
double most_stretch(const Run& run) {
    double most = 0;
    for (const Fabric& f : run.fabrics)
        for (const double limit : {f.limit_warp, f.limit_weft})
            most = std::max(most, limit > 0 ? limit : std::numeric_limits<double>::infinity());
    return most;
}

/// What a tape measure reads at most round the torso between two heights.
double widest_girth(const TriMesh& body, double low, double high) {
    double widest = 0;
    for (double y = low; y <= high; y += 0.01) widest = std::max(widest, torso_girth(body, y));
    return widest;
}

/// What the promises that a residual does not show have come to.
void prove(Run& run) {
    if (run.stopped || run.result.status == DrapeStatus::too_small) return; // what is too small slides as well
    for (const auto& [label, height] : label_heights(run.garment, run.x, all_hooked(run))) {
        const double drop = run.carried_at[label] - height;
        if (drop < slid) continue;
        const double longest = (1 + most_stretch(run)) * label_length(run.garment, label);
        const double widest = widest_girth(run.avatar, height, run.carried_at[label]);
        run.result.status = longest < widest - tight ? DrapeStatus::too_small : DrapeStatus::slid_off;
        run.result.where = text("edges labelled \"%s\" slid %.0f cm down from their place at %.2f m", label.c_str(),
                                100 * drop, run.carried_at[label]);
        if (run.result.status == DrapeStatus::too_small)
            run.result.where += text(", over a girth of %.1f cm, which they do not pass: %.1f cm are missing", 100 * widest,
                                     100 * (widest - longest));
    }
    if (run.result.status != DrapeStatus::converged) return;
    const IntersectionCount n = count_intersections(node_triangles(run.garment), run.x, run.avatar, run.garment.stitches);
    if (n.cloth_avatar + n.cloth_cloth == 0) return;
    run.result.status = DrapeStatus::stalled;
    run.result.where = text("%d triangle pairs of cloth and body and %d of cloth and cloth cross", n.cloth_avatar,
                            n.cloth_cloth);
    const std::vector<ClothCrossing> own = find_crossings(tangled_cloth(run), run.x);
    if (!own.empty()) run.result.where += ", the first on " + place_of_triangle(run.garment, run.x, own[0].triangle);
}

void note_landmarks(Run& run) {
    const Neckline neckline = find_neckline(run.staging.levels[run.level], run.garment, run.x, run.avatar);
    run.result.landmarks = find_landmarks(run.staging.levels[run.level], run.garment, run.x, neckline);
    if (run.open || run.stopped) return;
    const std::vector<std::string> all = misplaced(run.result.landmarks, neckline);
    run.result.warnings.insert(run.result.warnings.end(), all.begin(), all.end());
}

/// The report's sentences on what was modelled.
void decide(Run& run) {
    for (const std::string& label : run.held) run.facts.hooks.push_back({label, true, run.carried_at[label], 0, 0});
    const std::map<std::string, double> now = label_heights(run.garment, run.x, all_hooked(run));
    for (HookFacts& h : run.facts.hooks) h.end = now.at(h.label);
    for (const LevelReport& level : run.result.levels) run.facts.edge_lengths.push_back(level.edge_length);
    const std::vector<std::string> all = decisions(run.facts, run.garment, run.x, run.fabrics, run.avatar);
    run.result.decisions.insert(run.result.decisions.end(), all.begin(), all.end());
}

/// Starts from the earlier drape, unless the edit since then makes its cloth cross itself.
bool start_again(Run& run) {
    if (run.options.from.empty()) return false;
    const Garment closed = close_seams(run.staging.levels.back().garment);
    if (const int pairs = crossings(closed, run.options.from); pairs > 0) {
        run.result.decisions.push_back(text("the earlier drape was not taken as a start: after the edit %d pairs of "
                                            "its triangles would cross",
                                            pairs));
        return false;
    }
    run.level = run.levels() - 1;
    choose_hooks(run);
    run.garment = closed;
    run.x = run.options.from;
    run.facts.restarted = true;
    run.result.levels.push_back({run.edge_length(), int(closed.uv.size()), 0, 0, 0});
    choose_body(run);
    if (run.fits_memory(run.level)) settle_level(run);
    return true;
}

void sew_and_drape(Run& run) {
    choose_body(run);
    lay(run);
    choose_hooks(run);
    sew_coarsest(run);
    if (run.open) return;
    settle_level(run);
    while (!run.last_level() && !run.stopped && run.fits_memory(run.level + 1, run.level)) {
        ++run.level;
        choose_body(run);
        refine(run);
        settle_level(run);
    }
}

} // namespace

const char* to_string(DrapeStatus s) {
    switch (s) {
    case DrapeStatus::converged: return "converged";
    case DrapeStatus::stalled: return "stalled";
    case DrapeStatus::limit: return "limit";
    case DrapeStatus::too_small: return "too_small";
    case DrapeStatus::slid_off: return "slid_off";
    }
    return "stalled";
}

DrapeResult drape(const Staging& staging, const Avatar& avatar, const PanelFabrics& fabrics,
                  const DrapeOptions& options) {
    Run run{.staging = staging, .avatar = avatar.body, .fabrics = fabrics, .options = options};
    run.result.residual = std::numeric_limits<double>::infinity();
    run.result.tolerance = options.tolerance;
    run.result.friction = options.friction;
    run.iterations_left = options.max_iterations;
    for (const Fabric& f : fabrics) {
        run.density = std::max(run.density, f.density);
        if (options.friction < 0) run.result.friction = std::max(run.result.friction, f.friction);
    }
    if (!start_again(run)) sew_and_drape(run);
    if (run.stopped) {
        run.result.status = DrapeStatus::limit;
        run.result.where = run.stopped_by + text(", level %d of %d", run.level + 1, run.levels());
        if (std::isfinite(run.result.residual))
            run.result.where += text(", at a residual of %.3g", run.result.residual);
    }
    note_landmarks(run);
    if (!run.open) {
        prove(run);
        decide(run);
    }
    run.result.garment = std::move(run.garment);
    run.result.state.positions = std::move(run.x);
    return std::move(run.result);
}

DrapeResult drape(const Pattern& pattern, const FlatPattern& flat, const Avatar& avatar, const PanelFabrics& fabrics,
                  const DrapeOptions& options) {
    return drape(stage(pattern, flat), avatar, fabrics, options);
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/pull_shut.h"

#include "draping/where.h"
#include "geometry/text.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace toile {

namespace {

constexpr double seam_stiffness = 500;  // N/m per metre of seam while it is far open
constexpr double most_pull = 30;        // times seam_pull, to which it grows where a seam does not close
constexpr double stiffest_seam = 2e4;   // N/m per newton that a stitch may pull with
constexpr double sewing_softness = 0.1; // of the barrier while seams are pulled shut, which takes little force
constexpr double near_share = 0.04;     // of the edge length: a gap below which pulling stops when it closes slowly
constexpr double gaping = 0.2;          // m, a gap from which cloth hangs by nothing
constexpr double hanging_step = 0.03;   // m, an iteration's longest motion of cloth that hangs down
constexpr int hanging_iterations = 400; // at most, in each of
constexpr int most_hangings = 3;        // times that cloth hangs down
constexpr int pressing_iterations = 100; // at most, in which creases fold
constexpr double machine_gap = 0.1;     // of the edge length: what sewing by machine leaves behind it
constexpr int machine_patience = 30;    // rounds that it waits for a gap to close

/// How sewing by machine goes.
struct Machine {
    int stitches;   // sewn at a time, and
    int iterations; // between
};

constexpr Machine quick{2, 4}, careful{1, 12};

double mean_gap(const Garment& g, const Points& x) {
    double sum = 0;
    for (const Stitch& s : g.stitches) sum += stitch_gap(s, x);
    return g.stitches.empty() ? 0 : sum / double(g.stitches.size());
}

/// Pulls the seams of the coarsest level shut around the body; returns the widest gap left, m.
double close_open_seams(DrapeRun& run, const Garment& open, ClothProblem& problem, Points& x, Cholesky& factor) {
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
        // The last tenths of a millimetre may take as long as all the rest, where cloth is sewn to bulky
        // cloth.
        if (gap < near_share * run.edge_length() && gap > 0.8 * last && crossings_when_joined(run, x) == 0) return gap;
        // A seam that does not pull with all it may is pulled harder.
        for (auto& s : problem.stitches)
            if (s.stiffness * gap < s.cap) s.stiffness = std::min(3 * s.stiffness, stiffest_seam * s.cap);
        // One place that waits must not end what still goes on elsewhere; where pulling harder moves nothing
        // at all, something is in the way.
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

/// The pairs that touch at x.
std::vector<ContactPair> touching_pairs(const ClothProblem& problem, const Points& x) {
    std::vector<ContactPair> pairs;
    for (const ActivePair& a : problem.contact().active(x)) pairs.push_back(problem.contact().pair(a.pair));
    return pairs;
}

/// A seam stays open because its cloth does not reach round the body, or because something is in the way.
void note_open_seam(const DrapeRun& run, const ClothProblem& problem, Sewn& sewn) {
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

SettleOptions hanging_options() {
    SettleOptions o;
    o.max_step = hanging_step;
    o.exact_below = 0;
    return o;
}

/// Pleats lie folded before they are sewn, or panels that are several times as wide would close round the arms.
void press_creases(DrapeRun& run, ClothProblem& problem, Points& x, Cholesky& factor) {
    SettleOptions o;
    o.tolerance = 1;
    o.max_iterations = pressing_iterations;
    o.exact_below = 0;
    run.settle_some(problem, x, factor, o);
}

void start_to_pull(ClothProblem& problem, const Garment& open, int stitch) {
    const double length = open.stitches[stitch].length;
    problem.stitches[stitch].stiffness = seam_stiffness * length;
    problem.stitches[stitch].cap = seam_pull * length;
}

/// Lets what is sewn hang down until the body is no longer between the sides of seams that wait.
void hang(DrapeRun& run, const Garment& open, const Waiting& waiting, ClothProblem& problem, Points& x,
          Cholesky& factor) {
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

/// When a seam is sewn: what is to be closed first, or lies inside, then the others, or what hangs from it, then the sides that
/// wait until it hangs.
int turn_of(const Garment& open, const Sewing& way, const Stitch& s) {
    if (!way.first.empty()) return !way.first[s.seam];
    const Waiting& waiting = way.waiting;
    if (waiting.seams.empty()) return 0;
    if (waiting.seams[s.seam]) return 2;
    return waiting.outside[open.panel_of_vertex[s.a]] || waiting.outside[open.panel_of_vertex[s.b[0]]];
}

/// A seam that is sewn stitch by stitch.
struct MachineSeam {
    std::vector<int> stitches = {}; ///< of the garment, in the order of sewing
    std::size_t sewn = 0;           ///< of them pull
};

/// Lets the next stitches of a seam pull, if what is sewn of it has closed, and pulls harder on what has not.
/// A seam begins at an end that is closed on. Returns whether there were any.
bool sew_on(const DrapeRun& run, const Garment& open, int stitches, MachineSeam& seam, ClothProblem& problem,
            const Points& x) {
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
    const std::size_t next = closed ? std::min(seam.sewn + stitches, seam.stitches.size()) : seam.sewn;
    const bool any = next > seam.sewn;
    for (; seam.sewn < next; ++seam.sewn) start_to_pull(problem, open, seam.stitches[seam.sewn]);
    return any;
}

/// Sews waiting seams as on a machine, each after the one that it follows on: sides pulled shut all along at
/// once pinch the folds that hang between them.
void sew_by_machine(DrapeRun& run, const Garment& open, const Sewing& way, ClothProblem& problem, Points& x,
                    Cholesky& factor) {
    const Waiting& waiting = way.waiting;
    const Machine machine = way.careful ? careful : quick;
    std::vector<MachineSeam> seams(waiting.seams.size());
    for (std::size_t k = 0; k < open.stitches.size(); ++k)
        if (waiting.seams[open.stitches[k].seam]) seams[open.stitches[k].seam].stitches.push_back(int(k));
    std::erase_if(seams, [](const MachineSeam& s) { return s.stitches.empty(); });
    SettleOptions o = hanging_options();
    o.tolerance = 1e-2;
    o.max_iterations = machine.iterations;
    o.time_step = 0.1;
    problem.gravity = run.options.gravity;
    for (int waited = 0; waited < machine_patience && !run.stopped; ++waited) {
        bool all = true;
        for (MachineSeam& s : seams) {
            if (sew_on(run, open, machine.stitches, s, problem, x)) waited = 0;
            all = all && s.sewn == s.stitches.size();
        }
        run.settle_some(problem, x, factor, o);
        if (all) break;
    }
    problem.gravity = 0;
}

} // namespace

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

int crossings_when_joined(const DrapeRun& run, const Points& x) {
    const Points joined = merge(run.garment, run.joined, x);
    return count_intersections(node_triangles(run.garment), joined, {}, run.garment.stitches).cloth_cloth;
}

Sewn pull_shut(DrapeRun& run, const Start& start, const Sewing& way) {
    const Garment& open = run.staging.levels[0].garment;
    Sewn sewn{start, way, start.placed.x};
    ContactOptions contact = run.contact_options();
    contact.self = way.self;
    contact.body.stiffness *= sewing_softness;
    contact.cloth.stiffness *= sewing_softness;
    ClothProblem problem(open, run.fabrics, run.body, contact);
    problem.sheet()->softness = 1.0 / 16;
    if (start.lift == 0 && way.hooks) problem.hooks = hooks_on(run, open, all_hooked(run), problem);
    for (const auto& [node, place] : pinned_places(run.staging, 0, open)) problem.pin(node);
    Cholesky factor;
    for (const Stitch& s : open.stitches) problem.stitches.push_back({s.a, s.b, s.r, 0, 0});
    // What has been closed keeps what it took to close it.
    const auto close = [&](int turn) {
        Garment some = open;
        some.stitches.clear();
        for (std::size_t k = 0; k < open.stitches.size(); ++k) {
            const Stitch& s = open.stitches[k];
            const int its = turn_of(open, way, s);
            if (its > turn) continue;
            some.stitches.push_back(s);
            if (its < turn || problem.stitches[k].stiffness > 0) continue;
            start_to_pull(problem, open, int(k));
        }
        return close_open_seams(run, some, problem, sewn.x, factor);
    };
    if (!problem.sheet()->creases.empty()) press_creases(run, problem, sewn.x, factor);
    const bool some_wait = !way.waiting.seams.empty();
    double gap = close(0);
    if (some_wait || !way.first.empty()) gap = close(1);
    for (int k = 0; some_wait && k < most_hangings && gap < gaping && !run.stopped; ++k) {
        hang(run, open, way.waiting, problem, sewn.x, factor);
        if (k == 0) sew_by_machine(run, open, way, problem, sewn.x, factor);
        gap = close(2);
        if (gap < forced_share * run.edge_length()) break;
    }
    sewn.gap = seam_gap_max(open, sewn.x); // of those that wait as well, if it was stopped before their turn
    sewn.open = sewn.gap >= forced_share * run.edge_length();
    if (sewn.open) note_open_seam(run, problem, sewn);
    run.result.contact.seconds += problem.contact().clock().seconds();
    return sewn;
}

} // namespace toile

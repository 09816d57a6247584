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
constexpr int pressing_iterations = 100; // at most, in which creases fold

double mean_gap(const Garment& g, const Points& x) {
    double sum = 0;
    for (const Stitch& s : g.stitches) sum += stitch_gap(s, x);
    return g.stitches.empty() ? 0 : sum / double(g.stitches.size());
}

/// Pulls the seams of the coarsest level shut around the body.
void close_open_seams(DrapeRun& run, const Garment& open, ClothProblem& problem, Points& x, Cholesky& factor) {
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
        if (gap < weld_gap) return;
        // The last tenths of a millimetre may take as long as all the rest, where cloth is sewn to bulky
        // cloth.
        if (gap < near_share * run.edge_length() && gap > 0.8 * last && crossings_when_joined(run, x) == 0) return;
        // A seam that does not pull with all it may is pulled harder.
        for (auto& s : problem.stitches)
            if (s.stiffness * gap < s.cap) s.stiffness = std::min(3 * s.stiffness, stiffest_seam * s.cap);
        // One place that waits must not end what still goes on elsewhere; where pulling harder moves nothing
        // at all, something is in the way.
        const double mean = mean_gap(open, x);
        locked = std::min(gap / last, mean / last_mean) > 0.995 ? locked + 1 : 0;
        if (locked == 4) return;
        if (gap > 0.95 * last) {
            if (cap_scale > most_pull && mean > 0.95 * last_mean) return;
            if (cap_scale <= most_pull) {
                cap_scale *= 1.5;
                for (auto& s : problem.stitches) s.cap *= 1.5;
            }
        }
        last = gap;
        last_mean = mean;
    }
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
    const auto close = [&](bool all) {
        Garment some = open;
        some.stitches.clear();
        for (std::size_t k = 0; k < open.stitches.size(); ++k) {
            const Stitch& s = open.stitches[k];
            if (!all && !way.first[s.seam]) continue;
            some.stitches.push_back(s);
            if (problem.stitches[k].stiffness == 0) start_to_pull(problem, open, int(k));
        }
        close_open_seams(run, some, problem, sewn.x, factor);
    };
    if (!problem.sheet()->creases.empty()) press_creases(run, problem, sewn.x, factor);
    if (!way.first.empty()) close(false);
    close(true);
    sewn.gap = seam_gap_max(open, sewn.x);
    sewn.open = sewn.gap >= forced_share * run.edge_length();
    if (sewn.open) note_open_seam(run, problem, sewn);
    run.result.contact.seconds += problem.contact().clock().seconds();
    return sewn;
}

} // namespace toile

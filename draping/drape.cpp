// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/drape.h"

#include "draping/animate.h"
#include "draping/hooks.h"
#include "draping/joined.h"
#include "draping/pull_shut.h"
#include "draping/settle_level.h"
#include "draping/sew_up.h"
#include "draping/slide.h"
#include "draping/take_apart.h"
#include "draping/where.h"
#include "geometry/simplify.h"
#include "geometry/text.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace toile {

namespace {

constexpr double body_edge_share = 0.8;  // of the edge length: mean edge of the body on levels that are not the last
constexpr double body_error_share = 0.5; // of their contact distance: by which it may be moved

/// A level touches the body that it can tell from the avatar: the last the avatar itself, the others one of
/// triangles like theirs.
void choose_body(DrapeRun& run) {
    run.body = run.last_level() ? run.avatar
                                : simplified(run.avatar, body_edge_share * run.edge_length(),
                                             body_error_share * run.contact_options().body.distance);
}

/// Which edges hooks hold, and at what height.
void choose_hooks(DrapeRun& run) {
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

/// Carries the drape of one level to the next finer one.
void refine(DrapeRun& run) {
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

/// What the promises that a residual does not show have come to.
void prove(DrapeRun& run) {
    if (run.stopped || run.result.status == DrapeStatus::too_small) return; // what is too small slides as well
    if (const std::optional<Slide> slide = is_animated(run.options) ? std::nullopt : find_slide(run)) { // what moves may fall
        run.result.status = slide->status;
        run.result.where = slide->where;
    }
    if (run.result.status != DrapeStatus::converged && run.result.status != DrapeStatus::animated) return;
    const IntersectionCount n =
        count_intersections(node_triangles(run.garment), run.x, run.avatar, run.garment.stitches);
    if (n.cloth_avatar + n.cloth_cloth == 0) return;
    run.result.status = DrapeStatus::stalled;
    run.result.where = text("%d triangle pairs of cloth and body and %d of cloth and cloth cross", n.cloth_avatar,
                            n.cloth_cloth);
    const std::vector<ClothCrossing> own = find_crossings(tangled_cloth(run.garment, run.edge_length()), run.x);
    if (!own.empty()) run.result.where += ", the first on " + place_of_triangle(run.garment, run.x, own[0].triangle);
}

void note_landmarks(DrapeRun& run) {
    const Neckline neckline = find_neckline(run.staging.levels[run.level], run.garment, run.x, run.avatar);
    run.result.landmarks = find_landmarks(run.staging.levels[run.level], run.garment, run.x, neckline);
    if (run.open || run.stopped) return;
    const std::vector<std::string> all = misplaced(run.result.landmarks, neckline);
    run.result.warnings.insert(run.result.warnings.end(), all.begin(), all.end());
}

/// The report's sentences on what was modelled.
void decide(DrapeRun& run) {
    for (const std::string& label : run.held) run.facts.hooks.push_back({label, true, run.carried_at[label], 0, 0});
    const std::map<std::string, double> now = label_heights(run.garment, run.x, all_hooked(run));
    for (HookFacts& h : run.facts.hooks) h.end = now.at(h.label);
    run.facts.still_drawn_in = run.result.drawn_in;
    for (const LevelReport& level : run.result.levels) run.facts.edge_lengths.push_back(level.edge_length);
    const std::vector<std::string> all = decisions(run.facts, run.garment, run.x, run.fabrics, run.avatar);
    run.result.decisions.insert(run.result.decisions.end(), all.begin(), all.end());
}

/// Begins the last level with the earlier drape.
void take_up(DrapeRun& run, Garment closed) {
    run.level = run.levels() - 1;
    choose_hooks(run);
    run.garment = std::move(closed);
    run.x = run.options.from;
    choose_body(run);
}

/// Starts from the earlier drape, unless its cloth crosses itself on the new mesh and does not come apart.
bool start_again(DrapeRun& run) {
    if (run.options.from.empty()) return false;
    Garment closed = close_seams(run.staging.levels.back().garment);
    const int pairs = count_intersections(node_triangles(closed), run.options.from, {}, closed.stitches).cloth_cloth;
    Points apart;
    if (pairs > 0) {
        DrapeRun trial = run;
        take_up(trial, closed);
        Contact contact(contact_cloth(closed), trial.body, trial.contact_options());
        if (!take_apart_or_leave_out(trial, contact)) {
            run.result.decisions.push_back(text("the earlier drape was not taken as a start: %d pairs of its triangles would "
                                                "cross after the edit, and did not come apart", pairs));
            return false;
        }
        apart = std::move(trial.x);
        run.facts.untangled = trial.facts.untangled;
    }
    take_up(run, std::move(closed));
    if (pairs > 0) run.x = std::move(apart);
    run.facts.restarted = true;
    run.result.levels.push_back({run.edge_length(), int(run.garment.uv.size()), 0, 0, 0});
    if (!run.fits_memory(run.level)) return true;
    if (is_animated(run.options))
        animate(run);
    else
        settle_level(run);
    return true;
}

void sew_and_drape(DrapeRun& run) {
    choose_body(run);
    lay(run);
    choose_hooks(run);
    sew_coarsest(run);
    if (run.open) return;
    const auto settle = is_animated(run.options) ? rest_without_weight : settle_level;
    settle(run);
    while (!run.last_level() && !run.stopped && run.fits_memory(run.level + 1, run.level)) {
        ++run.level;
        choose_body(run);
        refine(run);
        settle(run);
    }
    if (is_animated(run.options) && run.last_level() && !run.stopped) animate(run);
}

/// From its coarsest level on.
DrapeResult drape_from_coarsest(const Staging& staging, const Avatar& avatar, const PanelFabrics& fabrics, const DrapeOptions& options) {
    DrapeRun run{.staging = staging, .avatar = avatar.body, .fabrics = fabrics, .options = options};
    run.result.residual = run.result.last_step = std::numeric_limits<double>::infinity();
    run.result.method = run.facts.method = options.method;
    run.facts.projected = options.method_options.projected;
    run.facts.self_contact = options.self_contact;
    run.result.contact.response = response_of(options);
    run.result.tolerance = options.tolerance;
    run.result.friction = {options.friction, options.cloth_friction};
    run.iterations_left = options.max_iterations;
    for (const Fabric& f : fabrics) {
        run.density = std::max(run.density, f.density);
        FrictionCoefficients& friction = run.result.friction;
        if (options.friction < 0) friction.body = std::max(friction.body, f.friction);
        if (options.cloth_friction < 0) friction.cloth = std::max(friction.cloth, f.cloth_friction);
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
    if (is_animated(options) && run.result.frames.empty()) run.result.frames.push_back(run.x); // it did not come to move
    run.result.garment = std::move(run.garment);
    run.result.state.positions = std::move(run.x);
    return std::move(run.result);
}

bool seams_closed(const DrapeResult& r) { return seam_gap_max(r.garment, r.state.positions) < weld_gap; }

/// Whether triangles that were too coarse to be sewn, or to fold as the cloth has to, may have kept a drape from coming to
/// rest. What is too small counts when a seam stayed open, or the body did not grow back: its cloth may have caught on what it
/// would have passed.
bool coarsest_may_be_to_blame(const Staging& staging, const DrapeResult& r) {
    const bool sewn = r.levels[0].edge_length == staging.levels[0].edge_length; // and not taken up from an earlier drape
    return staging.levels.size() > 1 && sewn &&
           (r.status == DrapeStatus::stalled || (r.status == DrapeStatus::too_small && (!seams_closed(r) || r.drawn_in > 0)));
}

} // namespace

TriMesh surface(const DrapeResult& r) { return {r.state.positions, node_triangles(r.garment)}; }

const char* to_string(DrapeStatus s) {
    switch (s) {
    case DrapeStatus::converged: return "converged";
    case DrapeStatus::animated: return "animated";
    case DrapeStatus::stalled: return "stalled";
    case DrapeStatus::limit: return "limit";
    case DrapeStatus::too_small: return "too_small";
    case DrapeStatus::slid_off: return "slid_off";
    }
    return "stalled";
}

ContactResponse response_of(const DrapeOptions& o) {
    const ContactResponse response = o.contact.value_or(is_animated(o) ? ContactResponse::impulse : ContactResponse::barrier);
    if (is_animated(o) && response == ContactResponse::barrier)
        throw std::invalid_argument("an animation moves cloth in time, which the contact barrier cannot answer: it needs "
                                    "constraint, penalty, impulse or rigid");
    return response;
}

bool moves(const DrapeOptions& o) { return !settles(o.method) || response_of(o) != ContactResponse::barrier; }

DrapeResult drape(const Staging& staging, const Avatar& avatar, const PanelFabrics& fabrics,
                  const DrapeOptions& options) {
    const auto start = DrapeRun::Clock::now();
    double done = 0;
    DrapeOptions o = options;
    if (options.progress) o.progress = [&](const DrapeProgress& p) { return done = p.done, options.progress(p); };
    DrapeResult result = drape_from_coarsest(staging, avatar, fabrics, o);
    if (!coarsest_may_be_to_blame(staging, result)) return result;
    o.max_seconds -= DrapeRun::seconds_since(start);
    if (options.progress)
        o.progress = [&options, before = done](DrapeProgress p) {
            p.done = before + (1 - before) * p.done;
            return options.progress(p);
        };
    const Staging finer = without_coarsest(staging);
    DrapeResult again = drape_from_coarsest(finer, avatar, fabrics, o);
    const std::string anew = text("the garment was sewn anew on a mesh of %.3g mm", 1e3 * finer.levels[0].edge_length);
    const bool better = again.status == DrapeStatus::converged || again.status == DrapeStatus::animated ||
                        (seams_closed(again) && (!seams_closed(result) || (result.drawn_in > 0 && again.drawn_in == 0)));
    if (!better) {
        result.decisions.push_back(anew + ", which was no better: " + to_string(again.status) + ", " + again.where);
        return result;
    }
    again.decisions.insert(again.decisions.begin(),
                           anew + text("; with one of %.3g mm it was ", 1e3 * staging.levels[0].edge_length) + to_string(result.status) +
                               ": " + result.where);
    return joined(std::move(result), std::move(again));
}

DrapeResult drape(const Pattern& pattern, const FlatPattern& flat, const Avatar& avatar, const PanelFabrics& fabrics,
                  const DrapeOptions& options) {
    return drape(stage(pattern, flat), avatar, fabrics, options);
}

} // namespace toile


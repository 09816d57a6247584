// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/sew_up.h"

#include "draping/hooks.h"
#include "draping/pull_shut.h"
#include "draping/rings.h"
#include "draping/take_apart.h"
#include "draping/wrap.h"
#include "geometry/text.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace toile {

namespace {

constexpr int heights_tried = 4; // for seams that close first, up or down to where their threads are free
constexpr double slipped = 0.02; // m, down while it is sewn

/// Closes the stitches that are as good as closed and leaves the others open.
void close_what_is_closed(DrapeRun& run, const Garment& open, const Points& x) {
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

std::vector<bool> pinned_panels(const DrapeRun& run) {
    std::vector<bool> pinned(run.staging.levels[0].garment.panel_names.size(), false);
    for (const Pin& pin : run.staging.pins) pinned[pin.span.panel] = true;
    return pinned;
}

void note_pushes(DrapeRun& run, const PlacedClear& placed) {
    const std::vector<std::string>& names = run.staging.levels[0].garment.panel_names;
    for (const PanelPush& p : placed.pushed)
        run.result.decisions.push_back(text("panel \"%s\" was moved %.0f mm %s before sewing",
                                            names[p.panel].c_str(), 1e3 * p.push.norm(),
                                            p.from_body ? "out of the body" : "clear of another panel"));
}

/// Whether what crosses itself when the seams are joined comes apart again; tried on a copy of the run.
bool comes_apart(DrapeRun run, const Sewn& sewn) {
    run.x = merge(run.garment, run.joined, sewn.x);
    Contact contact(contact_cloth(run.garment), run.body, run.contact_options());
    return take_apart_or_leave_out(run, contact);
}

Start place(const DrapeRun& run, double lift, const std::vector<bool>& outside = {}) {
    Points lifted = run.laid.x;
    for (Vec3& p : lifted) p.y() += lift;
    PlaceOptions o;
    o.fixed = pinned_panels(run);
    o.outside = outside;
    return {lift, place_clear(run.staging.levels[0].garment, lifted, run.body, o)};
}

/// By panel, the skirts at x with the body between the sides of some of these seams, unless they are pinned.
std::vector<bool> skirt_to_wrap(const DrapeRun& run, const Points& x, const std::vector<char>& split) {
    const std::optional<double> armpit = armpit_height(run);
    if (!armpit) return {};
    std::vector<bool> skirt = skirt_round_arms(run.staging.levels[0].garment, x, run.body, split, *armpit);
    const std::vector<bool> pinned = pinned_panels(run);
    bool any = false;
    for (std::size_t p = 0; p < skirt.size(); ++p) {
        if (skirt[p] && pinned[p]) return {};
        any = any || skirt[p];
    }
    return any ? skirt : std::vector<bool>{};
}

/// The start with skirts laid round the body that have it between the sides of some of these seams (empty: of those that have it
/// there from the start), or as it is where there are none or that is not possible.
Start place_round(const DrapeRun& run, double lift, const std::vector<char>& split = {}) {
    const Garment& open = run.staging.levels[0].garment;
    Start flat = place(run, lift);
    const std::vector<bool> skirt =
        skirt_to_wrap(run, flat.placed.x, split.empty() ? seams_through_body(open, flat.placed.x, run.body) : split);
    if (skirt.empty()) return flat;
    Start round = place(run, lift, skirt);
    std::optional<Points> laid = wrap_round(open, round.placed.x, run.body, skirt);
    if (!laid) return flat;
    round.placed.x = std::move(*laid);
    std::erase_if(round.placed.pushed, [&](const PanelPush& p) { return skirt[p.panel]; });
    round.wrapped = skirt;
    return round;
}

void note_wrapped(DrapeRun& run, const std::vector<bool>& wrapped) {
    std::string names;
    for (std::size_t p = 0; p < wrapped.size(); ++p)
        if (wrapped[p]) names += (names.empty() ? "\"" : ", \"") + run.staging.levels[0].garment.panel_names[p] + "\"";
    if (!names.empty())
        run.result.decisions.push_back("panels " + names + " were laid round the body in pleats before sewing: the body would be "
                                       "between their sides");
}

} // namespace

void lay(DrapeRun& run) {
    const StagedLevel& staged = run.staging.levels[0];
    LayOptions o;
    o.fixed = pinned_panels(run);
    run.laid = lay_anew(staged.garment, staged.placed, run.body, o);
    for (const LaidPanel& p : run.laid.moved)
        run.result.decisions.push_back(
            text("panel \"%s\" was moved %.0f mm and turned %.0f degrees before sewing, to what it is sewn to",
                 staged.garment.panel_names[p.panel].c_str(), 1e3 * p.moved, double(p.turned * 180 / EIGEN_PI)));
}

void sew_coarsest(DrapeRun& run) {
    const auto start = DrapeRun::Clock::now();
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
        Sewn next = pull_shut(run, from, way);
        next.crossings = crossings_when_joined(run, next.x);
        const auto badness = [](const Sewn& s) { return std::tuple(s.open, s.open ? 0 : s.crossings, s.gap); };
        if (sewn.x.empty() || badness(next) < badness(sewn)) sewn = std::move(next);
        return run.stopped || (!sewn.open && sewn.crossings == 0);
    };
    const Start as_filed = place_round(run, 0);
    bool done = closes(as_filed, {.self = true}) || (!as_filed.wrapped.empty() && !sewn.open && comes_apart(run, sewn));
    done = done || closes(as_filed, {.self = false});
    const Waiting waiting =
        done || !sewn.open ? Waiting()
                           : what_waits(staged.garment, sewn.x, run.body, forced_share * run.edge_length());
    if (!waiting.seams.empty() && as_filed.wrapped.empty()) {
        const Start wrapped = place_round(run, 0, waiting.seams);
        done = !wrapped.wrapped.empty() && closes(wrapped, {.self = true});
    }
    if (!done && sewn.open && run.staging.pins.empty()) {
        const Points& threads = as_filed.wrapped.empty() ? run.laid.x : as_filed.placed.x;
        if (const double lift = free_height(staged.garment, threads, run.body); lift != 0) {
            const Start lifted = place_round(run, lift);
            done = closes(lifted, {.self = true}) || closes(lifted, {.self = false});
        }
    }
    if (!done && sewn.open && !all_hooked(run).empty()) // hooks may hold a bodice lower than its shoulders reach
        done = closes(as_filed, {.self = true, .hooks = false}) || closes(as_filed, {.self = false, .hooks = false});
    if (!done && sewn.open && !waiting.seams.empty()) // a waist that closes first may draw a crotch up to where it cannot close
        if (const auto free = height_free_for(staged.garment, run.laid.x, run.body, stitches_through_body(staged.garment, sewn.x, run.body)))
            for (int k = 0; k <= (run.staging.pins.empty() ? heights_tried : 0) && !done && sewn.open; ++k)
                done = closes(place(run, *free * k / heights_tried), {.first = waiting.seams});
    if (!done && sewn.open && !waiting.seams.empty()) {
        const Start hung = place(run, 0, waiting.outside);
        if (!closes(hung, {.waiting = waiting}) && (sewn.open || !comes_apart(run, sewn))) {
            const Sewn quick = sewn;
            closes(hung, {.waiting = waiting, .careful = true});
            // What little holds may slide down while it is sewn for long; of what is held the rings alone hang lower.
            if (sewn.way.careful && !quick.open && top_height(sewn.x) < top_height(quick.x) - slipped) sewn = quick;
        }
    }
    run.x = merge(run.garment, run.joined, sewn.x);
    if (sewn.start.lift != 0)
        run.result.decisions.push_back(
            text("the garment was moved %s by %.0f mm before sewing: where the file puts it seams could not close that had the body between "
                 "their sides",
                 sewn.start.lift > 0 ? "up" : "down", 1e3 * std::abs(sewn.start.lift)));
    note_pushes(run, sewn.start.placed);
    note_wrapped(run, sewn.start.wrapped);
    run.open = sewn.open;
    if (run.open) { // joined by force it would cut itself or the body
        run.result.status = sewn.status;
        run.result.where = sewn.where;
        close_what_is_closed(run, staged.garment, sewn.x);
    } else if (!run.stopped) {
        if (!sewn.way.waiting.seams.empty())
            run.result.decisions.push_back("seams with the body in their way were sewn when the others were closed "
                                           "and the cloth hung down: all at once could not close");
        if (!sewn.way.first.empty())
            run.result.decisions.push_back("seams that had the body between their sides when all were drawn shut at once were sewn first, and the others after them");
        if (!sewn.way.hooks)
            run.result.decisions.push_back("carrying edges were not held at their height while seams closed: held there a seam stayed open");
        if (sewn.way.careful)
            run.result.decisions.push_back("they were sewn stitch by stitch: more at a time pinched folds between their sides");
        if (!sewn.way.self && sewn.crossings == 0)
            run.result.decisions.push_back("cloth passed through itself while seams closed: with contact "
                                           "between panels a seam could not close; the sewn garment does "
                                           "not cross itself (0 pairs)");
        if (sewn.gap >= weld_gap)
            run.result.decisions.push_back(
                text("seams were joined when %.1f mm were left of them, on a mesh of %.0f mm: the rest closed "
                     "slowly, and what was joined crosses itself in %d pairs",
                     1e3 * sewn.gap, 1e3 * run.edge_length(), sewn.crossings));
    }
    run.book("sew", start);
}

} // namespace toile

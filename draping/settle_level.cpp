// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/settle_level.h"

#include "draping/grow.h"
#include "draping/hooks.h"
#include "draping/respond.h"
#include "draping/settle_cloth.h"
#include "draping/slide.h"
#include "draping/take_apart.h"
#include "draping/untangle_garment.h"
#include "draping/where.h"
#include "geometry/text.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace toile {

namespace {

constexpr double hardest_limit = 0.998;        // from there on, or where the cloth does not come to rest within
constexpr int harder_iterations = 200;         // so many, limits are not hardened but
constexpr double least_tighter = 2.5e-4;       // drawn in by such shares of theirs
constexpr double most_tighter = 2e-3;
constexpr double inner_stitch_stiffness = 1e5; // N/m, of stitches to the inside of an edge of closed seams
constexpr double coarse_residual = 10;         // to which levels that are not the last are settled,
constexpr double loose_residual = 0.1;         // and cloth that starts out loose, where its weight, which nothing bears yet, makes 1
constexpr double loose_strain = 1e-3;
constexpr double still_residual = 1;           // to which the last is where DrapeOptions::still is enough
constexpr int untangle_every = 20;             // iterations after which cloth that did not come apart is tried again,
constexpr int most_untangles = 5;              // in each pass
constexpr int most_iterations = 3000;          // of the last pass of a level
constexpr int most_slides = 10;                // rounds of constraints that take up forces in a pass without friction,
constexpr int most_sliding = 40;               // with so many iterations each,
constexpr double sliding_residual = 30;        // or to this residual,
constexpr double slid_strain = 1e-3;           // until cloth fits by so much
constexpr int tight_every = 100;               // iterations after which cloth is looked at that may be too small
constexpr double too_tight = 0.005;            // m, missing round the garment,
constexpr int long_tight = 500;                // and `tight` after so many iterations, of which
constexpr double tight_gain = 0.1;             // this share has to have gone since, for it to go on
constexpr double near_rest = 0.1;              // residual from which cloth goes in circles when it has not become half as near
constexpr int circle = harder_iterations;      // to rest in more iterations than limits are hardened for
constexpr int most_circles = 5;
constexpr double coarse_motion_residual = 0.3; // less than the 1 of free fall

/// Takes the cloth apart without regard to its pattern: the body gives way meanwhile, and parts go back as a whole.
/// Returns whether that undid it; the cloth stays as it is otherwise.
bool untangle_as_mesh(DrapeRun& run) {
    UntangleGarmentOptions o;
    o.clearance = run.contact_options().body.distance;
    o.progress = [&run](const DrapeProgress& p) { return run.tell(p.done, p.residual); };
    const UntangledGarment u = untangle_garment(run.garment, run.x, run.body, o);
    if (u.status != UntangleStatus::clear) return false;
    run.x = u.x;
    ++run.facts.untangled_as_mesh;
    return true;
}

/// Whether cloth that nothing else holds is all below the body, which it has slid off: it would fall for ever.
bool fell_off(const DrapeRun& run) {
    if (!run.held.empty() || !pinned_places(run.staging, run.level, run.garment).empty()) return false;
    double sole = std::numeric_limits<double>::infinity();
    for (const Vec3& p : run.body.points) sole = std::min(sole, p.y());
    return !run.body.points.empty() && top_height(run.x) < sole;
}

/// Whether nothing but its own fit carries the garment: it has neither pins nor labelled edges, and ends below the armpits.
bool carried_by_fit(const DrapeRun& run) {
    if (!nothing_carries(run)) return false;
    const std::optional<double> armpit = armpit_height(run);
    return armpit && top_height(run.staging.levels[0].placed) < *armpit;
}

/// Whether the cloth starts out hardly strained by sewing: it has all of its way before it, though it lacks little force.
bool starts_loose(const DrapeRun& run) {
    const StrainMeasure s = measure_strain(run.garment, run.x, run.fabrics);
    return std::max({s.warp.max, -s.warp.min, s.weft.max, -s.weft.min, s.shear.max, -s.shear.min}) < loose_strain;
}

/// Tells when cloth has fallen off, or when cloth that is too short round the body, or that the body could not grow
/// back in, has had time to slide to where it fits and has not: no limit however hard makes it longer, but takes
/// thousands of iterations over it.
struct TightWatch {
    const DrapeRun& run;
    double missing = std::numeric_limits<double>::infinity(); ///< m, when looked at last

    bool gives_up(int iteration) {
        if (iteration % tight_every) return false;
        if (fell_off(run)) return true;
        if (iteration == 0 || !run.last_level()) return false;
        const double last = missing;
        missing = find_tightness(run.garment, run.x, run.fabrics).any_missing();
        const double much = iteration < long_tight ? too_tight : tight;
        return run.result.drawn_in > 0 || (missing > much && missing > (1 - tight_gain) * last);
    }
};

/// Tells when cloth near rest gets no nearer to it, since normal forces and friction chase one another.
struct RestWatch {
    double nearest = std::numeric_limits<double>::infinity();
    int since = 0; ///< the iteration that was so near first
    bool in_circles = false;

    bool gives_up(int iteration, double residual) {
        if (iteration == 0 || residual < 0.5 * nearest) {
            nearest = residual;
            since = iteration;
        }
        in_circles = nearest < near_rest && iteration - since > circle;
        return in_circles;
    }
};

} // namespace

bool nothing_carries(const DrapeRun& run) {
    return all_hooked(run).empty() && run.staging.pins.empty() && run.options.from.empty();
}

void soften(const DrapeRun& run, ClothProblem& problem, Loads& loads, double softness) {
    problem.sheet()->softness = softness;
    loads.elastics = elastic_segments(run.staging.elastics, run.garment);
    for (ElasticSegment& s : loads.elastics) s.stiffness *= softness;
}

void note_release(DrapeRun& run) {
    const std::map<std::string, double> now = label_heights(run.garment, run.x, run.carried);
    for (const std::string& label : run.carried)
        run.facts.hooks.push_back({label, false, run.carried_at[label], now.at(label), 0});
}

void note_facts(DrapeRun& run, const Loads& loads, const TouchFacts& touch) {
    DrapeFacts& f = run.facts;
    f.touch = touch;
    f.contact = run.result.contact;
    f.friction = run.result.friction;
    f.clearance = run.options.clearance;
    f.pins = int(pinned_places(run.staging, run.level, run.garment).size());
    f.band_segments = int(loads.elastics.size());
    for (const ElasticSegment& s : loads.elastics) {
        f.band_rest += s.rest;
        f.band_length += (run.x[s.b] - run.x[s.a]).norm();
        f.band_pull = std::max(f.band_pull, s.stiffness * strain(s, run.x));
    }
    f.inner_stitches = int(run.garment.stitches.size());
    f.inner_gap = seam_gap_max(run.garment, run.x);
}

void add_fixtures(DrapeRun& run, ClothProblem& problem) {
    for (const auto& [node, place] : pinned_places(run.staging, run.level, run.garment)) {
        problem.pin(node);
        run.x[node] = place;
    }
    problem.elastics = elastic_segments(run.staging.elastics, run.garment);
    problem.hooks = hooks_on(run, run.garment, run.held, problem);
    for (const Stitch& s : run.garment.stitches)
        problem.stitches.push_back({s.a, s.b, s.r, inner_stitch_stiffness, 1e3});
}

void note_where(DrapeRun& run, const ClothProblem& problem, SettleEnd end, int worst_node) {
    std::string& where = run.result.where;
    where = text("residual %.3g on ", run.result.residual) + place_of_node(run.garment, run.x, worst_node);
    if (end == SettleEnd::stalled && problem.blocking_pair() >= 0)
        where += "; no step is possible, " +
                 place_of_pair(run.garment, run.x, problem.contact().pair(problem.blocking_pair())) + " is in the way";
    if (run.result.drawn_in > 0)
        where = text("the body, drawn in since the cloth started in it, could not grow back: %.1f mm of its full size are left; ",
                     1e3 * run.result.drawn_in) + where;
    if (problem.kept_strain()) return; // of triangles of its own: those between nodes do not tell what is too small
    const Tightness t = find_tightness(run.garment, run.x, run.fabrics);
    if (t.triangle < 0) return;
    const std::string stretched =
        place_of_triangle(run.garment, run.x, t.triangle) +
        text(" is stretched by %.1f %% along the %s, more than the %.1f %% that ", 100 * t.strain,
             t.warp ? "warp" : "weft", 100 * t.limit) +
        run.fabrics[run.garment.panel_of_triangle[t.triangle]].name + " allows";
    // At rest a section that is too short as a whole is so by however little: no limit, however hard, has helped. Nor, where
    // friction was left out, have parts of it that are longer.
    const bool short_round = t.any_missing() > tight || (end == SettleEnd::settled && (t.missing > 0 || run.facts.slid_to_fit > 0));
    if (short_round && run.result.status == DrapeStatus::stalled &&
        touches_body(problem, run.x, run.x[run.garment.nodes(t.triangle)[0]].y(), run.edge_length()))
        run.result.status = DrapeStatus::too_small;
    where = stretched + (short_round ? text("; %.2g cm are missing round the garment there", 100 * t.any_missing()) : "; " + where);
}

SettleResult settle_within_limits(DrapeRun& run, ClothProblem& problem, Cholesky& factor, const SettleOptions& o,
                                  SettleResult r) {
    const auto beyond = [&] { return r.end != SettleEnd::stopped && !problem.beyond_limits(run.x).empty(); };
    SettleOptions some = o;
    some.max_iterations = harder_iterations;
    // Cloth at rest is not given up for limits under which it does not come to rest.
    const auto settled_under = [&](double turn, double tighter) {
        const Points before = run.x;
        problem.limit_strain(turn, tighter);
        const SettleResult now = run.settle_some(problem, run.x, factor, some);
        const bool kept = now.end == SettleEnd::settled || now.end == SettleEnd::stopped || r.end != SettleEnd::settled;
        if (kept)
            r = now;
        else
            run.x = before;
        return kept;
    };
    double turn = hard_limit;
    for (double harder = 0; beyond() && turn < hardest_limit; turn = harder)
        if (!settled_under(harder = 1 - (1 - turn) / 3, 0)) break;
    for (double tighter = least_tighter; beyond() && tighter < most_tighter; tighter *= 2)
        if (!settled_under(turn, tighter)) break;
    return r;
}

namespace {

struct Pass {
    double softness; ///< of the membrane
    int iterations;
    bool hooked;
    bool slides = false; ///< without friction
};

/// The level at work, with what acts on it.
struct Settling {
    DrapeRun& run;
    const bool first = run.level == 0;
    const ContactOptions contact = run.contact_options();
    const PanelFabrics fabrics = run.level_fabrics();
    const Method method = moves(run.options) ? Method::equilibrium : run.options.method;
    ClothProblem problem{make_energy(method, run.garment, fabrics, run.options.method_options), run.garment, fabrics, run.body,
                         contact};
    const bool own_points = has_own_points(problem);
    const bool by_fit = carried_by_fit(run);
    Cholesky factor = {};
    std::vector<HookSpring> kept = {};        ///< hooks that stay when the others are let go
    bool tangled = true;
    std::optional<LevelInMotion> motion = {}; ///< when a response takes over: the same cloth, in motion
    ClothProblem* sheet = nullptr;            ///< whose membrane can be softened; null: of another model
    TightWatch tight{run};
    SlideWatch slide{run};
    std::vector<Pass> passes = {};
    SettleResult end = {};
    RestResult rest = {}; ///< of cloth in motion

    explicit Settling(DrapeRun& at_work) : run(at_work) {
        problem.gravity = run.options.gravity;
        add_fixtures(run, problem);
        kept = problem.hooks;
        if (first) problem.hooks = hooks_on(run, run.garment, all_hooked(run), problem);
        run.begin("settle", 0.85 * run.level_share());
        problem.rest_here(run.x, run.result.friction, run.facts.restarted);
        if (problem.sheet()) problem.sheet()->softness = run.facts.restarted ? 1 : first ? 1.0 / 16 : 1.0 / 4;
        untangle();
        if (moves(run.options)) motion.emplace(run, problem);
        sheet = motion ? motion->sheet.get() : problem.sheet() ? &problem : nullptr;
        plan();
    }

    Loads& acting() { return motion ? motion->stepper->loads() : problem; }
    bool hooks_to_release() { return acting().hooks.size() > kept.size(); }

    void untangle() {
        tangled = !take_apart_or_leave_out(run, problem.contact());
        clear_of_body(run, problem, factor);
        run.stage = "settle";
    }

    void without_friction() { problem.friction.coefficient = problem.cloth_friction.coefficient = 0; }

    /// Sets the passes. A carrying edge, and cloth that keeps its lengths, find the height at which they fit before friction
    /// may hold them: it would hold a tight band on a slight cone at any height.
    void plan() {
        passes = {{1.0 / 4, 8, false}, {1, most_iterations, false}};
        if (first)
            passes = {{1.0 / 16, 100, true}, {1.0 / 4, 60, true}, {1, run.last_level() ? most_iterations : 150, false}};
        if (first) run.loose = !motion && !own_points && acting().hooks.empty() && starts_loose(run);
        if (!sheet) passes.erase(passes.begin(), passes.end() - (first ? 2 : 1)); // nothing to soften
        if (run.facts.restarted || run.loose) passes = {{1, most_iterations, false}};
        if (own_points && !run.facts.restarted) {
            passes.insert(passes.end() - 1, {1, most_sliding, first, true});
            without_friction();
        }
        if (hooks_to_release()) {
            passes.insert(passes.end() - 1, {1, 100, true});
            without_friction();
        }
    }

    bool last(const Pass& pass) const { return &pass == &passes.back(); }
    bool gives_result(const Pass& pass) const { return last(pass) && run.last_level(); }

    SettleOptions options(const Pass& pass) const {
        SettleOptions o;
        o.tolerance = gives_result(pass) ? run.options.tolerance : run.loose ? loose_residual : coarse_residual;
        if (gives_result(pass)) {
            o.still = run.options.still;
            o.still_below = still_residual;
        }
        o.max_iterations = pass.iterations;
        o.exact_below = last(pass) ? 20 : 0;
        return o;
    }

    void begin(const Pass& pass) {
        if (sheet) {
            soften(run, *sheet, acting(), pass.softness);
            // Soft cloth that only its fit carries would be stretched by its weight and slide down.
            acting().gravity = run.options.gravity * (by_fit ? pass.softness : 1);
            if (pass.softness == 1 || !first) sheet->limit_strain(gives_result(pass) ? hard_limit : soft_limit);
        }
        if (!pass.hooked && hooks_to_release()) {
            note_release(run);
            acting().hooks = kept;
            problem.rest_here(run.x, run.result.friction);
        } else if (own_points && last(pass) && passes.size() > 1) {
            problem.rest_here(run.x, run.result.friction);
        }
    }

    /// What did not come apart may do so when the cloth has moved.
    void untangle_on_the_way(const SettleOptions& o, bool at_last) {
        SettleOptions some = o;
        some.max_iterations = std::min(o.max_iterations, untangle_every);
        for (int k = 0; tangled && k < most_untangles && !run.stopped; ++k) {
            run.settle_some(problem, run.x, factor, some);
            untangle();
        }
        if (tangled && at_last && !run.stopped && untangle_as_mesh(run)) untangle();
    }

    /// Rounds of motion without friction, between which constraints take up forces.
    void find_place(SettleOptions o, const std::function<SettleResult(const SettleOptions&)>& settle_on) {
        o.tolerance = sliding_residual;
        for (int k = 0; k < most_slides && !run.stopped; ++k) {
            settle_on(o);
            problem.take_up(problem.all_points(run.x));
            if (problem.kept_strain().value_or(0) < slid_strain) break;
            o.time_step = TakeUpOptions{}.time_step;
        }
    }

    void settle(const Pass& pass) {
        SettleOptions o = options(pass);
        untangle_on_the_way(o, last(pass));
        RestWatch watch;
        if (last(pass))
            o.progress = [&](int i, double residual) {
                return !watch.gives_up(i, residual) && !tight.gives_up(i) && !slide.gives_up(i);
            };
        const auto settle_on = [&](const SettleOptions& how) {
            SettleResult now = run.settle_some(problem, run.x, factor, how);
            // Held as it lies, with what friction can bear, it is at rest or soon comes to it.
            for (int k = 0; k < most_circles && watch.in_circles && !run.stopped; ++k) {
                problem.rest_here(run.x, run.result.friction, true);
                ++run.facts.held_as_it_lay;
                now = run.settle_some(problem, run.x, factor, how);
            }
            return now;
        };
        if (pass.slides)
            find_place(o, settle_on);
        else
            end = gives_result(pass) ? settle_constrained(problem, run.x, o, settle_on) : settle_on(o);
        if (!sheet || !gives_result(pass)) return;
        end = settle_within_limits(run, problem, factor, o, end);
        slide_to_fit(o, settle_on);
    }

    bool beyond_limits() const { return !problem.beyond_limits(run.x).empty(); }

    double missing() const { return find_tightness(run.garment, run.x, run.fabrics).any_missing(); }

    /// Friction holds what is too tight on a slight cone however hard it pulls, and bunched cloth where it is: before it is
    /// called too small it may slide to where it fits, or rests as well as it can, and is held there.
    void slide_to_fit(const SettleOptions& o, const std::function<SettleResult(const SettleOptions&)>& settle_on) {
        if (run.stopped || run.sliding || run.result.drawn_in > 0 || !beyond_limits()) return;
        const Points before = run.x;
        const double missed = missing();
        SettleOptions some = o;
        some.max_iterations = harder_iterations;
        sheet->limit_strain(hard_limit);
        problem.rest_here(run.x, {});
        const SettleResult r = settle_within_limits(run, problem, factor, some, run.settle_some(problem, run.x, factor, some));
        const bool fits = !beyond_limits();
        const bool better = (fits || r.end == SettleEnd::settled || missing() < (1 - tight_gain) * missed) && !find_slide(run);
        if (!better) { // what is reported is where it was
            run.x = before;
            problem.rest_here(run.x, run.result.friction, true);
            some.max_iterations = 0;
            run.settle_some(problem, run.x, factor, some);
            return;
        }
        problem.rest_here(run.x, run.result.friction, true);
        if (run.stopped) return;
        run.facts.slid_to_fit = farthest(before, run.x);
        end = settle_on(o);
        if (fits) end = settle_within_limits(run, problem, factor, o, end);
    }

    /// The same by a response to contact, to the same end.
    void settle_in_motion(const Pass& pass) {
        rest = motion->rest(run, gives_result(pass) ? run.options.tolerance : coarse_motion_residual, pass.iterations,
                            gives_result(pass));
    }

    DrapeStatus status(bool within_limits) const {
        const bool at_rest = motion ? rest.rested : end.end == SettleEnd::settled;
        const bool out_of_steps = motion ? !at_rest && rest.broken.empty() : run.iterations_left <= 0 && within_limits;
        if (run.stopped || out_of_steps) return DrapeStatus::limit;
        if (run.result.drawn_in > 0) return DrapeStatus::too_small;
        return at_rest && (within_limits || !sheet) ? DrapeStatus::converged : DrapeStatus::stalled; // others promise no limits
    }

    void note_result() {
        DrapeResult& result = run.result;
        const int beyond = int(problem.beyond_limits(run.x).size());
        if (motion) problem.touch(run.x);
        note_facts(run, acting(), motion ? motion->touch_facts(problem.contact()) : count_touching(problem.contact(), run.x));
        result.status = status(beyond == 0);
        if (result.status == DrapeStatus::converged) {
            if (run.options.still > 0) result.tolerance = std::max(run.options.tolerance, still_residual);
        } else {
            if (motion) motion->stepper->residual(motion->cloth); // tells which node is worst
            note_where(run, problem, end.end, motion ? motion->stepper->worst_node() : problem.worst_node());
            if (!rest.broken.empty())
                result.where = rest.broken + "; " + result.where;
            else if (motion && !rest.rested)
                result.where += text("; not at rest after %d steps, at %.2g m/s", result.levels.back().iterations, rest.speed);
        }
        if (beyond > 0) result.warnings.push_back(text("%d triangles are stretched beyond their fabric's limit", beyond));
    }

    void conclude() {
        if (!motion) run.result.residual = end.residual;
        ContactReport& report = run.result.contact;
        if (run.level == 0 || run.facts.restarted)
            report.guarantee = motion ? motion->response->guarantee() : Guarantee::no_crossing;
        if (tangled || run.result.drawn_in > 0 || report.unresolved > 0) report.guarantee = Guarantee::none;
        run.result.barrier = {contact.body.distance, contact.body.stiffness, contact.cloth.stiffness};
        run.facts.kept_strain = motion ? motion->stepper->kept_strain() : problem.kept_strain();
        if (run.last_level()) note_result();
        report.seconds += problem.contact().clock().seconds() + (motion ? motion->cloth.contact.seconds() : 0);
    }
};

} // namespace

void settle_level(DrapeRun& run) {
    const auto start = DrapeRun::Clock::now();
    Settling level(run);
    for (const Pass& pass : level.passes) {
        if (run.stopped || !level.rest.broken.empty()) break;
        level.begin(pass);
        if (level.motion)
            level.settle_in_motion(pass);
        else
            level.settle(pass);
    }
    level.conclude();
    run.book(text("settle %g mm", 1e3 * run.edge_length()), start);
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/animate.h"

#include "draping/respond.h"
#include "draping/settle_level.h"
#include "draping/take_apart.h"
#include "geometry/text.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace toile {

namespace {

constexpr double fastest = 10;         // m/s, after a fall of 5 m: lists of pairs grow with what goes far in a step
constexpr double light_residual = 0.1; // of a node's weight, which is small beside what the weight will do
constexpr double share = 0.5;          // of the work of all, that the motion is taken to be

/// Takes the cloth out of itself and the body. Returns whether it crosses nothing then.
bool clear(DrapeRun& run, ClothProblem& problem, Cholesky& factor) {
    const bool apart = take_apart_or_leave_out(run, problem.contact());
    clear_of_body(run, problem, factor);
    return apart && run.result.drawn_in == 0;
}

/// Steps from frame to frame: as many as are no longer than what the method wants.
int steps_per_frame(const AnimateOptions& o, double longest) {
    return std::max(1, int(std::ceil(1 / (o.rate * longest) - 1e-9)));
}

bool at_full_speed(const Moving& cloth, const StepOptions& step) {
    const double most = (1 - 1e-9) * step.max_motion / step.time_step;
    return std::any_of(cloth.velocity.begin(), cloth.velocity.end(), [&](const Vec3& v) { return v.norm() >= most; });
}

/// Steps to the next frame, and notes what happened on the way. Returns whether it got there.
bool step_to_frame(DrapeRun& run, LevelInMotion& motion, MotionReport& report, int frames) {
    const double all = double(report.steps_per_frame) * (frames - 1);
    for (int k = 0; k < report.steps_per_frame; ++k) {
        const ResponseDone done = motion.stepper->step(motion.cloth, motion.response->body());
        ++report.steps;
        run.result.contact.unresolved += done.unresolved > 0;
        report.slowed += at_full_speed(motion.cloth, motion.stepper->options());
        if (!run.tell(report.steps / all, run.result.residual)) return false;
    }
    run.result.residual = motion.stepper->residual(motion.cloth);
    return true;
}

} // namespace

int frame_count(const AnimateOptions& o) { return 1 + int(std::floor(o.duration * o.rate + 1e-9)); }

void rest_without_weight(DrapeRun& run) {
    const auto start = DrapeRun::Clock::now();
    const bool first = run.level == 0;
    ClothProblem problem(run.garment, run.level_fabrics(), run.body, run.contact_options());
    add_fixtures(run, problem);
    problem.hooks = hooks_on(run, run.garment, all_hooked(run), problem);
    run.begin("settle", 0.35 * (1 - share) * run.level_share());
    Cholesky factor;
    const bool clean = clear(run, problem, factor);
    run.stage = "settle";
    struct Pass {
        double softness;
        int iterations;
    };
    const std::vector<Pass> passes =
        first ? std::vector<Pass>{{1.0 / 16, 100}, {1.0 / 4, 60}, {1, 100}} : std::vector<Pass>{{1.0 / 4, 8}, {1, 100}};
    for (const Pass& pass : passes) {
        if (run.stopped) break;
        soften(run, problem, problem, pass.softness);
        if (pass.softness == 1) problem.limit_strain(soft_limit);
        SettleOptions o;
        o.tolerance = light_residual;
        o.max_iterations = pass.iterations;
        o.exact_below = 0;
        run.settle_some(problem, run.x, factor, o);
    }
    if (first || !clean) run.result.contact.guarantee = clean ? Guarantee::no_crossing : Guarantee::none;
    run.result.contact.seconds += problem.contact().clock().seconds();
    run.book(text("settle %g mm", 1e3 * run.edge_length()), start);
}

void animate(DrapeRun& run) {
    const auto start = DrapeRun::Clock::now();
    const AnimateOptions& o = run.options.animation;
    ContactReport& contact = run.result.contact;
    ClothProblem problem(run.garment, run.level_fabrics(), run.body, run.contact_options());
    problem.gravity = run.options.gravity;
    add_fixtures(run, problem);
    bool clean = contact.guarantee == Guarantee::no_crossing;
    if (run.facts.restarted) {
        Cholesky factor;
        clean = clear(run, problem, factor);
    } else {
        note_release(run);
    }
    run.begin("animate", 1);
    LevelInMotion motion(run, problem);
    if (motion.sheet) motion.sheet->limit_strain(soft_limit);
    StepOptions& step = motion.stepper->options();
    MotionReport report{o.rate, o.air_damping, fastest};
    report.steps_per_frame = steps_per_frame(o, step.time_step);
    report.time_step = step.time_step = 1 / (o.rate * report.steps_per_frame);
    step.damping = o.air_damping;
    step.max_motion = fastest * step.time_step;

    std::vector<Points>& frames = run.result.frames;
    frames.push_back(run.x);
    std::string broken;
    try {
        while (int(frames.size()) < frame_count(o) && step_to_frame(run, motion, report, frame_count(o)))
            frames.push_back(motion.cloth.x);
    } catch (const std::runtime_error& error) {
        broken = error.what();
    }
    run.x = frames.back();
    report.frames = int(frames.size());
    for (const Vec3& v : motion.cloth.velocity) report.speed = std::max(report.speed, v.norm());
    run.result.motion = run.facts.motion = report;
    run.result.levels.back().iterations += report.steps;
    run.result.levels.back().factorisations += motion.stepper->factorisations();

    contact.guarantee = clean && contact.unresolved == 0 ? motion.response->guarantee() : Guarantee::none;
    contact.seconds += problem.contact().clock().seconds() + motion.cloth.contact.seconds();
    const ContactOptions near = problem.contact().options();
    run.result.barrier = {near.body.distance, near.body.stiffness, near.cloth.stiffness};
    problem.touch(run.x);
    note_facts(run, motion.stepper->loads(), motion.touch_facts(problem.contact()));
    run.result.status = broken.empty() ? DrapeStatus::animated : DrapeStatus::stalled;
    if (!broken.empty())
        run.result.where = broken + text(", after %.3g s of %.3g s", (double(frames.size()) - 1) / o.rate, o.duration);
    run.book("animate", start);
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/follow.h"

#include "draping/contact/carry.h"
#include "draping/grow.h"
#include "draping/hooks.h"
#include "draping/settle_level.h"
#include "draping/where.h"
#include "geometry/text.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace toile {

namespace {

constexpr double longest_stride = 0.02;  // m, no body point goes farther in one substep: lists grow with it
constexpr double shortest_stride = 1e-4; // m
constexpr double keep_off = 0.5;         // of the way to what is in the way that is gone at once, lest it get stuck there
constexpr double worth_it = 0.1;         // of a stride: a substep that brings the body less far has not brought it on
constexpr int patience = 30;             // substeps in a row that may not bring it on
constexpr int settle_moving = 3;         // Newton iterations after a substep,
constexpr int settle_waiting = 12;       // and after one in which the body had to wait
constexpr double moving_residual = 1;    // or fewer, to this residual

/// What a frame is worked on with.
struct Follow {
    DrapeRun& run;
    ClothProblem& problem;
    Cholesky& factor;
    const FollowOptions& how;
    double stride = longest_stride;
    int blocking = -1; ///< pair that was last in the way of the body

    TriMesh body_now() const { return {problem.contact().body(), run.avatar.triangles}; }

    double farthest_from(const Points& target) const { return farthest(target, problem.contact().body()); }

    /// Moves the body by up to a stride toward the target and the cloth with it. Everything goes as far as what is in
    /// its own way lets it. Returns whether all went all the way.
    bool substep(const Points& target) {
        Contact& contact = problem.contact();
        const TriMesh body = body_now();
        const double share = std::min(1.0, stride / farthest_from(target));
        Points motion(body.points.size());
        for (std::size_t v = 0; v < motion.size(); ++v) motion[v] = share * (target[v] - body.points[v]);
        const std::vector<Anchor> anchors = find_anchors(run.x, body);
        Eigen::VectorXd dx = carried(anchors, body, motion, run.garment.edges, problem.pinned());
        std::vector<double> shares;
        contact.prepare(run.x, dx, &motion);
        double t = contact.feasible_step(run.x, dx, &motion, &blocking, &shares);
        const bool free = t == 1;
        if (!free) {
            const auto own = [&](std::size_t i) { return shares[i] < 1 ? keep_off * shares[i] : 1.0; };
            const std::size_t nodes = run.x.size();
            for (std::size_t i = 0; i < nodes; ++i) dx.segment<3>(3 * i) *= own(i);
            for (std::size_t v = 0; v < motion.size(); ++v) motion[v] *= own(nodes + v);
            t = contact.feasible_step(run.x, dx, &motion);
            if (t < 1) t *= keep_off;
        }
        Points moved = body.points;
        for (std::size_t v = 0; v < moved.size(); ++v)
            moved[v] = free && share == 1 ? target[v] : Vec3(moved[v] + t * motion[v]);
        flat(run.x) += t * dx;
        carry_places(problem.friction, anchors, body, moved);
        contact.set_body(moved);
        return free;
    }

    /// Brings the body to the target. Returns whether it got there.
    bool arrive(const Points& target, FrameReport& report) {
        problem.limit_strain(soft_limit);
        SettleOptions o;
        o.tolerance = moving_residual;
        o.exact_below = 0;
        double left = farthest_from(target);
        int waited = 0;
        while (left > 0 && report.substeps < how.max_substeps && waited < patience && !run.stopped) {
            ++report.substeps;
            const bool free = substep(target);
            const double now = farthest_from(target);
            waited = left - now < worth_it * std::min(stride, left) ? waited + 1 : 0;
            left = now;
            if (free)
                stride = std::min(2 * stride, longest_stride);
            else if (waited > 0)
                stride = std::max(stride / 2, shortest_stride);
            o.max_iterations = free ? settle_moving : settle_waiting;
            run.iterations_left = o.max_iterations;
            run.settle_some(problem, run.x, factor, o);
        }
        return left == 0;
    }

    void frame(const Points& target, FrameReport& report) {
        const auto start = DrapeRun::Clock::now();
        const int before = run.result.levels.back().iterations;
        run.result.where.clear();
        run.result.residual = std::numeric_limits<double>::infinity();
        const bool there = arrive(target, report);
        report.behind = farthest_from(target);
        const std::string in_the_way =
            there || blocking < 0 ? "" : place_of_pair(run.garment, run.x, problem.contact().pair(blocking));

        problem.limit_strain(hard_limit);
        SettleOptions o;
        o.tolerance = run.options.tolerance;
        o.max_iterations = run.iterations_left = how.max_iterations;
        SettleResult r = run.settle_some(problem, run.x, factor, o);
        r = settle_within_limits(run, problem, factor, o, r);

        report.residual = r.residual;
        report.iterations = run.result.levels.back().iterations - before;
        report.intersections = count_intersections(node_triangles(run.garment), run.x,
                                                   {target, run.avatar.triangles}, run.garment.stitches);
        judge(report, r, in_the_way);
        report.seconds = DrapeRun::seconds_since(start);
    }

    void judge(FrameReport& report, const SettleResult& r, const std::string& in_the_way) {
        const int beyond = int(problem.beyond_limits(run.x).size());
        const int crossing = report.intersections.cloth_avatar + report.intersections.cloth_cloth;
        if (run.stopped)
            report.status = FrameStatus::limit;
        else if (report.behind > 0)
            report.status = FrameStatus::blocked;
        else if (r.end == SettleEnd::settled && beyond == 0 && crossing == 0)
            report.status = FrameStatus::converged;
        else
            report.status = r.end == SettleEnd::iterations ? FrameStatus::limit : FrameStatus::stalled;
        if (report.status == FrameStatus::converged) return;
        if (run.stopped) {
            report.where = run.stopped_by;
            return;
        }
        note_where(run, problem, r.end, problem.worst_node());
        report.where = run.result.where;
        if (report.behind > 0)
            report.where = text("the body is up to %.1f mm short of the frame", 1e3 * report.behind) +
                           (in_the_way.empty() ? "" : ", " + in_the_way + " is in the way") + "; " + report.where;
    }
};

} // namespace

const char* to_string(FrameStatus s) {
    switch (s) {
    case FrameStatus::converged: return "converged";
    case FrameStatus::stalled: return "stalled";
    case FrameStatus::limit: return "limit";
    case FrameStatus::blocked: return "blocked";
    }
    return "stalled";
}

bool can_follow(const DrapeResult& dressed, const TriMesh& body) {
    for (const Stitch& s : dressed.garment.stitches)
        if (s.r == 0) return false; // a seam that is to become one node is still open
    const IntersectionCount n = count_intersections(node_triangles(dressed.garment), dressed.state.positions, body,
                                                    dressed.garment.stitches);
    return n.cloth_avatar + n.cloth_cloth == 0;
}

std::vector<FrameReport> follow(const Staging& staging, const DrapeResult& dressed, const TriMesh& body,
                                const std::vector<Points>& frames, const PanelFabrics& fabrics,
                                const DrapeOptions& options, const FollowOptions& how) {
    if (!can_follow(dressed, body))
        throw std::invalid_argument("a garment whose seams are open, or that crosses something, cannot follow a body");
    for (const Points& frame : frames)
        if (frame.size() != body.points.size())
            throw std::invalid_argument("a frame has another number of points than the body");

    DrapeRun run{.staging = staging, .avatar = body, .fabrics = fabrics, .options = options};
    for (const Fabric& f : fabrics) run.density = std::max(run.density, f.density);
    const auto is_dressed = [&](const StagedLevel& l) { return l.garment.uv.size() == dressed.garment.uv.size(); };
    run.level = int(std::find_if(staging.levels.begin(), staging.levels.end(), is_dressed) - staging.levels.begin());
    run.garment = dressed.garment;
    run.x = dressed.state.positions;
    run.body = body;
    run.result.levels.push_back({run.edge_length(), int(run.garment.uv.size()), 0, 0, 0});
    const std::vector<std::string> labels = labels_of(run.garment);
    for (const std::string& word : options.hold)
        for (const std::string& label : labels_called(word, labels))
            if (std::find(run.held.begin(), run.held.end(), label) == run.held.end()) run.held.push_back(label);
    run.carried_at = label_heights(run.garment, run.x, run.held);

    ClothProblem problem(run.garment, fabrics, body, run.contact_options());
    problem.gravity = options.gravity;
    add_fixtures(run, problem);
    problem.rest_here(run.x, dressed.friction, true);
    Cholesky factor;
    Follow follow{run, problem, factor, how};
    std::vector<FrameReport> reports;
    for (std::size_t k = 0; k < frames.size() && !run.stopped; ++k) {
        run.begin(text("frame %d of %d", int(k + 1), int(frames.size())).c_str(), 1.0 / double(frames.size()));
        follow.frame(frames[k], reports.emplace_back());
        run.done = std::max(run.done, run.share_end);
        if (how.done) how.done(int(k), run.x);
    }
    return reports;
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/drape_to_accuracy.h"

#include "draping/carry_drape.h"
#include "draping/compare.h"
#include "draping/contact/self_touch.h"
#include "draping/energy/strain_limit.h"
#include "draping/grade.h"
#include "draping/joined.h"
#include "draping/measure.h"
#include "draping/strain_difference.h"
#include "geometry/text.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

namespace toile {

namespace {

constexpr double usual_edge = 0.02;        // m, at which real garments were 1 to 3 mm from their drape at half of it,
constexpr double usual_error = 2e-3;       // by docs/accuracy.md
constexpr double least_finer = 0.71;       // of the edge length: smaller steps tell too little for their time
constexpr double most_finer = 0.5;
constexpr double curved_most = 0.3;        // of the area: with a tenth, errors grew more than vertices went
constexpr double aim = 0.7;                // of what is asked: estimates are off by about as much
constexpr double share_of_residual = 0.1;  // of the error asked for, that iterations may leave
constexpr double travel = 2;               // of the error asked for: by which cloth may go on from one mesh to the next
constexpr double share_of_model = 0.1;     // of the error asked for, that a lighter method may make
constexpr double left_over_step = 10;      // what was left to rest over the last step at a residual below 1: 2 to 10 were seen

/// The decision to model less from some mesh on; nothing: not made.
using Choice = std::optional<std::size_t>;

/// What the loop over meshes has come to.
struct AccuracyRun {
    using Clock = std::chrono::steady_clock;
    const AccuracyOptions& accuracy;
    const Avatar& avatar;
    const PanelFabrics& fabrics;
    const DrapeOptions& options;
    Clock::time_point started = Clock::now();
    DrapeResult result = {};
    Staging staging = {}; ///< of the last mesh
    AccuracyReport report = {};
    std::size_t edge_decision = 0; ///< the last about an edge length
    Choice no_self_contact = {}, no_friction = {}, lighter = {};
    bool out_of_time = false;      ///< the budget did not suffice for the last mesh, which was taken back

    bool of_strain() const { return accuracy.of == AccuracyOf::strain; }
    /// What is asked, or of a budget what it may come to by what is known.
    double goal() const { return !accuracy.budget ? accuracy.asked : report.estimate.value_or(usual_error); }
    /// m, the same of a node's place; of strain by what an edge may be too long.
    double goal_of_place(double edge_length) const { return of_strain() ? accuracy.asked * edge_length : goal(); }
    std::string asked_measure() const { return of_strain() ? "RMS of strain asked" : "RMS asked, m"; }
    double seconds_left() const { return accuracy.budget.value_or(std::numeric_limits<double>::infinity()) - seconds(); }
    double seconds() const { return std::chrono::duration<double>(Clock::now() - started).count(); }
    void decide(std::string what, std::string measure, double value) {
        report.decisions.push_back({std::move(what), std::move(measure), value, false});
    }
    bool stands(const Choice& choice) const { return choice && !report.decisions[*choice].taken_back; }
    void choose(Choice& choice, std::string what, std::string measure, double value) {
        choice = report.decisions.size();
        decide(std::move(what), std::move(measure), value);
    }
    void take_back(const Choice& choice, std::string what, std::string measure, double value) {
        report.decisions[*choice].taken_back = true;
        decide(std::move(what), std::move(measure), value);
    }
    int meshes() const { return int(report.meshes.size()); }
    const AccuracyMesh& mesh(int from_last) const { return report.meshes[report.meshes.size() - 1 - from_last]; }
};

/// Work on k meshes done fills half of what is left, whatever comes after.
std::function<bool(const DrapeProgress&)> part_of_meshes(const AccuracyRun& run) {
    if (!run.options.progress) return {};
    return [tell = run.options.progress, left = std::pow(0.5, run.meshes())](DrapeProgress p) {
        p.done = 1 - left + left / 2 * p.done;
        p.seconds_left = std::numeric_limits<double>::infinity();
        return tell(p);
    };
}

Points carried(const AccuracyRun& run, const Staging& staging) {
    std::vector<int> same(run.result.garment.panel_names.size());
    std::iota(same.begin(), same.end(), 0);
    return carry_drape(run.result.garment, run.result.state.positions, close_seams(staging.levels.back().garment), same);
}

/// Whether there is a drape to go on from.
bool at_rest(const AccuracyRun& run) { return run.meshes() > 0 && run.result.status == DrapeStatus::converged; }

/// Whether the next mesh need not be equally fine everywhere: it takes two that were. Where a single mesh of 40 mm is flat,
/// finer triangles fold all the same, and triangles that stay as coarse do not show by how far.
bool may_grade(const AccuracyRun& run) { return at_rest(run) && run.accuracy.graded && run.mesh(0).difference; }

/// As fine as `edge_length` where the mesh before shows that the cloth is curved, as fine as that elsewhere.
Staging mesh_for(const AccuracyRun& run, double edge_length) {
    if (!may_grade(run)) return run.accuracy.mesh(edge_length, {});
    GradeOptions o;
    o.edge_length = edge_length;
    o.most = run.mesh(0).edge_length;
    o.curved = curved_most;
    const Garment& g = run.result.garment;
    const PlaceFactor edge = over_panels(g, graded_edges(g, run.result.state.positions, o));
    return run.accuracy.mesh(o.most, [&](int panel, const Vec2& at) { return edge(panel, at) / o.most; });
}

void decide_graded(AccuracyRun& run, double edge_length, int vertices) {
    const std::vector<double> areas = rest_areas(run.result.garment);
    const double area = std::accumulate(areas.begin(), areas.end(), 0.0);
    const double uniform = area / (std::sqrt(3.0) / 2 * edge_length * edge_length);
    run.decide(text("edges of %.3g mm on the %.0f %% of the cloth that is curved most, and up to %.3g mm elsewhere", 1e3 * edge_length,
                    100 * curved_most, 1e3 * run.mesh(0).edge_length),
               "vertices over those of equal triangles everywhere", vertices / uniform);
}

/// How near cloth may come from one mesh to the next, m.
double reach(const AccuracyRun& run) { return run.options.clearance + travel * (run.of_strain() ? usual_error : run.goal()); }

/// Leaves contact of the cloth with itself out of the next mesh where the last shows that there will be none.
void decide_self_contact(AccuracyRun& run) {
    if (!run.accuracy.leaves_out_self_contact || !run.options.self_contact || run.no_self_contact) return;
    const Garment& g = run.result.garment;
    if (!g.stitches.empty() || may_touch_itself(node_triangles(g), run.result.state.positions, reach(run))) return;
    run.choose(run.no_self_contact,
               text("contact of the cloth with itself is left out of meshes after that of %.3g mm, since cones of its normals and boxes show "
                    "that it cannot touch itself", 1e3 * run.mesh(0).edge_length),
               "distance by which what is not next to each other stays apart at least, m", reach(run));
}

/// Leaves friction out of the next mesh where the last shows that there will be nothing to rub against.
void decide_friction(AccuracyRun& run) {
    if (!run.accuracy.leaves_out_friction || run.no_friction || (run.options.self_contact && !run.stands(run.no_self_contact))) return;
    if (!(clearance_min(node_triangles(run.result.garment), run.result.state.positions, run.avatar.body) > reach(run))) return;
    run.choose(run.no_friction, text("friction is left out of meshes after that of %.3g mm, since the cloth touches nothing", 1e3 * run.mesh(0).edge_length),
               "distance by which it stays apart from the body at least, m", reach(run));
}

/// Of a drape on the next mesh from that on the last.
double difference(const AccuracyRun& run, const DrapeResult& now) {
    if (!run.of_strain()) return compare(surface(run.result), surface(now)).rms;
    return strain_difference(run.result.garment, run.result.state.positions, now.garment, now.state.positions);
}

bool within_limits(const DrapeResult& r, const PanelFabrics& fabrics) {
    return beyond_strain_limits(make_strain_limits(r.garment, fabrics), r.state.positions).empty();
}

/// What a drape on this edge length is done with, by the choices that stand.
DrapeOptions chosen(const AccuracyRun& run, double edge_length) {
    DrapeOptions o = run.options;
    if (run.accuracy.ends_early) o.still = share_of_residual / left_over_step * run.goal_of_place(edge_length);
    if (run.stands(run.no_self_contact)) o.self_contact = false;
    if (run.stands(run.no_friction)) o.friction = o.cloth_friction = 0;
    if (run.stands(run.lighter)) o.method = Method::projective;
    o.max_seconds = std::min(run.options.max_seconds - run.seconds(), run.seconds_left());
    return o;
}

/// Settles the next meshes of cloth that touches nothing by a lighter method where the last mesh goes nowhere by it.
void decide_method(AccuracyRun& run) {
    if (!run.accuracy.lighter_method || run.lighter || !run.stands(run.no_friction) || run.options.method != Method::equilibrium) return;
    DrapeOptions o = chosen(run, run.mesh(0).edge_length);
    o.method = Method::projective;
    o.from = run.result.state.positions;
    o.progress = part_of_meshes(run);
    const DrapeResult lighter = drape(run.staging, run.avatar, run.fabrics, o);
    if (lighter.status != DrapeStatus::converged || !within_limits(lighter, run.fabrics)) return;
    const double off = difference(run, lighter);
    if (off > share_of_model * run.goal()) return;
    run.choose(run.lighter, text("meshes after that of %.3g mm are settled by %s, which asks less of every triangle and makes that mesh the same", 1e3 * run.mesh(0).edge_length,
                                 to_string(o.method)),
               text("difference of both methods there, ") + (run.of_strain() ? "of strain" : "m"), off);
}

/// Takes back what this mesh shows to be wrong; whether it has to be draped again.
bool take_back(AccuracyRun& run, const DrapeResult& now, double edge_length) {
    if (now.status == DrapeStatus::limit) return false;
    const double clearance = run.options.clearance;
    const std::string from = text(" from the mesh of %.3g mm on, since ", 1e3 * edge_length);
    const std::vector<Triangle> cloth = node_triangles(now.garment);
    const bool near_itself = run.stands(run.no_self_contact) && may_touch_itself(cloth, now.state.positions, clearance);
    const bool near = run.stands(run.no_friction) && (near_itself || clearance_min(cloth, now.state.positions, run.avatar.body) <= clearance);
    const bool wrong = run.stands(run.lighter) && (now.status != DrapeStatus::converged || !within_limits(now, run.fabrics));
    if (near_itself)
        run.take_back(run.no_self_contact, "contact of the cloth with itself is modelled" + from + "it came near itself", "clearance, m", clearance);
    if (near) run.take_back(run.no_friction, "friction is modelled" + from + "the cloth came to touch something", "clearance, m", clearance);
    if (wrong)
        run.take_back(run.lighter, text("%s settles", to_string(Method::equilibrium)) + from + "the lighter method did not keep the fabric's limits", "residual",
                      std::isfinite(now.residual) ? now.residual : 0);
    return near_itself || near || wrong;
}

/// Drapes at this edge length from where the mesh before came to rest.
void drape_mesh(AccuracyRun& run, double edge_length) {
    const auto start = AccuracyRun::Clock::now();
    Staging staging = mesh_for(run, edge_length);
    Points from;
    const bool goes_on = at_rest(run);
    if (goes_on) {
        from = carried(run, staging);
        decide_self_contact(run);
        decide_friction(run);
        decide_method(run);
    }
    const auto drape_once = [&] {
        DrapeOptions o = chosen(run, edge_length);
        o.from = from;
        o.progress = part_of_meshes(run);
        return drape(staging, run.avatar, run.fabrics, o);
    };
    DrapeResult now = drape_once();
    while (take_back(run, now, edge_length)) now = drape_once();
    if (goes_on && now.status == DrapeStatus::limit && run.seconds_left() <= 0) {
        run.report.decisions[run.edge_decision].taken_back = true;
        run.decide(text("the drape is that of the mesh of %.3g mm, since one of %.3g mm did not come to rest in the budget",
                        1e3 * run.mesh(0).edge_length, 1e3 * edge_length),
                   "residual that it came to", std::isfinite(now.residual) ? now.residual : 0);
        run.out_of_time = true;
        return;
    }
    AccuracyMesh mesh;
    mesh.edge_length = edge_length;
    mesh.vertices = int(now.garment.uv.size());
    mesh.motion = std::isfinite(now.last_step) ? now.last_step : 0; // at rest from the start
    for (const LevelReport& level : now.levels) mesh.iterations += level.iterations;
    mesh.seconds = std::chrono::duration<double>(AccuracyRun::Clock::now() - start).count();
    if (may_grade(run)) decide_graded(run, edge_length, mesh.vertices);
    if (goes_on) mesh.difference = difference(run, now);
    run.result = run.meshes() > 0 ? joined(std::move(run.result), std::move(now)) : std::move(now);
    run.report.meshes.push_back(mesh);
    run.staging = std::move(staging);
}

/// From the differences of the last meshes.
void estimate(AccuracyRun& run) {
    AccuracyReport& r = run.report;
    const AccuracyMesh &now = run.mesh(0), &before = run.mesh(1);
    const double ratio = before.edge_length / now.edge_length;
    r.order = cautious_order;
    if (before.difference && *now.difference > 0 && *before.difference > 0)
        r.order = measured_order(*before.difference, *now.difference, run.mesh(2).edge_length, before.edge_length, now.edge_length);
    r.discretisation = expected_change(*now.difference, ratio, r.order);
    r.residual = left_over_step * now.motion / (run.of_strain() ? now.edge_length : 1);
    r.estimate = r.discretisation + r.residual;
}

/// The edge length at which the estimate would be a little below what is asked, if errors fall by the order found.
double next_edge(const AccuracyRun& run) {
    const AccuracyReport& r = run.report;
    const double edge = run.mesh(0).edge_length, wanted = aim * run.accuracy.asked / r.discretisation;
    if (!run.mesh(1).difference) return std::max(least_finer * edge, run.accuracy.finest); // the order is not known
    const double share = r.order > 0 ? std::pow(wanted, 1 / r.order) : most_finer;
    return std::max(edge * std::clamp(share, most_finer, least_finer), run.accuracy.finest);
}

/// The finest mesh that is expected to fit in the budget; nothing: none that is much finer than the last.
std::optional<double> edge_in_budget(AccuracyRun& run) {
    if (run.out_of_time) return std::nullopt;
    const AccuracyMesh& last = run.mesh(0);
    const double left = run.seconds_left(), share = left > 0 ? std::sqrt(last.seconds / left) : 1; // seconds go with the vertices
    const double edge = std::max(last.edge_length * std::max(share, most_finer), run.accuracy.finest);
    if (edge <= least_finer * last.edge_length * (1 + 1e-9)) return edge;
    run.decide(text("no mesh finer than %.3g mm, since one of %.3g mm is not expected to fit", 1e3 * last.edge_length,
                    1e3 * least_finer * last.edge_length),
               "seconds left of the budget", left);
    return std::nullopt;
}

/// Of the second mesh, before anything is known of this garment's errors.
double second_edge(const AccuracyRun& run) {
    const double usual = run.of_strain() ? usual_edge : usual_edge * std::pow(run.accuracy.asked / usual_error, 1 / assumed_order);
    return std::max(std::clamp(usual, most_finer * first_accuracy_edge, least_finer * first_accuracy_edge), run.accuracy.finest);
}

void decide_edge(AccuracyRun& run, std::string what, std::string measure, double value) {
    run.decide(std::move(what), std::move(measure), value);
    run.edge_decision = run.report.decisions.size() - 1;
}

/// Whether another mesh is to follow, and of what edge length.
std::optional<double> choose_next(AccuracyRun& run) {
    AccuracyReport& r = run.report;
    const double last = run.mesh(0).edge_length;
    const bool small = run.result.status == DrapeStatus::too_small;
    const bool coarse = last > std::max(usual_edge, run.accuracy.finest) * (1 + 1e-9); // too few triangles for limits and folds
    if (coarse && (small || run.result.status == DrapeStatus::stalled)) {
        r.decisions[run.edge_decision].taken_back = true;
        const double edge = std::max(most_finer * last, run.accuracy.finest);
        decide_edge(run, text("a mesh of %.3g mm, sewn anew, since that of %.3g mm %s", 1e3 * edge, 1e3 * last,
                              small ? "is too coarse to tell that cloth is missing" : "did not come to rest"),
                    "residual that it came to", std::isfinite(run.result.residual) ? run.result.residual : 0);
        return edge;
    }
    if (run.result.status != DrapeStatus::converged) return std::nullopt;
    if (run.accuracy.budget) {
        if (run.mesh(0).difference && !run.out_of_time) estimate(run);
        r.met = true;
        const std::optional<double> edge = edge_in_budget(run);
        if (edge) decide_edge(run, text("a mesh of %.3g mm, which is expected to fit", 1e3 * *edge), "seconds left of the budget", run.seconds_left());
        return edge;
    }
    if (!run.mesh(0).difference) {
        if (last <= run.accuracy.finest * (1 + 1e-9)) return std::nullopt;
        const double edge = run.meshes() == 1 ? second_edge(run) : std::max(least_finer * last, run.accuracy.finest);
        decide_edge(run, text("a mesh of %.3g mm, whose difference from the first at rest tells the error", 1e3 * edge), run.asked_measure(),
                    run.accuracy.asked);
        return edge;
    }
    estimate(run);
    r.met = *r.estimate <= run.accuracy.asked;
    const std::string by = text("estimate of the error at %.3g mm, ", 1e3 * run.mesh(0).edge_length) + (run.of_strain() ? "of strain" : "m");
    if (r.met) {
        run.decide("the last mesh is fine enough", by, *r.estimate);
        return std::nullopt;
    }
    if (run.mesh(0).edge_length <= run.accuracy.finest * (1 + 1e-9)) {
        run.decide(text("no mesh is finer than %.3g mm, and the error stays larger than asked", 1e3 * run.accuracy.finest), by, *r.estimate);
        return std::nullopt;
    }
    const double edge = next_edge(run);
    r.decisions[run.edge_decision].taken_back = true; // it was not fine enough
    decide_edge(run, text("a finer mesh of %.3g mm", 1e3 * edge), by, *r.estimate);
    return edge;
}

} // namespace

DrapeResult drape_to_accuracy(const AccuracyOptions& accuracy, const Avatar& avatar, const PanelFabrics& fabrics,
                              const DrapeOptions& options) {
    AccuracyRun run{.accuracy = accuracy, .avatar = avatar, .fabrics = fabrics, .options = options};
    run.report.of = accuracy.of;
    run.report.budget = accuracy.budget;
    if (!accuracy.budget) run.report.asked = accuracy.asked;
    const std::string whole = accuracy.budget ? "the estimate of the error" : run.of_strain() ? "what is asked, of an edge's length," : "what is asked";
    if (accuracy.ends_early)
        run.decide("iterations on a mesh end when the last moved no node farther than a hundredth of " + whole + " at a residual of 1",
                   run.of_strain() ? "a hundredth of what is asked" : "a hundredth of " + whole + ", m",
                   share_of_residual / left_over_step * run.goal());
    decide_edge(run, text("a first mesh of %.3g mm", 1e3 * std::max(first_accuracy_edge, accuracy.finest)),
                accuracy.budget ? "seconds of the budget" : run.asked_measure(), accuracy.budget.value_or(accuracy.asked));
    drape_mesh(run, std::max(first_accuracy_edge, accuracy.finest));
    while (const std::optional<double> edge = choose_next(run)) drape_mesh(run, *edge);
    run.result.accuracy = std::move(run.report);
    return std::move(run.result);
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/fit_job.h"

#include "geometry/text.h"
#include "io/companion.h"
#include "io/fit_spec.h"
#include "io/read_fabric.h"
#include "io/read_garment.h"
#include "io/write_altered.h"
#include "io/write_file.h"
#include "io/write_garment.h"
#include "patterns/shrink.h"
#include "src/drape_input.h"
#include "src/pipeline.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>

namespace fs = std::filesystem;

namespace toile {

namespace {

using Json = nlohmann::ordered_json;

constexpr double fit_tolerance = 1e-7; // residual of equilibria
constexpr double least_ease = 5e-4;    // m of a seam, that can be measured

FitGoal shape_goal_of(const GoalSpec& spec, const DrapeResult& drape) {
    const ReadGarment read = read_garment(spec.file);
    std::vector<Triangle> triangles = node_triangles(read.garment);
    for (const Vec3& p : read.x)
        if (!p.allFinite()) throw InputError(spec.file + ": has coordinates that are no numbers");
    if (triangles == node_triangles(drape.garment)) return {spec.name, shape_goal(drape.garment, read.x), spec.tolerance};
    Box cloth, target;
    for (const Vec3& p : drape.state.positions) cloth.extend(p);
    for (const Vec3& p : read.x) target.extend(p);
    if (!cloth.intersects(target))
        throw InputError(spec.file + text(": lies elsewhere, %.2f m from the drape of the pattern; expected a shape in metres where the "
                                          "garment hangs", cloth.exteriorDistance(target)));
    if (std::none_of(triangles.begin(), triangles.end(), [&](const Triangle& t) { return triangle_area(read.x, t) > 0; }))
        throw InputError(spec.file + ": has no area, expected a surface");
    return {spec.name, surface_goal(drape.garment, {read.x, std::move(triangles)}), spec.tolerance};
}

FitGoal level_goal_of(const GoalSpec& spec, const DrapeResult& drape) {
    std::vector<std::vector<int>> lines;
    for (const BorderLine& line : drape.garment.borders)
        if (std::find(spec.edges.begin(), spec.edges.end(), std::array{line.panel, line.edge}) != spec.edges.end())
            lines.push_back(line.vertices);
    return {spec.name, level_goal(drape.garment, lines, spec.height), spec.tolerance};
}

FitGoal ease_goal_of(const GoalSpec& spec, const DrapeResult& drape, const TriMesh& body) {
    const double girth = torso_girth(body, *spec.height);
    if (!(girth > 0))
        throw InputError(text("goal \"%s\": the body has no girth at %.0f mm", spec.name.c_str(), 1e3 * *spec.height));
    FitGoal goal{spec.name, GirthGoal{*spec.height, girth + spec.amount, spec.panels}, spec.tolerance};
    if (!std::isfinite(miss(goal, drape.garment, drape.state.positions)))
        throw InputError(text("goal \"%s\": the garment has no girth at %.0f mm", spec.name.c_str(), 1e3 * *spec.height));
    return goal;
}

FitGoal stretch_goal_of(const GoalSpec& spec, const DrapeResult& drape) {
    StrainGoal goal{{}, spec.warp, spec.amount};
    for (int t = 0; t < int(drape.garment.triangles.size()); ++t) {
        const Triangle n = drape.garment.nodes(t);
        const Points& x = drape.state.positions;
        const Vec3 centre = (x[n[0]] + x[n[1]] + x[n[2]]) / 3;
        const int panel = drape.garment.panel_of_triangle[t];
        if (std::find(spec.panels.begin(), spec.panels.end(), panel) == spec.panels.end()) continue;
        if (!spec.near || (centre - *spec.near).norm() < spec.within) goal.triangles.push_back(t);
    }
    if (goal.triangles.empty()) throw InputError("goal \"" + spec.name + "\": no cloth is there");
    return {spec.name, goal, spec.tolerance};
}

FitGoal goal_of(const GoalSpec& spec, const DrapeResult& drape, const TriMesh& body) {
    switch (spec.kind) {
    case GoalSpec::Kind::shape: return shape_goal_of(spec, drape);
    case GoalSpec::Kind::level: return level_goal_of(spec, drape);
    case GoalSpec::Kind::ease: return ease_goal_of(spec, drape, body);
    case GoalSpec::Kind::stretch: return stretch_goal_of(spec, drape);
    }
    return {};
}

/// A shape is a place to begin: the equilibrium that is looked for is the one near it. Where it crosses something it is none; to a
/// surface of other triangles the cloth is drawn.
std::function<Points(const Eigen::VectorXd&)> beginning(const std::vector<FitGoal>& goals, const TriMesh& body, AlteredDrape& drape,
                                                        const DrapeResult& before) {
    for (const FitGoal& goal : goals) {
        if (const auto* shape = std::get_if<ShapeGoal>(&goal.what)) {
            const IntersectionCount n =
                count_intersections(node_triangles(before.garment), shape->target, body, before.garment.stitches);
            if (n.cloth_avatar + n.cloth_cloth == 0) return [shape](const Eigen::VectorXd&) { return shape->target; };
        }
        if (const auto* surface = std::get_if<SurfaceGoal>(&goal.what))
            return [surface, &drape, x = before.state.positions](const Eigen::VectorXd& amounts) mutable {
                drape.draw_to(surface->target, amounts, x);
                return x;
            };
    }
    return nullptr;
}

/// The altered pattern draped from nothing, as whoever cuts it will: what is left of the goals.
Json draped_anew(const MovingFlat& moving, const Pattern& pattern, const Avatar& avatar, const PanelFabrics& fabrics,
                 const DrapeOptions& options, const std::vector<FitGoal>& goals, int nodes) {
    const DrapeResult d = drape(stage(pattern, moved_flat(moving, pattern)), avatar, fabrics, options);
    Json misses = Json::array();
    for (const FitGoal& goal : goals)
        misses.push_back(d.garment.node_count == nodes ? Json(miss(goal, d.garment, d.state.positions)) : Json()); // or seams are open
    return {{"status", to_string(d.status)}, {"misses", misses}};
}

Json alterations_json(const MovingFlat& moving, const FitResult& r) {
    Json all = Json::array();
    for (std::size_t k = 0; k < moving.alterations.size(); ++k) {
        const Alteration& a = moving.alterations[k];
        const bool bound = std::find(r.at_bounds.begin(), r.at_bounds.end(), a.name) != r.at_bounds.end();
        all.push_back({{"name", a.name}, {unit_of(a), in_unit(a, r.amounts[Eigen::Index(k)])}, {"at_bound", bound}});
    }
    return all;
}

Json edges_json(const Pattern& drawn, const Pattern& pattern) {
    Json all = Json::array();
    for (const EdgeChange& c : edge_changes(drawn, pattern))
        all.push_back({{"panel", drawn.panels[c.panel].name},
                       {"edge", c.edge},
                       {"length_before_mm", 1e3 * c.before},
                       {"length_after_mm", 1e3 * c.after},
                       {"moved_mm", 1e3 * c.moved}});
    return all;
}

Json elastics_json(const Pattern& drawn, const Pattern& pattern) {
    Json all = Json::array();
    for (const ElasticChange& c : elastic_changes(drawn, pattern)) {
        const EdgeSpan& span = drawn.elastics[c.elastic].span;
        all.push_back({{"panel", drawn.panels[span.panel].name},
                       {"edge", span.edge},
                       {"relaxed_before_mm", 1e3 * c.before},
                       {"relaxed_after_mm", 1e3 * c.after},
                       {"ratio", pattern.elastics[c.elastic].ratio}});
    }
    return all;
}

Json shrunk_json(const Pattern& drawn, const Pattern& pattern) {
    Json all = Json::array();
    for (std::size_t p = 0; p < drawn.panels.size(); ++p) {
        const Vec2 before = 100 * drawn.panels[p].shrink, now = 100 * pattern.panels[p].shrink;
        if (before == now) continue;
        all.push_back({{"panel", drawn.panels[p].name},
                       {"warp_before_percent", before.y()},
                       {"warp_after_percent", now.y()},
                       {"weft_before_percent", before.x()},
                       {"weft_after_percent", now.x()}});
    }
    return all;
}

/// Seams whose sides at rest differ otherwise than as drawn, by cut or by steam.
Json eased_json(const Pattern& drawn, const Pattern& pattern) {
    Json all = Json::array();
    for (const Seam& seam : pattern.seams) {
        const SeamLengths was = seam_lengths_at_rest(drawn, seam), now = seam_lengths_at_rest(pattern, seam);
        if (std::abs(now.a - was.a / was.b * now.b) < least_ease) continue;
        all.push_back({{"seam", seam.name}, {"a_mm", 1e3 * now.a}, {"b_mm", 1e3 * now.b}, {"ease_percent", 100 * now.ease}});
    }
    return all;
}

Json goals_json(const std::vector<FitGoal>& goals, const FitResult& r) {
    Json all = Json::array();
    for (std::size_t k = 0; k < goals.size(); ++k)
        all.push_back({{"name", goals[k].name},
                       {"before", r.before[k]},
                       {"after", r.after[k]},
                       {"tolerance", goals[k].tolerance},
                       {"met", r.after[k] <= goals[k].tolerance}});
    return all;
}

/// Whether there will be something to say beside the pattern.
bool needs_companion(const std::string& pattern, const FitSpec& spec) {
    const auto shrinks = [](const Alteration& a) { return !a.shrinks.empty(); };
    return fs::exists(companion_path(pattern)) || !spec.put_in.empty() ||
           std::any_of(spec.alterations.begin(), spec.alterations.end(), shrinks);
}

std::vector<std::string> targets(const FitJob& job, bool companion) {
    std::vector<std::string> all = job.garments;
    for (const std::string& file : {job.output, job.picture, job.report})
        if (!file.empty()) all.push_back(file);
    if (!job.output.empty() && companion) all.push_back(companion_path(job.output));
    return all;
}

void refuse_faults(const Pattern& pattern) {
    for (const Issue& issue : check(pattern))
        if (issue.severity == Severity::error) throw InputError("the altered pattern cannot be sewn: " + issue.text);
}

} // namespace

FitOutcome run_fit(const FitJob& job) {
    const std::vector<std::string> inputs{job.pattern, companion_path(job.pattern), job.spec, job.avatar, fabric_file(job.fabric)};
    refuse_targets(inputs, targets(job, fs::exists(companion_path(job.pattern))));
    std::vector<std::string> warnings;
    Pattern pattern = sound_pattern(job.pattern, warnings);
    if (const Panel* panel = moulded_panel(pattern))
        throw InputError("panel " + panel->name + " keeps the triangles of " + panel->rest->file +
                         ", which alterations of outlines do not reach; toile fit expects flat panels");
    const FitSpec spec = read_fit_spec(job.spec, pattern);
    pattern.elastics.insert(pattern.elastics.end(), spec.put_in.begin(), spec.put_in.end());
    const bool companion = needs_companion(job.pattern, spec);
    refuse_targets(inputs, targets(job, companion));
    const Body body = read_body(job.avatar, job.form, job.repair_avatar);
    const Avatar avatar{body.mesh, smoothed_toward_core(body.mesh, 0.01)};
    const DrapeInput input = input_of(pattern, job.fabric, job.edge_length);
    const MovingFlat moving = moving_flat(pattern, flat_of(pattern, job.edge_length), spec.alterations);
    refuse_fit(moving, spec.start, spec.options);

    const Pattern begun = altered(pattern, spec.alterations, spec.start);
    const DrapeResult before = drape(stage(begun, moved_flat(moving, begun)), avatar, input.fabrics, job.drape);
    if (before.status != DrapeStatus::converged)
        throw InputError(job.pattern + " does not come to rest before it is altered (" + to_string(before.status) + "): " + before.where);
    std::vector<FitGoal> goals;
    for (const GoalSpec& goal : spec.goals) goals.push_back(goal_of(goal, before, body.mesh));

    AlteredDrape drape(moving, spec.start, before, body.mesh, input.fabrics, job.drape, {fit_tolerance});
    FitOptions options = spec.options;
    options.begin = beginning(goals, body.mesh, drape, before);
    options.max_seconds = job.max_seconds;
    options.progress = job.progress;
    FitOutcome outcome;
    outcome.result = fit(drape, goals, spec.start, before.state.positions, options);
    const FitResult& r = outcome.result;
    const Pattern now = altered(pattern, spec.alterations, r.amounts);
    refuse_faults(now);

    Json report{{"toile", TOILE_VERSION}, {"status", to_string(r.end)}};
    if (!r.why.empty()) report["why"] = r.why;
    report["optimiser"] = to_string(r.optimiser);
    report["goals"] = goals_json(goals, r);
    report["alterations"] = alterations_json(moving, r);
    report["edges"] = edges_json(pattern, now);
    report["elastics"] = elastics_json(pattern, now);
    report["shrunk"] = shrunk_json(pattern, now);
    report["seams"] = {{"kept", r.seams}, {"unequal_mm", 1e3 * r.unequal}, {"eased", eased_json(pattern, now)}};
    report["evaluations"] = r.evaluations;
    report["not_at_rest"] = r.not_at_rest;
    report["rounds"] = r.rounds;
    report["draped_anew"] = draped_anew(moving, now, avatar, input.fabrics, job.drape, goals, before.garment.node_count);
    outcome.report = report.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';

    if (!job.output.empty()) {
        write_file(job.output, altered_pattern_text(job.pattern, pattern, now));
        if (companion) write_file(companion_path(job.output), altered_companion_text(companion_path(job.pattern), pattern, now));
    }
    for (const std::string& path : job.garments) write_garment(path, drape.garment_at(r.amounts), r.x);
    if (!job.picture.empty()) write_file(job.picture, altered_svg(pattern, now));
    if (!job.report.empty()) write_file(job.report, outcome.report);
    outcome.written = targets(job, companion);
    return outcome;
}

} // namespace toile

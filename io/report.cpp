// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/report.h"

#include "geometry/memory.h"
#include "io/hash.h"
#include "io/write_garment.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <set>

namespace toile {
namespace {

using Json = nlohmann::ordered_json;

/// JSON has no infinity.
Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json spread(const Spread& s) {
    return {{"min", s.min}, {"max", s.max}, {"p99", s.p99}, {"mean", s.mean}};
}

Json limited(const Spread& s, double limit) {
    Json out = spread(s);
    out["limit"] = limit;
    return out;
}

Json ease_at(const DrapeResult& r, const TriMesh& body, double height) {
    const EaseMeasure e = measure_ease(r.garment, r.state.positions, body, height);
    if (!e.found) return nullptr;
    return {{"height", height}, {"garment", e.garment}, {"body", e.body}, {"ease", e.ease}};
}

Json ease(const DrapeResult& r, const TriMesh& body, const std::optional<BodyMeasures>& at) {
    if (!at) return {{"bust", nullptr}, {"waist", nullptr}, {"hip", nullptr}};
    return {{"bust", ease_at(r, body, at->bust_y)},
            {"waist", ease_at(r, body, at->waist_y)},
            {"hip", ease_at(r, body, at->hip_y)}};
}

Json levels(const DrapeResult& r) {
    Json out = Json::array();
    for (const LevelReport& l : r.levels)
        out.push_back({{"edge_length", l.edge_length},
                       {"vertices", l.vertices},
                       {"iterations", l.iterations},
                       {"part_iterations", l.part_iterations},
                       {"factorisations", l.factorisations},
                       {"seconds", l.seconds}});
    return out;
}

Json landmarks(const DrapeResult& r) {
    Json out = Json::array();
    for (const Landmark& l : r.landmarks)
        out.push_back({{"label", l.label},
                       {"placed", l.placed},
                       {"settled", l.settled},
                       {"belongs", to_string(l.belongs)},
                       {"off", l.off ? Json(*l.off) : Json(nullptr)}});
    return out;
}

Json seconds(const DrapeResult& r, const ReportContext& context) {
    Json out{{"total", context.total_seconds}};
    for (const auto* list : {&context.seconds, &r.seconds})
        for (const StageSeconds& s : *list)
            out[s.stage] = out.value(s.stage, 0.0) + s.seconds;
    out["contact"] = r.contact.seconds;
    return out;
}

Json frames(const std::vector<FrameRow>& rows) {
    Json out = Json::array();
    for (const auto& [frame, r] : rows)
        out.push_back({{"frame", frame},
                       {"status", to_string(r.status)},
                       {"where", r.where},
                       {"residual", number(r.residual)},
                       {"behind", r.behind},
                       {"intersections",
                        {{"cloth_avatar", r.intersections.cloth_avatar}, {"cloth_cloth", r.intersections.cloth_cloth}}},
                       {"substeps", r.substeps},
                       {"iterations", r.iterations},
                       {"seconds", r.seconds}});
    return out;
}

std::vector<std::string> joined(std::vector<std::string> a, const std::vector<std::string>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

struct Contact {
    IntersectionCount count;
    double clearance = 0;
};

Contact measure_contact(const Garment& garment, const Points& x, const TriMesh& body) {
    const std::vector<Triangle> cloth = node_triangles(garment);
    return {count_intersections(cloth, x, body, garment.stitches), clearance_min(cloth, x, body)};
}

Contact worst_contact(const DrapeResult& r, const TriMesh& body, bool written_as_float) {
    Contact worst = measure_contact(r.garment, r.state.positions, body);
    if (!written_as_float) return worst;
    const Contact rounded = measure_contact(r.garment, rounded_to_float(r.state.positions), body);
    worst.count.cloth_avatar = std::max(worst.count.cloth_avatar, rounded.count.cloth_avatar);
    worst.count.cloth_cloth = std::max(worst.count.cloth_cloth, rounded.count.cloth_cloth);
    worst.clearance = std::min(worst.clearance, rounded.clearance);
    return worst;
}

Json place(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

Json crossing_json(const Crossing& c, const Garment& garment) {
    Json panels = Json::array();
    for (const int p : c.panels) panels.push_back(garment.panel_names[p]);
    return {{"with", c.with_body ? "body" : "cloth"}, {"at", place(c.at)}, {"panels", panels}, {"pairs", c.pairs}};
}

Json inside_json(const InsideBody& i, const Garment& garment) {
    Json json{{"nodes", i.nodes}, {"depth", i.depth}};
    if (i.nodes > 0) {
        json["at"] = place(i.at);
        json["panel"] = garment.panel_names[i.panel];
    }
    return json;
}

Json accuracy(const AccuracyReport& a) {
    Json meshes = Json::array(), decisions = Json::array();
    for (const AccuracyMesh& m : a.meshes)
        meshes.push_back({{"edge_length", m.edge_length},
                          {"vertices", m.vertices},
                          {"iterations", m.iterations},
                          {"seconds", m.seconds},
                          {"difference", m.difference ? Json(*m.difference) : Json(nullptr)},
                          {"motion", m.motion}});
    for (const AccuracyDecision& d : a.decisions)
        decisions.push_back({{"decision", d.what}, {"measure", d.measure}, {"value", d.value}, {"taken_back", d.taken_back}});
    const auto or_null = [](const std::optional<double>& v) { return v ? Json(*v) : Json(nullptr); };
    return {{"of", a.of == AccuracyOf::strain ? "strain" : "place"},
            {"asked", or_null(a.asked)},
            {"budget", or_null(a.budget)},
            {"estimate", or_null(a.estimate)},
            {"discretisation", a.discretisation},
            {"residual", a.residual},
            {"order", a.order},
            {"met", a.met},
            {"meshes", meshes},
            {"decisions", decisions}};
}

Json motion(const MotionReport& m) {
    return {{"duration", (m.frames - 1) / m.rate},
            {"fps", m.rate},
            {"frames", m.frames},
            {"time_step", m.time_step},
            {"steps_per_frame", m.steps_per_frame},
            {"air_damping", m.air_damping},
            {"slowed", m.slowed},
            {"speed", m.speed}};
}

} // namespace

nlohmann::ordered_json strain_json(const StrainMeasure& m) {
    return {{"warp", limited(m.warp, m.limit_warp)},
            {"weft", limited(m.weft, m.limit_weft)},
            {"principal", spread(m.principal)},
            {"shear", limited(m.shear, m.limit_shear)},
            {"compressed_area", m.compressed_area},
            {"narrowed_area", m.narrowed_area}};
}

Json inspection_json(const Inspection& i, const Garment& garment) {
    Json json{
        {"panels", i.panels},
        {"vertices", i.vertices},
        {"nodes", i.nodes},
        {"triangles", i.triangles},
        {"pieces", i.pieces},
        {"border_loops", i.border_loops},
        {"joined_nodes", i.joined_nodes},
        {"crowded_edges", i.crowded_edges},
        {"turned_edges", i.turned_edges},
        {"flat_triangles", i.flat_triangles},
        {"not_finite", i.not_finite},
        {"area", i.area},
        {"mean_edge", i.mean_edge},
        {"seam_gap_max", i.seam_gap_max},
        {"intersections",
         {{"cloth_avatar", i.intersections.cloth_avatar}, {"cloth_cloth", i.intersections.cloth_cloth}}}};
    json["crossings"] = Json::array();
    for (const Crossing& c : i.crossings) json["crossings"].push_back(crossing_json(c, garment));
    json["seam_gaps"] = Json::array();
    for (const SeamGap& g : i.gaps)
        json["seam_gaps"].push_back({{"panels", {garment.panel_names[g.panels[0]], garment.panel_names[g.panels[1]]}},
                                     {"gap", g.gap},
                                     {"at", place(g.at)},
                                     {"stitches", g.stitches},
                                     {"open", g.open}});
    if (i.has_body) {
        json["clearance_min"] = number(i.clearance);
        json["inside"] = i.inside.known ? inside_json(i.inside, garment) : Json(nullptr);
    }
    if (!i.has_pattern) return json;
    json["strain"] = strain_json(i.strain);
    json["developability"] = {{"angle_defect_mean", i.developability.angle_defect_mean},
                              {"angle_defect_max", i.developability.angle_defect_max}};
    return json;
}

Json points_json(const std::vector<StretchPoint>& points) {
    Json list = Json::array();
    for (const StretchPoint& p : points) list.push_back({p.stretch, p.tension});
    return list;
}

/// Of every fabric used that has some.
Json curves_json(const PanelFabrics& fabrics) {
    Json list = Json::array();
    std::set<std::string> seen;
    for (const Fabric& f : fabrics)
        if ((!f.curve_warp.empty() || !f.curve_weft.empty()) && seen.insert(f.name).second)
            list.push_back({{"fabric", f.name}, {"warp", points_json(f.curve_warp)}, {"weft", points_json(f.curve_weft)}});
    return list;
}

nlohmann::ordered_json make_report(const DrapeResult& r, const TriMesh& body, const PanelFabrics& fabrics,
                                   const ReportContext& context) {
    const Points& x = r.state.positions;
    const Contact contact = worst_contact(r, body, context.written_as_float);
    const DevelopabilityMeasure bent = measure_developability(r.garment, x);
    Json report = {
        {"status", to_string(r.status)},
        {"where", r.where},
        {"residual", number(r.residual)},
        {"tolerance", r.tolerance},
        {"strain", strain_json(measure_strain(r.garment, x, fabrics))},
        {"seam_gap_max", seam_gap_max(r.garment, x)},
        {"intersections",
         {{"cloth_avatar", contact.count.cloth_avatar}, {"cloth_cloth", contact.count.cloth_cloth}}},
        {"clearance_min", number(contact.clearance)},
        {"developability",
         {{"angle_defect_mean", bent.angle_defect_mean}, {"angle_defect_max", bent.angle_defect_max}}},
        {"ease", ease(r, body, context.body_measures)},
        {"landmarks", landmarks(r)},
        {"vertices", r.garment.uv.size()},
        {"nodes", r.garment.node_count},
        {"triangles", r.garment.triangles.size()},
        {"pieces", count_pieces(r.garment)},
        {"levels", levels(r)},
        {"seconds", seconds(r, context)},
        {"peak_memory_bytes", std::uint64_t(memory_use().peak)},
        {"threads", context.threads},
        {"blas", context.blas},
        {"version", TOILE_VERSION},
        {"fabric", context.fabric},
        {"friction", r.friction.body},
        {"cloth_friction", r.friction.cloth},
        {"method", to_string(r.method)},
        {"barrier",
         {{"distance", r.barrier.distance},
          {"stiffness", r.barrier.stiffness},
          {"cloth_stiffness", r.barrier.cloth_stiffness}}},
        {"contact",
         {{"response", to_string(r.contact.response)},
          {"guarantee", to_string(r.contact.guarantee)},
          {"unresolved", r.contact.unresolved}}},
        {"input_hash", context.input_hash},
        {"result_hash", result_hash(r.garment, x)},
        {"decisions", joined(context.decisions, r.decisions)},
        {"warnings", joined(context.warnings, r.warnings)},
    };
    if (Json curves = curves_json(fabrics); !curves.empty()) report["stretch_curves"] = std::move(curves);
    if (!context.frames.empty()) report["frames"] = frames(context.frames);
    if (r.motion) report["motion"] = motion(*r.motion);
    if (r.accuracy) report["accuracy"] = accuracy(*r.accuracy);
    return report;
}

std::string report_json(const DrapeResult& result, const TriMesh& body, const PanelFabrics& fabrics,
                        const ReportContext& context) {
    const Json report = make_report(result, body, fabrics, context);
    return report.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

} // namespace toile

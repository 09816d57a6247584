// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/fit_spec.h"

#include "io/json.h"
#include "io/write_file.h"

#include <algorithm>
#include <filesystem>

namespace toile {

namespace {

constexpr double mm = 1e-3, percent = 0.01;
constexpr double most_length = 1e4; // mm
constexpr std::size_t most_alterations = 500, most_goals = 100, most_members = 10'000;

double length_in(const JsonView& v) { return mm * v.number(-most_length, most_length); }

/// Names stand in sentences.
std::string name_in(const JsonView& v) {
    const std::string name = v.string();
    const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
    if (name.empty() || name.size() > 80 || std::any_of(name.begin(), name.end(), is_control))
        v.fail("a name of 1 to 80 characters on one line");
    return name;
}

int panel_in(const JsonView& v, const Pattern& pattern) {
    const std::string name = v.string();
    for (int p = 0; p < int(pattern.panels.size()); ++p)
        if (pattern.panels[p].name == name) return p;
    v.fail("the name of a panel");
}

int edge_in(const JsonView& v, const Pattern& pattern, int panel) {
    return v.integer(0, int(pattern.panels[panel].outline.size()) - 1);
}

Vec2 direction_in(const JsonView& v) {
    v.expect_array(2, 2);
    const Vec2 d(v.at(0, "component").number(-1e6, 1e6), v.at(1, "component").number(-1e6, 1e6));
    if (!(d.norm() > 0)) v.fail("a direction that is not zero");
    return d.normalized();
}

std::vector<OutlineMove> outline_moves_in(const JsonView& v, const Pattern& pattern) {
    if (v.has("seam")) return move_seam(pattern, v.at("seam").integer(0, int(pattern.seams.size()) - 1));
    const int panel = panel_in(v.at("panel"), pattern);
    if (v.has("lengthen")) return lengthen_edge(pattern, panel, edge_in(v.at("lengthen"), pattern, panel));
    if (v.has("edge_outward")) return move_edge(pattern, panel, edge_in(v.at("edge_outward"), pattern, panel));
    if (v.has("dart")) return widen_dart(pattern, panel, edge_in(v.at("dart"), pattern, panel));
    const Vec2 direction = direction_in(v.at("direction"));
    if (v.has("vertex")) return {{{panel, edge_in(v.at("vertex"), pattern, panel), 0}, direction}};
    return {{{panel, edge_in(v.at("edge"), pattern, panel), v.at("control").integer(1, 2)}, direction}};
}

/// The edges of a label, of one panel where that is named, or an edge of a panel.
std::vector<EdgeSpan> spans_in(const JsonView& v, const Pattern& pattern) {
    const JsonView where = v.at("elastic");
    if (!where.value().is_string()) {
        const int panel = panel_in(v.at("panel"), pattern);
        return {{panel, edge_in(where, pattern, panel)}};
    }
    const int only = v.has("panel") ? panel_in(v.at("panel"), pattern) : -1;
    std::vector<EdgeSpan> spans;
    for (int p = 0; p < int(pattern.panels.size()); ++p)
        for (int e = 0; e < int(pattern.panels[p].outline.size()); ++e)
            if ((only < 0 || only == p) && pattern.panels[p].outline[e].label == where.string()) spans.push_back({p, e});
    if (spans.empty()) where.fail("the label of an edge");
    return spans;
}

std::vector<int> elastics_on(const std::vector<EdgeSpan>& spans, const Pattern& pattern) {
    std::vector<int> found;
    for (int k = 0; k < int(pattern.elastics.size()); ++k)
        for (const EdgeSpan& s : spans)
            if (s.panel == pattern.elastics[k].span.panel && s.edge == pattern.elastics[k].span.edge) found.push_back(k);
    return found;
}

/// Those that are there, or with a stiffness new ones, as long as the cloth, where there are none.
std::vector<int> elastics_in(const JsonView& v, Pattern& pattern) {
    const std::vector<EdgeSpan> spans = spans_in(v, pattern);
    const std::vector<int> there = elastics_on(spans, pattern);
    if (!v.has("stiffness")) {
        if (there.empty()) v.at("elastic").fail("where the companion file has an elastic; with a \"stiffness\" one is put in");
        return there;
    }
    if (!there.empty()) v.at("stiffness").fail("left out where there is an elastic already");
    for (const EdgeSpan& span : spans) pattern.elastics.push_back({span, 1, v.at("stiffness").number(1e-3, 1e6)});
    return elastics_on(spans, pattern);
}

Vec2 shrink_in(const JsonView& v) {
    const std::string along = v.string();
    if (along == "warp") return {0, 1};
    if (along == "weft") return {1, 0};
    if (along == "both") return {1, 1};
    v.fail("\"warp\", \"weft\" or \"both\"");
}

/// One of the forms.
Alteration form_in(const JsonView& v, Pattern& pattern, bool share) {
    Alteration one;
    if (v.has("elastic")) {
        const std::vector<int> elastics = elastics_in(v, pattern);
        if (!share)
            one.elastics = lengthen_elastics(pattern, elastics);
        else
            for (const int e : elastics) one.elastics.push_back({e, 1});
    } else if (v.has("shrink")) {
        if (!share) throw InputError(v.place() + ": cloth is shrunk by a share of its length; the alteration needs \"unit\": \"percent\"");
        one.shrinks = {{panel_in(v.at("panel"), pattern), shrink_in(v.at("shrink"))}};
    } else if (v.has("ease")) {
        if (share) throw InputError(v.place() + ": a seam is eased by mm; \"unit\": \"percent\" is for \"elastic\" and \"shrink\"");
        one.eases = {{v.at("ease").integer(0, int(pattern.seams.size()) - 1), 1}};
    } else {
        if (share) throw InputError(v.place() + ": outlines move by mm; \"unit\": \"percent\" is for \"elastic\" and \"shrink\"");
        one.moves = outline_moves_in(v, pattern);
    }
    return one;
}

/// Adds one of the forms, times "by".
void add_form(const JsonView& v, Pattern& pattern, Alteration& a) {
    Alteration one;
    try {
        one = form_in(v, pattern, a.share);
        altered(pattern, {one}, Eigen::VectorXd::Zero(1)); // controls that do not exist
    } catch (const std::invalid_argument& error) {
        throw InputError(v.place() + ": " + error.what());
    }
    const double by = v.has("by") ? v.at("by").number(-100, 100) : 1;
    for (const OutlineMove& m : one.moves) a.moves.push_back({m.point, by * m.step});
    for (const ElasticMove& m : one.elastics) a.elastics.push_back({m.elastic, by * m.ratio});
    for (const EaseMove& m : one.eases) a.eases.push_back({m.seam, by * m.length});
    for (const ShrinkMove& m : one.shrinks) a.shrinks.push_back({m.panel, by * m.share});
}

double amount_in(const JsonView& v, const Alteration& a) { return a.share ? percent * v.number(-100, 100) : length_in(v); }

Alteration alteration_in(const JsonView& v, Pattern& pattern) {
    v.expect_keys({"name", "low", "high", "start", "unit", "moves", "seam", "panel", "lengthen", "edge_outward", "dart", "vertex", "edge",
                   "control", "direction", "elastic", "stiffness", "shrink", "ease", "by"});
    Alteration a;
    a.name = name_in(v.at("name"));
    if (v.has("unit")) {
        const std::string unit = v.at("unit").string();
        if (unit != "mm" && unit != "percent") v.at("unit").fail("\"mm\" or \"percent\"");
        a.share = unit == "percent";
    }
    a.low = amount_in(v.at("low"), a);
    a.high = amount_in(v.at("high"), a);
    if (!v.has("moves")) {
        add_form(v, pattern, a);
        return a;
    }
    const JsonView moves = v.at("moves");
    moves.expect_array(1, most_members);
    for (std::size_t k = 0; k < moves.value().size(); ++k) {
        const JsonView one = moves.at(k, "move");
        one.expect_keys({"seam", "panel", "lengthen", "edge_outward", "dart", "vertex", "edge", "control", "direction", "elastic", "stiffness",
                         "shrink", "ease", "by"});
        add_form(one, pattern, a);
    }
    return a;
}

/// Panels by name; all of them when none is named.
std::vector<int> panels_in(const JsonView& goal, const Pattern& pattern) {
    std::vector<int> panels;
    if (!goal.has("panels")) {
        for (int p = 0; p < int(pattern.panels.size()); ++p) panels.push_back(p);
        return panels;
    }
    const JsonView list = goal.at("panels");
    list.expect_array(1, most_members);
    for (std::size_t k = 0; k < list.value().size(); ++k) panels.push_back(panel_in(list.at(k, "panel"), pattern));
    return panels;
}

std::vector<std::array<int, 2>> edges_in(const JsonView& list, const Pattern& pattern) {
    std::vector<std::array<int, 2>> edges;
    list.expect_array(1, most_members);
    for (std::size_t k = 0; k < list.value().size(); ++k) {
        const JsonView pair = list.at(k, "edge");
        pair.expect_array(2, 2);
        const int panel = panel_in(pair.at(0, "panel"), pattern);
        edges.push_back({panel, edge_in(pair.at(1, "edge"), pattern, panel)});
    }
    return edges;
}

void read_stretch(const JsonView& v, const Pattern& pattern, GoalSpec& goal) {
    goal.kind = GoalSpec::Kind::stretch;
    const std::string along = v.at("stretch").string();
    if (along != "warp" && along != "weft") v.at("stretch").fail("\"warp\" or \"weft\"");
    goal.warp = along == "warp";
    goal.amount = percent * v.at("most").number(0, 1000);
    goal.panels = panels_in(v, pattern);
    goal.tolerance = percent * v.at("tolerance").number(1e-6, 1000);
    if (!v.has("near")) return;
    const JsonView near = v.at("near");
    near.expect_array(3, 3);
    goal.near = Vec3(length_in(near.at(0, "coordinate")), length_in(near.at(1, "coordinate")), length_in(near.at(2, "coordinate")));
    goal.within = mm * v.at("within").number(1e-3, most_length);
}

GoalSpec goal_in(const JsonView& v, const Pattern& pattern, const std::filesystem::path& folder) {
    v.expect_keys({"name", "shape", "level", "ease", "stretch", "height", "panels", "most", "near", "within", "tolerance"});
    GoalSpec goal;
    if (v.has("stretch")) {
        read_stretch(v, pattern, goal);
    } else {
        goal.tolerance = mm * v.at("tolerance").number(1e-6, most_length);
        if (v.has("height")) goal.height = length_in(v.at("height"));
        if (v.has("shape")) {
            goal.kind = GoalSpec::Kind::shape;
            goal.file = (folder / v.at("shape").string()).string();
        } else if (v.has("level")) {
            goal.kind = GoalSpec::Kind::level;
            goal.edges = edges_in(v.at("level"), pattern);
        } else {
            goal.kind = GoalSpec::Kind::ease;
            goal.amount = length_in(v.at("ease"));
            goal.height = length_in(v.at("height"));
            goal.panels = panels_in(v, pattern);
        }
    }
    constexpr const char* kinds[] = {"shape", "level", "ease", "stretch"};
    goal.name = v.has("name") ? name_in(v.at("name")) : kinds[int(goal.kind)];
    return goal;
}

Optimiser optimiser_in(const JsonView& v) {
    const std::string word = v.string();
    for (const Optimiser o : {Optimiser::slsqp, Optimiser::lbfgs, Optimiser::cobyla})
        if (word == to_string(o)) return o;
    v.fail("\"slsqp\", \"lbfgs\" or \"cobyla\"");
}

} // namespace

FitSpec read_fit_spec(const std::string& path, const Pattern& pattern) {
    const Json json = parse_json(read_file(path, JsonLimits{}.max_bytes), path);
    const JsonView root(json, path);
    root.expect_object();
    root.expect_keys({"alterations", "goals", "optimiser", "max_evaluations", "stay"});
    FitSpec spec;
    Pattern with = pattern;
    const JsonView alterations = root.at("alterations"), goals = root.at("goals");
    alterations.expect_array(1, most_alterations);
    goals.expect_array(1, most_goals);
    spec.start = Eigen::VectorXd::Zero(Eigen::Index(alterations.value().size()));
    for (std::size_t k = 0; k < alterations.value().size(); ++k) {
        const JsonView one = alterations.at(k, "alteration");
        one.expect_object();
        spec.alterations.push_back(alteration_in(one, with));
        if (one.has("start")) spec.start[Eigen::Index(k)] = amount_in(one.at("start"), spec.alterations.back());
    }
    spec.put_in.assign(with.elastics.begin() + std::ptrdiff_t(pattern.elastics.size()), with.elastics.end());
    for (std::size_t k = 0; k < goals.value().size(); ++k) {
        const JsonView one = goals.at(k, "goal");
        one.expect_object();
        spec.goals.push_back(goal_in(one, pattern, std::filesystem::path(path).parent_path()));
    }
    if (root.has("optimiser")) spec.options.optimiser = optimiser_in(root.at("optimiser"));
    if (root.has("max_evaluations")) spec.options.max_evaluations = root.at("max_evaluations").integer(1, 100'000);
    if (root.has("stay")) spec.options.stay = root.at("stay").number(0, 1e6);
    return spec;
}

} // namespace toile

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

std::vector<OutlineMove> move_in(const JsonView& v, const Pattern& pattern) {
    if (v.has("seam")) return move_seam(pattern, v.at("seam").integer(0, int(pattern.seams.size()) - 1));
    const int panel = panel_in(v.at("panel"), pattern);
    if (v.has("lengthen")) return lengthen_edge(pattern, panel, edge_in(v.at("lengthen"), pattern, panel));
    if (v.has("edge_outward")) return move_edge(pattern, panel, edge_in(v.at("edge_outward"), pattern, panel));
    if (v.has("dart")) return widen_dart(pattern, panel, edge_in(v.at("dart"), pattern, panel));
    const Vec2 direction = direction_in(v.at("direction"));
    if (v.has("vertex")) return {{{panel, edge_in(v.at("vertex"), pattern, panel), 0}, direction}};
    return {{{panel, edge_in(v.at("edge"), pattern, panel), v.at("control").integer(1, 2)}, direction}};
}

/// One of the forms, times "by".
std::vector<OutlineMove> moves_in(const JsonView& v, const Pattern& pattern) {
    std::vector<OutlineMove> moves;
    try {
        moves = move_in(v, pattern);
        altered(pattern, {{"", moves, -1, 1}}, Eigen::VectorXd::Zero(1)); // controls that do not exist
    } catch (const std::invalid_argument& error) {
        throw InputError(v.place() + ": " + error.what());
    }
    const double by = v.has("by") ? v.at("by").number(-100, 100) : 1;
    for (OutlineMove& m : moves) m.step *= by;
    return moves;
}

Alteration alteration_in(const JsonView& v, const Pattern& pattern) {
    v.expect_keys({"name", "low", "high", "start", "moves", "seam", "panel", "lengthen", "edge_outward", "dart", "vertex", "edge",
                   "control", "direction", "by"});
    Alteration a;
    a.name = name_in(v.at("name"));
    a.low = length_in(v.at("low"));
    a.high = length_in(v.at("high"));
    if (!v.has("moves")) {
        a.moves = moves_in(v, pattern);
        return a;
    }
    const JsonView moves = v.at("moves");
    moves.expect_array(1, most_members);
    for (std::size_t k = 0; k < moves.value().size(); ++k) {
        const JsonView one = moves.at(k, "move");
        one.expect_keys({"seam", "panel", "lengthen", "edge_outward", "dart", "vertex", "edge", "control", "direction", "by"});
        const auto more = moves_in(one, pattern);
        a.moves.insert(a.moves.end(), more.begin(), more.end());
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
    const JsonView alterations = root.at("alterations"), goals = root.at("goals");
    alterations.expect_array(1, most_alterations);
    goals.expect_array(1, most_goals);
    spec.start = Eigen::VectorXd::Zero(Eigen::Index(alterations.value().size()));
    for (std::size_t k = 0; k < alterations.value().size(); ++k) {
        const JsonView one = alterations.at(k, "alteration");
        one.expect_object();
        spec.alterations.push_back(alteration_in(one, pattern));
        if (one.has("start")) spec.start[Eigen::Index(k)] = length_in(one.at("start"));
    }
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

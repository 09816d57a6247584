// SPDX-License-Identifier: GPL-3.0-or-later
// Fits of real patterns, in time over that of a drape: bench_fit [hem] [tee] [20mm]. Patterns and bodies are those of the
// folder that TOILE_TEST_DATA names.
//
// hem: the pencil skirt's hem is levelled on a body one of whose hips stands out. tee: the shirt in amounts of twelve
// alterations by up to 3 cm off, recovered from the drape of the pattern as drawn.
#include "bench/asked.h"
#include "draping/fit/fit.h"
#include "io/read_avatar.h"
#include "src/drape_input.h"
#include "src/quantity.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>

using namespace toile;

namespace {

using Clock = std::chrono::steady_clock;
double since(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

struct Scene {
    MovingFlat moving;
    PanelFabrics fabrics;
    Avatar avatar;
    DrapeOptions options;
    double drape_seconds = 0; ///< the shortest of those made

    DrapeResult drape_of(const Eigen::VectorXd& amounts, const Points& from = {}) {
        const Pattern p = altered(moving.drawn, moving.alterations, amounts);
        const Staging staging = stage(p, moved_flat(moving, p));
        DrapeOptions o = options;
        o.from = from;
        const auto start = Clock::now();
        DrapeResult d = drape(staging, avatar, fabrics, o);
        const double s = since(start);
        if (from.empty()) drape_seconds = drape_seconds == 0 ? s : std::min(s, drape_seconds);
        if (d.status != DrapeStatus::converged) std::printf("<!-- %s: %s -->\n", to_string(d.status), d.where.c_str());
        return d;
    }
};

Scene scene_of(const Pattern& pattern, std::vector<Alteration> alterations, TriMesh body, const std::string& fabric, double edge) {
    Scene s;
    s.fabrics = input_of(pattern, fabric, edge).fabrics;
    s.moving = moving_flat(pattern, flat_of(pattern, edge), std::move(alterations));
    Points core = smoothed_toward_core(body, 0.01);
    s.avatar = {std::move(body), std::move(core)};
    return s;
}

Pattern pattern_of(const std::string& data, const std::string& name) {
    std::vector<std::string> warnings;
    return sound_pattern(data + "/garmentcode/" + name + "_specification.json", warnings);
}

TriMesh body_of(const std::string& data, const std::string& name) { return read_avatar(data + "/bodies/" + name, {}).body; }

int panel_called(const Pattern& p, const std::string& name) {
    for (int k = 0; k < int(p.panels.size()); ++k)
        if (p.panels[k].name == name) return k;
    throw std::runtime_error("no panel " + name);
}

void print(const char* name, const Scene& s, const FitResult& r, double unit) {
    std::printf("| %s | %d | %d | %s | %.2f | %.2f | %d | %d | %d | %.1f | %.2f | %.1f | %.4f |\n", name,
                int(s.moving.flat.levels.back().points.size()), int(r.amounts.size()), to_string(r.end), unit * r.before[0],
                unit * r.after[0], r.evaluations, r.not_at_rest, r.rounds, r.seconds, s.drape_seconds, r.seconds / s.drape_seconds,
                1e3 * r.unequal);
    if (!r.why.empty()) std::printf("<!-- %s -->\n", r.why.c_str());
    for (std::size_t k = 0; k < s.moving.alterations.size(); ++k)
        std::printf("<!-- %s: %.2f mm -->\n", s.moving.alterations[k].name.c_str(), 1e3 * r.amounts[Eigen::Index(k)]);
}

/// One hip, on the wearer's left (+x), stands out by 2.5 cm.
TriMesh uneven(TriMesh body) {
    const double hip = measure_body(body).hip_y;
    for (Vec3& p : body.points) {
        const double side = std::clamp(p.x() / 0.12, 0.0, 1.0), off = (p.y() - hip) / 0.07;
        if (p.x() < 0.25) p.x() += 0.025 * side * side * (3 - 2 * side) * std::exp(-off * off);
    }
    return body;
}

void level_hem(const std::string& data, double edge) {
    Pattern pattern = pattern_of(data, "pencil_skirt");
    const int front = panel_called(pattern, "skirt_front"), back = panel_called(pattern, "skirt_back");
    std::vector<Alteration> alterations;
    const auto add = [&](const std::string& name, OutlinePoint point) {
        alterations.push_back({name, {{point, {0, 1}}}, -0.05, 0.05});
    };
    for (const auto& [panel, hem] : {std::pair{front, 0}, std::pair{back, 17}}) {
        Edge& e = pattern.panels[panel].outline[hem]; // straight as drawn; it may be bent
        e.curve = Cubic{e.start + (e.end - e.start) / 3, e.start + 2 * (e.end - e.start) / 3};
        const std::string name = pattern.panels[panel].name;
        add(name + ", start", {panel, hem, 0});
        add(name + ", first third", {panel, hem, 1});
        add(name + ", second third", {panel, hem, 2});
        add(name + ", end", {panel, (hem + 1) % int(pattern.panels[panel].outline.size()), 0});
    }
    Scene s = scene_of(pattern, alterations, uneven(body_of(data, "mean_female.obj")), "jersey", edge);
    const Eigen::VectorXd start = Eigen::VectorXd::Zero(Eigen::Index(alterations.size()));
    const DrapeResult before = s.drape_of(start);
    std::vector<std::vector<int>> lines;
    for (const BorderLine& line : before.garment.borders)
        if ((line.panel == front && line.edge == 0) || (line.panel == back && line.edge == 17)) lines.push_back(line.vertices);
    const std::vector<FitGoal> goals{{"hem", level_goal(before.garment, lines, {}), 2e-3}};
    AlteredDrape drape(s.moving, start, before, s.avatar.body, s.fabrics, s.options, {1e-7});
    const FitResult r = fit(drape, goals, start, before.state.positions);
    const DrapeResult anew = s.drape_of(r.amounts);
    print("hem, mm off level at most", s, r, 1e3);
    std::printf("<!-- draped anew: %.2f mm -->\n", 1e3 * miss(goals[0], anew.garment, anew.state.positions));
}

std::vector<Alteration> of_the_shirt(const Pattern& p) {
    const int lf = panel_called(p, "left_ftorso"), lb = panel_called(p, "left_btorso"), rb = panel_called(p, "right_btorso"),
              rf = panel_called(p, "right_ftorso");
    const Vec2 up(0, 1), right(1, 0), left(-1, 0);
    std::vector<Alteration> all;
    const auto add = [&](const char* name, std::vector<OutlineMove> moves) { all.push_back({name, std::move(moves), -0.04, 0.04}); };
    add("hem, left side", {{{lf, 1, 0}, up}, {{lb, 5, 0}, up}});
    add("hem, right side", {{{rf, 5, 0}, up}, {{rb, 1, 0}, up}});
    add("hem, front", {{{lf, 0, 0}, up}, {{rf, 0, 0}, up}});
    add("hem, back", {{{lb, 0, 0}, up}, {{rb, 0, 0}, up}});
    add("left front, width", move_edge(p, lf, 1));
    add("right front, width", move_edge(p, rf, 4));
    add("left back, width", move_edge(p, lb, 4));
    add("right back, width", move_edge(p, rb, 1));
    add("neck, front", {{{lf, 5, 0}, up}, {{rf, 1, 0}, up}});
    add("neck, back", {{{lb, 1, 0}, up}, {{rb, 5, 0}, up}});
    add("left shoulder", {{{lf, 3, 0}, right}, {{lb, 3, 0}, right}});
    add("right shoulder", {{{rf, 3, 0}, left}, {{rb, 3, 0}, left}});
    return all;
}

void recover_tee(const std::string& data, double edge) {
    const Pattern pattern = pattern_of(data, "tshirt");
    Scene s = scene_of(pattern, of_the_shirt(pattern), body_of(data, "mean_all.obj"), "poplin", edge);
    const Eigen::Index n = Eigen::Index(s.moving.alterations.size());
    Eigen::VectorXd start(n);
    for (Eigen::Index k = 0; k < n; ++k) start[k] = (k % 2 ? -1 : 1) * (0.03 - 0.015 * double((5 * k) % n) / double(n - 1));
    const DrapeResult target = s.drape_of(Eigen::VectorXd::Zero(n)), before = s.drape_of(start);
    const std::vector<FitGoal> goals{{"shape", shape_goal(before.garment, target.state.positions), 1e-3}};
    AlteredDrape drape(s.moving, start, before, s.avatar.body, s.fabrics, s.options, {1e-7});
    FitOptions options;
    options.begin = [&](const Eigen::VectorXd&) { return target.state.positions; };
    const FitResult r = fit(drape, goals, start, target.state.positions, options);
    print("tee, mm off the shape, RMS", s, r, 1e3);
    const auto off = [&](const DrapeResult& d) { return 1e3 * miss(goals[0], d.garment, d.state.positions); };
    std::printf("<!-- amounts off by %.2f mm at most and %.2f mm in the mean, were %.1f and %.1f -->\n", 1e3 * r.amounts.cwiseAbs().maxCoeff(),
                1e3 * r.amounts.cwiseAbs().mean(), 1e3 * start.cwiseAbs().maxCoeff(), 1e3 * start.cwiseAbs().mean());
    std::printf("<!-- draped anew: %.2f mm, was %.2f; from the shape: %.2f mm, was %.2f -->\n", off(s.drape_of(r.amounts)), off(before),
                off(s.drape_of(r.amounts, target.state.positions)), off(s.drape_of(start, target.state.positions)));
}

} // namespace

int main(int count, char** words) {
    const char* data = std::getenv("TOILE_TEST_DATA");
    if (!data) {
        std::fprintf(stderr, "usage: TOILE_TEST_DATA=folder bench_fit [hem] [tee] [EDGE_LENGTH]\n");
        return 1;
    }
    double edge = 0.02;
    if (count > 1 && std::isdigit(words[count - 1][0])) edge = parse_length(words[--count]);
    std::printf("| fit | vertices | alterations | status | before | after | equilibria | not at rest | rounds | s | s of a drape | "
                "drapes | seams unequal mm |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    if (asked(count, words, "hem")) level_hem(data, edge);
    if (asked(count, words, "tee")) recover_tee(data, edge);
}

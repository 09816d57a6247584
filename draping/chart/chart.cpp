// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/chart/chart.h"

#include "draping/chart/scene_rest.h"
#include "geometry/parallel.h"
#include "geometry/text.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

namespace toile {

namespace {

constexpr double exact = 1e-10;    // residual of what a solver's error is measured from, or what rounding leaves after
constexpr int exact_iterations = 50; // so many more iterations: with a stiff membrane 1e-6
constexpr double answer_seconds = 120;

/// s; 0: a method's own.
std::vector<double> steps_of(Method method, int steps) {
    if (method != Method::xpbd) return {0};
    std::vector<double> all{2e-3, 1e-3, 5e-4};
    all.resize(std::min<std::size_t>(steps, all.size()));
    return all;
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

struct Timed {
    SceneRest rest;
    double cpu = 0, wall = 0; // s
};

Timed timed(const SceneCloth& cloth, const SceneRestOptions& options) {
    const double cpu = processor_seconds();
    const auto wall = std::chrono::steady_clock::now();
    Timed t{rest_of(cloth, options)};
    t.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count();
    t.cpu = processor_seconds() - cpu;
    return t;
}

/// The number that this scene at rest goes to when it is brought nearer to rest, by Newton's steps, as far as rounding lets it.
double exact_value(const Scene& scene, const SceneCloth& cloth, const Points& x, Method method, double max_seconds) {
    SceneRestOptions options{newton_twin(method)};
    options.tolerance = exact;
    options.max_iterations = exact_iterations;
    options.max_seconds = max_seconds;
    SceneCloth near = cloth;
    near.x = x;
    return scene.measure(cloth, rest_of(near, options).x);
}

std::optional<double> equilibrium_value(const Scene& scene, double edge) {
    const SceneCloth cloth = scene.make(edge);
    SceneRestOptions options;
    options.max_seconds = answer_seconds;
    const SceneRest rest = rest_of(cloth, options);
    if (!rest.failure.empty()) return {};
    return exact_value(scene, cloth, rest.x, options.method, answer_seconds);
}

ChartScene answered(const Scene& scene, int meshes) {
    if (scene.answer) return {scene, *scene.answer, scene.answer_from};
    if (scene.band) return {scene, (scene.band->low + scene.band->high) / 2, scene.answer_from};
    const double edge = scene.edges[std::min<std::size_t>(meshes, scene.edges.size()) - 1];
    const std::optional<double> a = equilibrium_value(scene, edge), b = equilibrium_value(scene, edge / 2);
    if (!a || !b) throw std::runtime_error("the scene '" + scene.name + "' has no answer: equilibrium does not come to rest on it");
    ChartScene answered{scene, *b + (*b - *a) / 3, text("equilibria at %.3g and %.3g mm", 1000 * edge, 500 * edge)};
    answered.scene.scale = std::abs(answered.answer);
    return answered;
}

/// How far a number is off the answer, or out of the band.
double off(const ChartScene& s, double value) {
    if (!s.scene.band) return std::abs(value - s.answer);
    return std::isfinite(value) ? std::max({0.0, s.scene.band->low - value, value - s.scene.band->high}) : value;
}

/// Returns whether it came to an end in time.
bool run(const ChartScene& s, const SceneCloth& cloth, const ChartOptions& options, ChartPoint& p) {
    SceneRestOptions how{p.method, p.step};
    how.max_seconds = options.max_seconds;
    const int all = threads();
    std::vector<double> cpu, wall;
    Points x;
    bool in_time = true;
    double spent = 0;
    for (int k = 0; k < options.repeats && p.failure.empty() && spent < options.max_seconds; ++k) {
        set_threads(1);
        const Timed one = timed(cloth, how);
        set_threads(all);
        x = one.rest.x;
        in_time = !one.rest.out_of_time;
        p.failure = one.rest.failure;
        cpu.push_back(one.cpu);
        spent += one.cpu;
        wall.push_back(p.failure.empty() ? timed(cloth, how).wall : one.wall);
    }
    p.value = s.scene.measure(cloth, x);
    p.seconds_cpu = median(cpu);
    p.seconds_wall = median(wall);
    p.error = off(s, p.value) / s.scene.scale;
    if (!std::isfinite(p.error) && p.failure.empty()) p.failure = "not finite";
    if (p.failure.empty()) p.error_solver = std::abs(p.value - exact_value(s.scene, cloth, x, p.method, options.max_seconds)) / s.scene.scale;
    return in_time;
}

void mark_front(std::vector<ChartPoint>& points, std::size_t first) {
    for (std::size_t i = first; i < points.size(); ++i) {
        ChartPoint& p = points[i];
        p.front = p.failure.empty();
        for (std::size_t j = first; j < points.size() && p.front; ++j) {
            const ChartPoint& q = points[j];
            p.front = !q.failure.empty() || q.error > p.error || q.seconds_cpu > p.seconds_cpu ||
                      (q.error == p.error && q.seconds_cpu == p.seconds_cpu);
        }
    }
}

} // namespace

Chart make_chart(const ChartOptions& options) {
    Chart chart;
    for (const Scene& scene : options.scenes) {
        const std::size_t first = chart.points.size();
        chart.scenes.push_back(answered(scene, options.meshes));
        const ChartScene& s = chart.scenes.back();
        const int meshes = std::min(options.meshes, int(scene.edges.size()));
        std::vector<SceneCloth> cloths;
        for (int m = 0; m < meshes; ++m) cloths.push_back(scene.make(scene.edges[m]));
        for (const Method method : options.methods)
            for (const double step : steps_of(method, options.steps))
                for (int m = 0; m < meshes; ++m) {
                    if (options.progress)
                        options.progress(text("%s, %s, %.3g mm", scene.name.c_str(), to_string(method), 1e3 * scene.edges[m]));
                    ChartPoint& p = chart.points.emplace_back();
                    p.scene = scene.name;
                    p.method = method;
                    p.edge_length = scene.edges[m];
                    p.step = step;
                    if (!run(s, cloths[m], options, p)) break; // a finer mesh takes longer
                }
        mark_front(chart.points, first);
    }
    return chart;
}

const ChartPoint* fastest_within(const Chart& chart, const std::string& scene, double error) {
    const ChartPoint* best = nullptr;
    for (const ChartPoint& p : chart.points)
        if (p.scene == scene && p.failure.empty() && p.error <= error && (!best || p.seconds_cpu < best->seconds_cpu)) best = &p;
    return best;
}

std::optional<double> order_of(const Chart& chart, const std::string& scene, Method method) {
    std::vector<const ChartPoint*> found; // with the last step, coarse to fine
    for (const ChartPoint& p : chart.points)
        if (p.scene == scene && p.method == method) {
            if (!found.empty() && p.edge_length > found.back()->edge_length) found.clear();
            found.push_back(&p);
        }
    if (found.size() < 2) return {};
    const ChartPoint &a = *found[found.size() - 2], &b = *found.back();
    if (!a.failure.empty() || !b.failure.empty()) return {};
    return std::log(a.error / b.error) / std::log(a.edge_length / b.edge_length);
}

} // namespace toile

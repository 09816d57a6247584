// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Error against time, over scenes, methods, mesh sizes and step sizes.

#include "draping/chart/scene.h"
#include "draping/method.h"

#include <array>

namespace toile {

/// Errors that the chart has lines at, and names the fastest within.
inline constexpr std::array marked_errors{0.05, 0.01};

struct ChartOptions {
    std::vector<Scene> scenes;
    std::vector<Method> methods;
    int meshes = 4;          ///< of each scene, from the coarsest on
    int steps = 3;           ///< of methods whose accuracy at rest depends on them, from the longest on
    int repeats = 5;         ///< times are medians of as many runs, or of fewer that together take max_seconds
    double max_seconds = 20; ///< of processor time, of one run; what takes longer has failed, is run once, and on no finer mesh
    std::function<void(const std::string& what)> progress; ///< called before every run
};

struct ChartPoint {
    std::string scene;
    Method method = Method::equilibrium;
    double edge_length = 0; ///< m
    double step = 0;        ///< s; 0: the method has none, or its own
    double value = 0;       ///< what the scene measures
    double error = 0;       ///< share of the scene's scale by which it is off the answer, or out of the band
    std::optional<double> error_solver; ///< share by which it is off what it goes to as far as rounding lets it; none: it has failed
    double seconds_cpu = 0;  ///< on one thread, s
    double seconds_wall = 0; ///< on all threads, s
    std::string failure;     ///< empty: at rest
    bool front = false;      ///< of the points at rest of its scene none is faster and no farther off, or nearer and no slower
};

struct ChartScene {
    Scene scene;
    double answer = 0;       ///< of a band the middle
    std::string answer_from; ///< that of the scene, or which meshes
};

struct Chart {
    std::vector<ChartScene> scenes;
    std::vector<ChartPoint> points; ///< by scene, method, step, and edge length from the longest on
};

/// Runs them all. Times depend on the machine, all else does not.
Chart make_chart(const ChartOptions& options);

/// The point at rest of the scene that takes the least processor time at no more than this error (share); null: none.
const ChartPoint* fastest_within(const Chart& chart, const std::string& scene, double error);

/// The order of convergence of a method: the slope of log error over log edge length between its two finest meshes with the finest step; none where it
/// failed or there are fewer.
std::optional<double> order_of(const Chart& chart, const std::string& scene, Method method);

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Cloth whose shape at rest is known: what a method, a mesh and a step are charted by. Each scene is small, has one number as its answer,
// and can be meshed at any edge length. docs/chart.md has the formulas.

#include "draping/energy/loads.h"
#include "draping/fabric/fabric.h"
#include "sewing/garment.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace toile {

struct SceneRestOptions;
struct SceneRest;

/// A scene at one mesh size, about to be let go.
struct SceneCloth {
    Garment garment;
    std::vector<Fabric> fabrics; ///< one per panel
    Points x;                    ///< where it starts, m
    std::vector<int> held;       ///< nodes that stay there
    Loads loads;
    TriMesh body;                ///< what it lies on; if it touches that at the start, it is at rest there but for the loads
    double friction = 0;         ///< on the body
    /// How it comes to rest from x, if not as rest_of() has it: a garment has a drape of its own.
    std::function<SceneRest(const Points& x, const SceneRestOptions& options)> rest;
};

/// Cloth of 0.15 kg/m2 alike in all directions, without a Poisson effect, of so much N/m and N m; shear is half the former.
Fabric plain_cloth(double stretch, double bend);

/// What measurements of the real thing come out between.
struct Band {
    double low = 0, high = 0;
};

struct Scene {
    std::string name;     ///< "cantilever, aligned, 1e4"
    std::string quantity; ///< what the number is: "drop over reach of the tip"
    /// The number that theory gives; none, and no band: what the equilibria of the two finest meshes tend to, by Richardson with order 2.
    std::optional<double> answer;
    std::string answer_from = "theory"; ///< of the answer or the band
    std::optional<Band> band; ///< instead of an answer: all in it is as near as can be told
    double scale = 1; ///< errors are shares of this
    std::vector<double> edges; ///< m, of the meshes to chart, each half of the one before
    std::function<SceneCloth(double edge)> make;
    std::function<double(const SceneCloth& cloth, const Points& x)> measure;
};

/// All of them, in the order in which they are charted; docs/chart.md says what they are.
std::vector<Scene> chart_scenes();

} // namespace toile

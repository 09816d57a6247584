// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What the scenes of stability are made of.

#include "draping/chart/scene.h"
#include "draping/solve/node_problem.h"
#include "draping/stability/boundary.h"
#include "draping/stability/scene.h"

namespace toile {

inline constexpr double strip_length = 0.1; // m
inline constexpr int strip_rows = 12;       // of edges along it, three across

/// Of a corner of squares halved alike, over that of the other nodes of the border, where two triangles have it: the heaviest end of a chain of edges.
inline constexpr double strip_end_mass = 2.0 / 3;

/// A strip of x in [0, strip_length], flat in the plane of x and z at rest, its warp along x, whose plate has 1e-5 N m and whose stretch is
/// `stiffness` times that over its length squared. The end at x = 0 is held.
SceneCloth stability_strip(const StabilityMesh& mesh, double stiffness);

/// The same with its mirror image on the other side of the held line, which the cloth then leaves exactly straight: two clamped arms.
SceneCloth stability_arms(const StabilityMesh& mesh, double stiffness);

/// Holds the end at x = strip_length too.
void hold_far_end(SceneCloth& cloth);

std::vector<char> held_nodes(const SceneCloth& cloth); ///< 1 each

/// m, of every node to either side and coordinate, at most `size`; the same in every run.
void shake(Points& x, double size);

/// Lowest eigenvalue of M^-1 K (1/s2) over the nodes that are not pinned, K exact, by a dense solver: for some hundred nodes.
/// 0 where it is not told from that by rounding.
double lowest_eigenvalue(NodeProblem& problem, const Points& x);

// One of each kind of scene.
StabilityScene swing_scene(Method method);      ///< a wave of stretch, of methods that move
StabilityScene plucked_scene(Method method);    ///< a clamped strip that bends, of methods that keep lengths
StabilityScene compressed_scene(Method method); ///< implicit steps with the exact second derivative
StabilityScene drawn_scene();                   ///< projective
StabilityScene dropped_scene();                 ///< xpbd
StabilityScene overstretched_scene(ChainOrder order); ///< springs-limited
StabilityScene close_scene();                   ///< equilibrium, whose contact is the barrier

} // namespace toile

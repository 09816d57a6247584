// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What the scenes of the chart are made of.

#include "draping/chart/scene.h"
#include "sewing/sheet_mesh.h"

namespace toile {

inline constexpr double scene_gravity = 9.81; // m/s2
inline constexpr double scene_density = 0.15; // kg/m2

/// Edge lengths, `times` of them from `edge` on.
std::vector<double> halved(double edge, int times);

/// The mesh as cloth with weight, whose nodes have no place yet.
SceneCloth sheet(const SheetMesh& mesh, const Fabric& fabric);

/// Adds a force (N) on a node that is at x, which stays what it is as long as the node moves less than a decimetre along any axis.
void add_dead_load(Loads& loads, int node, const Vec3& x, const Vec3& force);

Scene cantilever(MeshKind kind, const char* mesh_name, double membrane);
Scene strip_on_edge();
Scene catenary();
Scene cone();
Scene hung_square();
Scene picture_frame();
Scene capstan();
Scene cusick_disc();

} // namespace toile

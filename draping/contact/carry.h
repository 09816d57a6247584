// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// How a body that moves takes the cloth on it along.

#include "draping/contact/friction.h"
#include "geometry/edges.h"
#include "geometry/tri_mesh.h"

namespace toile {

/// The place on a body next to a node.
struct Anchor {
    int triangle = 0;
    Vec3 corner = Vec3::Zero(); ///< barycentric coordinates
    double distance = 0;        ///< m
};

/// Of every point; the body has at least one triangle.
std::vector<Anchor> find_anchors(const Points& x, const TriMesh& body);

/// How far each node goes, 3 per node, when the points of the body go by `motion`: on the body as its anchor does, off
/// it the more like the cloth round it, over `edges`, the farther it is. Where the anchors of neighbours go different
/// ways (one on the arm and one on the chest) the cloth between them is spread. Nodes that are `pinned` stay.
Eigen::VectorXd carried(const std::vector<Anchor>& anchors, const TriMesh& body, const Points& motion,
                        const EdgeTable& edges, const std::vector<char>& pinned);

/// The places at which friction on the body holds nodes, and the normals there, turned and moved along with the body's triangle
/// beside each from `body` to `moved`.
void carry_places(Friction& friction, const std::vector<Anchor>& anchors, const TriMesh& body, const Points& moved);

} // namespace toile

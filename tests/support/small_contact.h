// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The smallest scene of contact: two triangles of cloth and a body with a flat top.

#include "draping/contact/contact.h"

namespace toile::test {

/// Two triangles of cloth.
inline ContactCloth two_sheets() {
    ContactCloth c;
    c.triangles = {{0, 1, 2}, {3, 4, 5}};
    c.edges = {{0, 1}, {0, 2}, {1, 2}, {3, 4}, {3, 5}, {4, 5}};
    c.node_area.assign(6, 1e-4);
    c.edge_length.assign(6, 0.02);
    c.edge_area.assign(6, 1e-4);
    c.node_reach.assign(6, 0.01);
    c.group = {0, 1, 2, 3, 4, 5};
    return c;
}

/// Its upper face lies in y = 0.
inline TriMesh tetrahedron() {
    TriMesh m;
    m.points = {{-0.05, 0, -0.05}, {0.06, 0, -0.04}, {0.0, 0, 0.07}, {0, -0.1, 0}};
    m.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    return m;
}

} // namespace toile::test

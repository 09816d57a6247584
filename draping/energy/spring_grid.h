// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The springs of the literature: a square grid with springs along its lines, across its cells and over two of its
// edges (Provot 1995).

#include "draping/energy/springs.h"
#include "draping/fabric/fabric.h"

namespace toile {

/// Node i + columns j lies at (i, j) times the spacing, (weft, warp).
struct SpringGrid {
    int columns = 2, rows = 2; ///< of nodes
    double spacing = 0.02;     ///< m
};

enum class Diagonals { both, one }; ///< of a cell; one: from node (i, j) to (i + 1, j + 1)

/// Of springs inside the cloth; those along its borders have half.
struct GridStiffness {
    double warp = 0, weft = 0, shear = 0;  ///< N/m
    double bend_warp = 0, bend_weft = 0;   ///< N m, of the cloth; 0: no springs over two edges
};

/// With which strips along warp and weft have the fabric's moduli, and a cell its shear stiffness. The Poisson ratio is
/// not the fabric's: with both diagonals it comes from the shear, with one it is 0. Throws std::invalid_argument where
/// springs would have to push.
GridStiffness grid_stiffness(const Fabric& fabric, Diagonals diagonals);

std::vector<Spring> grid_springs(const SpringGrid& grid, const GridStiffness& stiffness, Diagonals diagonals);

/// kg per node, of cloth of `density` kg/m2.
std::vector<double> grid_masses(const SpringGrid& grid, double density);

/// Flat, in the plane z = 0.
Points grid_points(const SpringGrid& grid);

} // namespace toile

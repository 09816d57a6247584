// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What a drape is asked to be.

#include "geometry/bvh.h"
#include "geometry/tri_mesh.h"
#include "sewing/garment.h"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <variant>

namespace toile {

/// Every node where it is told. Misses are distances, m.
struct ShapeGoal {
    Points target;             ///< by node
    std::vector<double> share; ///< weight of each node; they sum to 1
};

/// Cloth and a surface near each other, whatever its triangles: nodes by their nearest points of the surface, and the surface's corners by
/// theirs of the cloth, so that cloth that ends too early is missed too. Misses are distances, m.
struct SurfaceGoal {
    TriMesh target;
    Bvh tree;                    ///< of its triangles
    std::vector<double> share;   ///< weight of each node; they sum to 1/2
    std::vector<double> corners; ///< weight of each corner of the target; they sum to 1/2
};

/// Nodes of one height. Misses are heights over it, m.
struct LevelGoal {
    std::vector<int> nodes;
    std::vector<double> share;    ///< weight of each; they sum to 1
    std::optional<double> height; ///< m; none: their mean, whatever it is
};

/// What a tape measure reads round some panels at a height. The miss is the difference, m.
struct GirthGoal {
    double height = 0;       ///< m
    double girth = 0;        ///< m
    std::vector<int> panels; ///< whose cloth is measured
};

/// No more stretch than so much along the grain. Misses are strains beyond it.
struct StrainGoal {
    std::vector<int> triangles;
    bool warp = true;
    double most = 0; ///< strain
};

/// One goal. It is met when no miss of nodes, girths or strains is beyond the tolerance; a shape or a surface when
/// their root mean square is not.
struct FitGoal {
    std::string name;
    std::variant<ShapeGoal, SurfaceGoal, LevelGoal, GirthGoal, StrainGoal> what;
    double tolerance = 0; ///< in the unit of its misses, > 0
};

/// What counts for being met, in the unit of the misses; infinity for a girth where nothing is.
double miss(const FitGoal& goal, const Garment& garment, const Points& x);

/// Sum over the goals of the mean square of their misses over their tolerances. It is met by 1 for every goal or less.
double value(const std::vector<FitGoal>& goals, const Garment& garment, const Points& x);
/// Its derivative by the nodes, the rest shape staying.
void add_gradient(const std::vector<FitGoal>& goals, const Garment& garment, const Points& x, Eigen::VectorXd& g);

/// The goal of a shape in which every node weighs as its share of the cloth.
ShapeGoal shape_goal(const Garment& garment, Points target);
/// The goal of a surface in which nodes weigh as their share of the cloth, and corners as theirs of the target, which has some area.
SurfaceGoal surface_goal(const Garment& garment, TriMesh target);
/// The goal of a line of nodes in which each weighs as the length that it stands for.
LevelGoal level_goal(const Garment& garment, const std::vector<std::vector<int>>& lines, std::optional<double> height);

} // namespace toile

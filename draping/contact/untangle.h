// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Cloth that crosses itself, taken apart: every crossing contour is shortened until it is gone. Volino and
// Magnenat-Thalmann: Resolving Surface Collisions through Intersection Contour Minimization, 2006. It needs no
// history and no idea of inside and outside, and pulls a contour that ends at a border out over the border.

#include "draping/contact/contact.h"
#include "geometry/bvh.h"
#include "geometry/distance.h"
#include "geometry/edges.h"

#include <functional>

namespace toile {

/// The cloth and how coarse it is.
struct TangledCloth {
    std::vector<Triangle> triangles;        ///< over nodes
    const EdgeTable& edges;                 ///< of these triangles
    double edge_length = 0;                 ///< m, mean
    std::vector<std::array<int, 3>> sewn_to_edge = {}; ///< as in ContactCloth: what is sewn on touches there
};

/// An edge that passes through a triangle with which it shares no node.
struct ClothCrossing {
    int edge = 0, triangle = 0;
    Passage at;
};

/// Sorted by edge and triangle. In plain floating point: a look by exact predicates has the last word.
std::vector<ClothCrossing> find_crossings(const TangledCloth& cloth, const Points& x);

/// The same from round to round: looks only at what has moved since the last look. Keeps a reference to `cloth`.
class CrossingFinder {
public:
    explicit CrossingFinder(const TangledCloth& cloth);
    const std::vector<ClothCrossing>& look(const Points& x);

private:
    bool joined(int a, int b) const;
    std::vector<ClothCrossing> crossings_of(const std::vector<char>& moved, const Points& x);

    const TangledCloth& cloth_;
    std::vector<std::array<int, 2>> sewn_; ///< nodes that touch because they are sewn, sorted
    Bvh triangle_tree_, edge_tree_;
    Points looked_at_;
    std::vector<ClothCrossing> found_;
};

struct Untangled {
    int before = 0, after = 0; ///< crossings of edges and triangles
    int rounds = 0;
};

/// How far the cloth round a crossing is taken along.
struct UntangleOptions {
    double longest_step = 0.4; ///< of the edge length, in one round
    int spread = 8;            ///< rounds of averaging with the neighbours
    int max_rounds = 400;
    int patience = 400;        ///< rounds without fewer crossings than ever before after which it ends
    /// Pulls a part that has gone through a sheet back through it as a whole, where the contour cuts a part off that is
    /// no more than half the cloth: what is round like a sleeve has contours that shrink only with it. How parts are
    /// told is from Baraff, Witkin, Kass: Untangling Cloth, 2003.
    bool withdraw = false;
    std::function<bool()> go_on = {}; ///< asked every round; false ends it
};

/// Moves the nodes of `x` near crossings until there are none, or the options end it; then x is the state of fewest
/// crossings on the way.
Untangled untangle(const TangledCloth& cloth, Points& x, const UntangleOptions& options = {});

/// Untangles and moves what lies too near apart, by turns. Returns whether in the end nothing crosses and nothing is
/// nearer than the floor of `contact`; `most` is raised to the crossings that there were.
bool take_apart(const TangledCloth& cloth, Contact& contact, Points& x, const UntangleOptions& options, int& most);

/// The nodes (1 each) of what crosses, or of cloth that is too near to cloth for `contact`, whose nodes that were left
/// out are let in.
std::vector<char> tangle_of(const TangledCloth& cloth, Contact& contact, const Points& x);

} // namespace toile

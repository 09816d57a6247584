// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A start that contact can take: panels that lie in the body, in each other or too near to either are pushed
// clear.

#include "geometry/tri_mesh.h"
#include "sewing/garment.h"

#include <optional>

namespace toile {

struct PlaceOptions {
    double from_body = 5e-3;  ///< m, to be kept from the body
    double from_cloth = 2e-3; ///< m, to be kept from panels that have been placed
    double step = 2e-3;       ///< m, by which pushes are tried
    double farthest = 0.6;    ///< m, of a push
    std::vector<bool> fixed;  ///< per panel: must stay; empty: none
    std::vector<bool> outside; ///< per panel: comes last, outside of all threads between others; empty: none
};

struct PanelPush {
    int panel = 0;
    Vec3 push = Vec3::Zero(); ///< m
    bool from_body = false;   ///< the body was in the way, otherwise another panel was
};

struct PlacedClear {
    Points x;                      ///< nodes of the garment
    std::vector<PanelPush> pushed; ///< panels that were moved, in the order in which they were placed
    std::vector<int> left;         ///< panels for which no push was found: they stay where they were
};

/// Pushes panels clear one after another, those of lower layers and those nearest to the body first: each by
/// the smallest step along its own normal, to either side, or horizontally away from the body's middle, that
/// leaves it outside the body and at the distances that the options ask for. Panels that keep them where they
/// are stay. Those that are to lie outside come last and keep clear of the threads between the others as well.
/// Panels may touch where stitches of no length join them, as long as neither is moved against the other. `garment` is open (a node per vertex); a panel's contact with itself is not looked at.
PlacedClear place_clear(const Garment& garment, const Points& x, const TriMesh& body,
                        const PlaceOptions& options = {});

/// Of every seam, whether threads of it pass through the body.
std::vector<char> seams_through_body(const Garment& garment, const Points& x, const TriMesh& body);

/// How far, in metres, the garment as a whole should be moved up (or, negative, down), within 20 cm, that
/// fewer threads of its open seams pass through the body: shoulder seams that must close above the shoulder,
/// inner leg seams that must close below the crotch. 0 where moving frees less than two metres of seam per
/// metre. A thread that is free at first and goes into the body on the way counts as if it stayed there: beyond it the
/// seam would be on the wrong side, a shoulder below the arm.
double free_height(const Garment& garment, const Points& x, const TriMesh& body);

/// Which stitches have the body between their sides.
std::vector<char> stitches_through_body(const Garment& garment, const Points& x, const TriMesh& body);

/// By how little the garment as a whole is to be moved up or down, within 20 cm, for the body to be between the sides of none of
/// these stitches (1 each), m, without moving what other seams join through the body; nothing when there is no such height.
std::optional<double> height_free_for(const Garment& garment, const Points& x, const TriMesh& body, const std::vector<char>& stitches);

} // namespace toile

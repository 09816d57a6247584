// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Where the labelled edges of a garment came to lie on the body, and how far that is from where they belong.

#include "draping/staging.h"
#include "geometry/tri_mesh.h"

#include <map>
#include <optional>
#include <string>

namespace toile {

/// What the place of an edge is measured against.
enum class Belongs {
    file_height, ///< the mean height the file gives it: an open edge that carries its garment
    neck,        ///< the neck and the shoulders of the body: an edge whose label contains "collar"
    carried,     ///< nothing: a seam that hangs where the cloth above it lets it
    anywhere     ///< nothing: any other label
};

/// The words of the report: "file height", "neck", "carried", "anywhere".
const char* to_string(Belongs belongs);

struct Landmark {
    std::string label;
    double placed = 0;  ///< m, mean height where the pattern's file puts the edges
    double settled = 0; ///< m, at the end
    Belongs belongs = Belongs::anywhere;
    std::optional<double> off = {}; ///< m, from where the edges belong; nothing where that is not judged
};

/// A neck point of a garment, the top of its neckline on one side of a panel, where the shoulder seam meets
/// it.
struct NeckPoint {
    std::string label;
    int node = 0; ///< of the sewn garment
    Vec3 place;   ///< on the shoulder
};

/// A neckline against the body. A neck point belongs on the ridge of the shoulder, the highest line of the
/// body beside the neck, as far from the neck's axis as the flat pattern puts it: half the width of the
/// neckline. The axis is upright, through the middle of the neck where it is thinnest.
struct Neckline {
    bool found = false;       ///< there are edges labelled as a collar's, and a body with a neck
    Vec2 axis = Vec2::Zero(); ///< x and z
    bool round_neck = false;  ///< the axis is inside the hull of the neckline seen from above
    std::vector<NeckPoint> points;
    std::map<std::string, double> from_body; ///< m, mean distance of the edges' nodes from the body, by label
};

/// The ridge of the shoulder, or the side of the neck, at this x: the middle of the uppermost 3 mm of what
/// the body's section there has below `height`. Nothing where there is no body.
std::optional<Vec3> shoulder_ridge(const TriMesh& body, double x, double height);

/// `x` is over nodes of `sewn`, whose vertices are those of `staged`.
Neckline find_neckline(const StagedLevel& staged, const Garment& sewn, const Points& x, const TriMesh& body);

/// Of every labelled edge, by label. Off, at the neck: the farthest neck point from its place, or the mean
/// distance from the body where that is more.
std::vector<Landmark> find_landmarks(const StagedLevel& staged, const Garment& sewn, const Points& x,
                                     const Neckline& neckline);

/// A sentence for every landmark that is off by more than 3 cm, and for a neckline that does not go round the
/// neck.
std::vector<std::string> misplaced(const std::vector<Landmark>& landmarks, const Neckline& neckline);

} // namespace toile

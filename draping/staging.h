// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What a drape starts from, whatever it was read from: the open garment at every level, where it starts out,
// and what is sewn on or held.

#include "draping/energy/elastic.h"
#include "sewing/garment.h"

namespace toile {

struct StagedLevel {
    double edge_length = 0; ///< m, of the mesh
    Garment garment;        ///< seams open
    Points placed;          ///< its nodes where they start out
};

struct Staging {
    std::vector<StagedLevel> levels;                      ///< coarse to fine, at least one
    std::vector<std::vector<Interpolation>> prolongation; ///< as in FlatPattern, over vertices
    std::vector<std::string> seam_names;                  ///< by Stitch::seam
    std::vector<Pin> pins;
    std::vector<Elastic> elastics;
};

/// A pattern's levels, seams open, where its file puts them. Triangles at an elastic count as eased: their
/// cloth is gathered.
Staging stage(const Pattern& pattern, const FlatPattern& flat);

/// One level that is meshed and placed already. Spans go along its border lines.
Staging stage(Garment garment, Points placed, std::vector<Pin> pins, std::vector<Elastic> elastics);

/// The same from the next finer level on. At least two levels.
Staging without_coarsest(const Staging& staging);

/// Where pinned nodes of a garment of level `level` are held, by node, ascending. `garment` may have its seams
/// closed: a node of several pinned vertices is held at their mean.
std::vector<std::pair<int, Vec3>> pinned_places(const Staging& staging, int level, const Garment& garment);

/// The bands of a garment of any level, segment by segment.
std::vector<ElasticSegment> elastic_segments(const std::vector<Elastic>& elastics, const Garment& garment);

} // namespace toile

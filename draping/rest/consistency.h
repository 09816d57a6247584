// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// How far what a surface is told is from fitting together.

#include "draping/rest/prescribed.h"

namespace toile {

/// Round an inner point, turning by the corner of each triangle and tilting by the angle of each hinge comes back to where it
/// began on any surface: the composition of these rotations is the identity (a discrete Gauss and Codazzi). Returns by how
/// much it is not, as an angle (rad), per point; 0 at border points and where edges have more than two triangles. Throws
/// std::invalid_argument for lengths that no triangle has.
std::vector<double> misfit(const Prescribed& data);

/// 2 pi less the sum of the corners round an inner point, by the prescribed lengths, rad; 0 as above. What flat cloth would
/// have to lose there.
std::vector<double> angle_defects(const Prescribed& data);

/// How many data there are, and how many of them a surface near `x` can follow independently.
struct DataCount {
    int lengths = 0, angles = 0; ///< data
    int inner_points = 0;
    int freedom = 0;             ///< 3 per point less rigid motions
    int rank = -1;               ///< of the derivatives of the data at x; -1: not counted, for more points than `most_ranked`
};
inline constexpr int most_ranked = 5000;
DataCount count_data(const Prescribed& data, const Points& x);

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/tri_mesh.h"

namespace toile {

/// Measurements of the built-in dress form, metres.
struct FormMeasures {
    double height = 1.68; ///< 1.2 .. 2.1
    double bust = 0.90;   ///< 0.6 .. 1.5
    double waist = 0.72;  ///< 0.5 .. 1.5
    double hip = 0.96;    ///< 0.6 .. 1.6
};

/// A closed smooth body with arms and legs in A pose, from its measurements: y up, +z front, feet at y = 0,
/// 10 to 30 thousand points. Its girths at bust, waist and hip (form_levels) are the ones asked for, within 0.5 %.
/// The same measures give the same bytes.
/// Throws std::invalid_argument with a sentence when a measure is out of range.
TriMesh make_form(const FormMeasures& measures);

/// Where the form has its girths, metres above the floor.
struct FormLevels {
    double bust_y = 0, waist_y = 0, hip_y = 0;
};
FormLevels form_levels(const FormMeasures& measures);

} // namespace toile

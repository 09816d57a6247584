// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "draping/stability/map.h"

#include <string>

namespace toile {

/// method,scene,mesh,seed,stiffness,axis,value,boundary,measure,status: one row per run; a seed of 0 is the mesh without jitter; a
/// boundary of inf is none; status is "works" or why not.
std::string stability_csv(const std::vector<StabilityMap>& maps);

/// All that the maps hold, by docs/stability.md.
std::string stability_json(const std::vector<StabilityMap>& maps, const std::string& version);

/// The maps as one page of HTML that needs nothing else: what each scene does, its picture, how often it failed and how that compares with theory.
std::string stability_page(const std::vector<StabilityMap>& maps, const std::string& version);

/// Runs within this factor of a boundary are not held against theory.
inline constexpr double theory_band = 1.3;

} // namespace toile

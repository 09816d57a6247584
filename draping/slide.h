// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Whether a garment has slid down from where it was put on. Internal to the stages of a drape.

#include "draping/drape_run.h"

#include <limits>
#include <optional>

namespace toile {

inline constexpr double slid = 0.10; ///< m below its place at which a held edge counts as slid off

struct Slide {
    DrapeStatus status = DrapeStatus::slid_off; ///< or too_small: it hangs above a girth that its edges do not pass
    std::string where = {};                     ///< a sentence
    double height = 0;                          ///< m, of the edges that slid farthest, or of the top
};

/// What has slid by `least` m or more: the edges that hooks held; of a garment without, its top and its middle, when the top
/// has passed the widest of what it was put on. Nothing where all is in its place.
std::optional<Slide> find_slide(const DrapeRun& run, double least = slid);

/// Tells when cloth that is to come to rest has slid so far that it will not come back, and slides on: it would
/// take hundreds of iterations to the floor. Finer levels are then given up where they start.
struct SlideWatch {
    DrapeRun& run;
    double height = std::numeric_limits<double>::infinity(); ///< m, when looked at last; infinite: in its place

    bool gives_up(int iteration);
};

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A dress of squares: what hangs from what, before anything is sewn.

#include "tests/support/sewn_squares.h"

#include <vector>

namespace toile::test {

enum DressSeam { bodice_left, bodice_right, front_waist, back_waist, skirt_left, skirt_right, front_hem, back_hem, flounce_left, flounce_right, seams };

/// Front and back of a bodice, of a skirt below it and of a flounce below that.
inline Cloth dress(bool labelled) {
    Cloth c;
    for (const double y : {0.2, 0.0, -0.2}) {
        add_front(c, {0, y, 0.1});
        add_back(c, {0, y, -0.1});
    }
    const auto sew_next = [&](std::vector<DressSeam> in_turn, auto&& sew) {
        const std::size_t before = c.garment.stitches.size();
        sew();
        for (std::size_t k = before; k < c.garment.stitches.size(); ++k)
            c.garment.stitches[k].seam = in_turn[(k - before) % in_turn.size()];
    };
    sew_next({bodice_left, bodice_right}, [&] { sew_sides(c, 0, 1); });
    sew_next({front_waist}, [&] { sew_below(c, 0, 2); });
    sew_next({back_waist}, [&] { sew_below(c, 1, 3); });
    sew_next({skirt_left, skirt_right}, [&] { sew_sides(c, 2, 3); });
    sew_next({front_hem}, [&] { sew_below(c, 2, 4); });
    sew_next({back_hem}, [&] { sew_below(c, 3, 5); });
    sew_next({flounce_left, flounce_right}, [&] { sew_sides(c, 4, 5); });
    if (labelled) c.garment.borders.push_back({"left_collar", 0, 0, {0, 1}, {0, 1}});
    return c;
}

} // namespace toile::test

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Patterns drawn by hand for tests: polygons by their corners, edges by number.

#include "patterns/pattern.h"

#include <string>

namespace toile::test {

inline Loop polygon_loop(const std::vector<Vec2>& corners) {
    Loop loop;
    for (std::size_t k = 0; k < corners.size(); ++k)
        loop.push_back({corners[k], corners[(k + 1) % corners.size()], Straight{}, ""});
    return loop;
}

inline Panel polygon(const std::string& name, const std::vector<Vec2>& corners) {
    Panel panel;
    panel.name = name;
    panel.outline = polygon_loop(corners);
    return panel;
}

/// Counter-clockwise from the origin: edge 0 below, 1 right, 2 above, 3 left.
inline Panel rectangle(const std::string& name, double width, double height) {
    return polygon(name, {{0, 0}, {width, 0}, {width, height}, {0, height}});
}

inline EdgeSpan whole(int panel, int edge) {
    return {panel, edge, 0, 1};
}
inline EdgeSpan backward(int panel, int edge) {
    return {panel, edge, 1, 0};
}

inline Seam seam(const std::string& name, SeamSide a, SeamSide b) {
    return {std::move(a), std::move(b), SeamFaces::right_to_right, name};
}

/// A tube: front and back sewn at both sides.
inline Pattern tube(double width, double height) {
    Pattern pattern;
    pattern.name = "tube";
    pattern.panels = {rectangle("front", width, height), rectangle("back", width, height)};
    pattern.seams = {seam("left", {backward(0, 3)}, {whole(1, 1)}),
                     seam("right", {whole(0, 1)}, {backward(1, 3)})};
    return pattern;
}

} // namespace toile::test

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Patterns of full skirts that their files lay flat before and behind the body.

#include <nlohmann/json.hpp>

#include <cmath>

namespace toile::test {

/// Three quarters of a ring, open at the top, whose inner edge (3) is `girth` cm long; edges 0 and 2 are its straight ends.
inline nlohmann::json three_quarter_ring(double girth, double width) {
    const double r = girth / (1.5 * 3.14159265358979323846), s = r / std::sqrt(2), t = (r + width) / std::sqrt(2);
    const auto arc = [](double radius, int right) { return nlohmann::json{{"type", "circle"}, {"params", {radius, 1, right}}}; };
    return {{"vertices", {{-s, s}, {-t, t}, {t, t}, {s, s}}},
            {"edges",
             {{{"endpoints", {0, 1}}},
              {{"endpoints", {1, 2}}, {"curvature", arc(r + width, 1)}},
              {{"endpoints", {2, 3}}},
              {{"endpoints", {3, 0}}, {"curvature", arc(r, 0)}}}}};
}

inline nlohmann::json band(double length, double height) {
    return {{"vertices", {{-length / 2, 0}, {length / 2, 0}, {length / 2, height}, {-length / 2, height}}},
            {"edges",
             {{{"endpoints", {0, 1}}}, {{"endpoints", {1, 2}}}, {{"endpoints", {2, 3}}}, {{"endpoints", {3, 0}}}}}};
}

inline nlohmann::json seam(const char* a, int edge_a, const char* b, int edge_b) {
    const auto end = [](const char* panel, int edge) { return nlohmann::json{{"panel", panel}, {"edge", edge}}; };
    return nlohmann::json::array({end(a, edge_a), end(b, edge_b)});
}

inline nlohmann::json at(nlohmann::json panel, double y, double z) {
    panel["translation"] = {0, y, z};
    panel["rotation"] = {0, 0, 0};
    return panel;
}

/// The panel with its left on the right, as a back is beside its front.
inline nlohmann::json mirrored(nlohmann::json panel) {
    for (nlohmann::json& v : panel["vertices"]) v[0] = -v[0].get<double>();
    for (nlohmann::json& e : panel["edges"])
        if (e.contains("curvature")) e["curvature"]["params"][2] = 1 - e["curvature"]["params"][2].get<int>();
    return panel;
}

/// Front and back of a full skirt on a waistband, both flat, so that the arms lie between the sides that belong together.
inline nlohmann::json full_skirt() {
    const nlohmann::json ring = three_quarter_ring(36.5, 45);
    nlohmann::json waist = band(36.5, 4);
    waist["edges"][2]["label"] = "lower_interface";
    return {{"pattern",
             {{"panels",
               {{"skirt_front", at(ring, 91, 25)},
                {"skirt_back", at(mirrored(ring), 91, -25)},
                {"band_front", at(waist, 100, 20)},
                {"band_back", at(mirrored(waist), 100, -20)}}},
              {"stitches",
               {seam("band_front", 1, "band_back", 3), seam("band_front", 3, "band_back", 1),
                seam("band_front", 0, "skirt_front", 3), seam("band_back", 0, "skirt_back", 3),
                seam("skirt_front", 0, "skirt_back", 2), seam("skirt_front", 2, "skirt_back", 0)}}}},
            {"properties",
             {{"units_in_meter", 100}, {"curvature_coords", "relative"}, {"normalized_edge_loops", true}}}};
}

/// A full skirt with a gathered flounce, whose own sides would close round the arms while the skirt's wait.
inline nlohmann::json flounced_skirt() {
    nlohmann::json skirt = full_skirt();
    auto& panels = skirt["pattern"]["panels"];
    auto& stitches = skirt["pattern"]["stitches"];
    const nlohmann::json flounce = band(260, 4); // light, or the jersey of the waistband gives by more than it may
    panels["flounce_front"] = at(flounce, 40, 25);
    panels["flounce_back"] = at(mirrored(flounce), 40, -25);
    stitches.push_back(seam("skirt_front", 1, "flounce_front", 2));
    stitches.push_back(seam("skirt_back", 1, "flounce_back", 2));
    stitches.push_back(seam("flounce_front", 1, "flounce_back", 3));
    stitches.push_back(seam("flounce_front", 3, "flounce_back", 1));
    return skirt;
}

} // namespace toile::test

// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/slide.h"

#include "draping/hooks.h"
#include "draping/settle_level.h"
#include "geometry/text.h"
#include "sewing/avatar.h"

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

constexpr int look_every = 20;   // iterations,
constexpr double sinking = 1e-3; // m, by which it sinks meanwhile
constexpr double for_good = 2;   // times `slid`

/// The largest strain that a fabric of the garment allows; a limit of 0 is none.
double most_stretch(const DrapeRun& run) {
    double most = 0;
    for (const Fabric& f : run.fabrics)
        for (const double limit : {f.limit_warp, f.limit_weft})
            most = std::max(most, limit > 0 ? limit : std::numeric_limits<double>::infinity());
    return most;
}

/// What a tape measure reads at most round the torso between two heights.
double widest_girth(const TriMesh& body, double low, double high) {
    double widest = 0;
    for (double y = low; y <= high; y += 0.01) widest = std::max(widest, torso_girth(body, y));
    return widest;
}

Slide slide_of_edges(const DrapeRun& run, const std::string& label, double height) {
    const double place = run.carried_at.at(label);
    const double longest = (1 + most_stretch(run)) * label_length(run.garment, label);
    const double widest = widest_girth(run.avatar, height, place);
    Slide s;
    s.height = height;
    s.where = text("edges labelled \"%s\" slid %.0f cm down from their place at %.2f m", label.c_str(), 100 * (place - height), place);
    if (longest < widest - tight) {
        s.status = DrapeStatus::too_small;
        s.where += text(", over a girth of %.1f cm, which they do not pass: %.1f cm are missing", 100 * widest,
                        100 * (widest - longest));
    }
    return s;
}

/// A hood may fall, a skirt hang down and come to sit on the hips; what slid off has sunk with its top and on the whole, and is
/// where the body is slighter again.
std::optional<Slide> slide_without_labels(const DrapeRun& run, double least) {
    const Points& placed = run.staging.levels[0].placed;
    const double place = top_height(placed), top = top_height(run.x);
    if (place - top < least || mean_height(placed) - mean_height(run.x) < least) return std::nullopt;
    const double widest = widest_girth(run.avatar, top, place);
    if (torso_girth(run.avatar, top) > widest - tight) return std::nullopt;
    return Slide{DrapeStatus::slid_off,
                 text("the garment, which has no labelled edge to carry it, slid down: its top is %.0f cm below its place at %.2f m, "
                      "and has passed a girth of %.1f cm",
                      100 * (place - top), place, 100 * widest),
                 top};
}

} // namespace

std::optional<Slide> find_slide(const DrapeRun& run, double least) {
    if (nothing_carries(run)) return slide_without_labels(run, least);
    const std::map<std::string, double> now = label_heights(run.garment, run.x, all_hooked(run));
    const auto drop = [&](const auto& at) { return run.carried_at.at(at.first) - at.second; };
    const auto farthest = std::max_element(now.begin(), now.end(), [&](const auto& a, const auto& b) { return drop(a) < drop(b); });
    if (farthest == now.end() || drop(*farthest) < least) return std::nullopt;
    return slide_of_edges(run, farthest->first, farthest->second);
}

bool SlideWatch::gives_up(int iteration) {
    if (run.sliding || iteration % look_every) return run.sliding;
    const double last = height;
    const std::optional<Slide> s = find_slide(run, for_good * slid);
    height = s ? s->height : std::numeric_limits<double>::infinity();
    return run.sliding = s && s->status == DrapeStatus::slid_off && std::isfinite(last) && last - height > sinking;
}

} // namespace toile

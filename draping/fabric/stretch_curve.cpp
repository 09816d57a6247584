// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/fabric/stretch_curve.h"

#include "geometry/text.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace toile {

namespace {

constexpr std::size_t most_points = 1000;

std::string shown(const StretchPoint& p) { return text("(%.6g, %.6g)", p.stretch, p.tension); }

/// Slopes at the points: of the parabola through three, and at most twice the secants beside. Cubics are monotone up to three
/// times these, but could be all but flat somewhere; so they keep half the secant or the lesser slope of their ends.
std::vector<double> slopes(const std::vector<StretchPoint>& p) {
    const std::size_t n = p.size();
    std::vector<double> secant, slope(n);
    for (std::size_t k = 0; k + 1 < n; ++k)
        secant.push_back((p[k + 1].tension - p[k].tension) / (p[k + 1].stretch - p[k].stretch));
    slope.front() = secant.front();
    slope.back() = secant.back();
    for (std::size_t k = 1; k + 1 < n; ++k) {
        const double before = p[k].stretch - p[k - 1].stretch, after = p[k + 1].stretch - p[k].stretch;
        slope[k] = (after * secant[k - 1] + before * secant[k]) / (before + after);
    }
    for (std::size_t k = 0; k + 1 < n; ++k) {
        slope[k] = std::min(slope[k], 2 * secant[k]);
        slope[k + 1] = std::min(slope[k + 1], 2 * secant[k]);
    }
    return slope;
}

CurveState in_piece(const CurvePiece& p, double s) {
    return {p.energy + s * (p.tension + s * (p.slope / 2 + s * (p.bend / 3 + s * p.twist / 4))),
            p.tension + s * (p.slope + s * (p.bend + s * p.twist)), p.slope + s * (2 * p.bend + 3 * s * p.twist)};
}

StretchCurve through(const std::vector<StretchPoint>& p) {
    StretchCurve curve;
    if (p.empty()) return curve;
    const std::vector<double> slope = slopes(p);
    double energy = 0;
    for (std::size_t k = 0; k + 1 < p.size(); ++k) {
        const double h = p[k + 1].stretch - p[k].stretch, secant = (p[k + 1].tension - p[k].tension) / h;
        curve.pieces.push_back({p[k].stretch, energy, p[k].tension, slope[k], (3 * secant - 2 * slope[k] - slope[k + 1]) / h,
                                (slope[k] + slope[k + 1] - 2 * secant) / (h * h)});
        energy = in_piece(curve.pieces.back(), h).energy;
    }
    curve.pieces.push_back({p.back().stretch, energy, p.back().tension, slope.back(), 0, 0});
    return curve;
}

} // namespace

void check_points(const std::vector<StretchPoint>& points) {
    if (points.size() < 2 || points.size() > most_points)
        throw std::invalid_argument(text("a stretch curve has %zu points: expected 2 to %zu of stretch and tension (N/m)",
                                         points.size(), most_points));
    for (std::size_t k = 0; k < points.size(); ++k)
        if (!std::isfinite(points[k].stretch) || !std::isfinite(points[k].tension))
            throw std::invalid_argument(text("point %zu of a stretch curve is not finite: expected stretch and tension (N/m)", k));
    if (points[0] != StretchPoint{})
        throw std::invalid_argument("a stretch curve begins at " + shown(points[0]) + ": expected (0, 0)");
    for (std::size_t k = 1; k < points.size(); ++k)
        if (points[k].stretch <= points[k - 1].stretch || points[k].tension <= points[k - 1].tension)
            throw std::invalid_argument(text("point %zu of a stretch curve, ", k) + shown(points[k]) + ", follows " +
                                        shown(points[k - 1]) + ": expected both stretch and tension to rise");
}

StretchCurve stretch_curve(const std::vector<StretchPoint>& points) {
    if (!points.empty()) check_points(points);
    return through(points);
}

StretchCurve membrane_curve(const std::vector<StretchPoint>& points) {
    if (!points.empty()) check_points(points);
    std::vector<StretchPoint> green;
    for (const StretchPoint& p : points) {
        green.push_back({p.stretch * (1 + p.stretch / 2), p.tension / (1 + p.stretch)});
        if (green.size() > 1 && green.back().tension <= green[green.size() - 2].tension)
            throw std::invalid_argument("a stretch curve hardly rises up to " + shown(p) +
                                        ": expected tension / (1 + stretch) to rise from point to point");
    }
    return through(green);
}

CurveState evaluate(const StretchCurve& curve, double strain) {
    if (strain <= 0) {
        const double k = curve.first_slope();
        return {0.5 * k * strain * strain, k * strain, k};
    }
    const auto beyond = [](double s, const CurvePiece& piece) { return s < piece.from; };
    const CurvePiece& piece = *(std::upper_bound(curve.pieces.begin(), curve.pieces.end(), strain, beyond) - 1);
    return in_piece(piece, strain - piece.from);
}

CurveSecants secants(const StretchCurve& curve, double strain) {
    const CurvePiece& first = curve.pieces.front();
    if (strain <= 0) return {first.slope, first.slope, first.slope};
    const CurveState at = evaluate(curve, strain);
    if (strain >= curve.pieces[1].from) return {2 * at.energy / (strain * strain), at.tension / strain, at.slope};
    // Without the divisions, which a strain of next to nothing does not bear.
    return {first.slope + strain * (2 * first.bend / 3 + strain * first.twist / 2),
            first.slope + strain * (first.bend + strain * first.twist), at.slope};
}

double least_slope(const StretchCurve& curve) {
    double least = curve.pieces.back().slope;
    for (std::size_t k = 0; k + 1 < curve.pieces.size(); ++k) {
        const CurvePiece& p = curve.pieces[k];
        const double h = curve.pieces[k + 1].from - p.from;
        least = std::min(least, p.slope);
        const double lowest = p.twist > 0 ? -p.bend / (3 * p.twist) : -1;
        if (lowest > 0 && lowest < h) least = std::min(least, in_piece(p, lowest).slope);
    }
    return least;
}

} // namespace toile

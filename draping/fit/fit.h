// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Inverse draping: the amounts of alterations with which a drape meets goals, seams staying sewable.

#include "draping/fit/altered_drape.h"
#include "draping/fit/goal.h"
#include "draping/fit/optimise.h"

namespace toile {

struct FitOptions {
    std::optional<Optimiser> optimiser; ///< none: slsqp where seams have to stay equal, lbfgs otherwise
    int max_evaluations = 60;     ///< equilibria in all, >= 1
    /// Where a round begins: friction holds the cloth there, and every equilibrium of the round is looked for from there; for a shape that is
    /// told. None: where the last round ended, and from the nearest that is known.
    std::function<Points(const Eigen::VectorXd& amounts)> begin;
    int max_rounds = 10;          ///< of friction: it is frozen in each and brought up to date after it, >= 1
    int round_evaluations = 12;   ///< equilibria of one, >= 1; cobyla, which learns slowly, has all in the first
    double max_seconds = 1e9;     ///< wall time
    double equal_within = 1e-5;   ///< m, by which the sides of a seam may differ beyond their ease as drawn
    /// What an alteration costs: this times the square of what it moves the cloth by over the tolerance of the strictest goal.
    /// Of alterations that do the same, the least are found.
    double stay = 1e-4;
    /// Called after every equilibrium with its value; false stops.
    std::function<bool(int evaluations, double value)> progress;
};

enum class FitEnd { met, nearest, limit, stopped, unreachable };

/// The word of reports: "met", "nearest", "limit", "stopped", "unreachable".
const char* to_string(FitEnd end);

struct FitResult {
    FitEnd end = FitEnd::nearest;
    std::string why;         ///< a sentence; empty when met
    Optimiser optimiser = Optimiser::slsqp;
    Eigen::VectorXd amounts; ///< one for every alteration
    Points x;                ///< at rest with them
    std::vector<double> before, after; ///< the miss of every goal
    std::vector<std::string> at_bounds; ///< alterations whose amount is at a bound
    int seams = 0;           ///< that alterations could make unequal
    double unequal = 0;      ///< m, the largest difference of their sides, beyond their ease as drawn and as asked for
    int evaluations = 0, not_at_rest = 0, rounds = 0;
    double seconds = 0;
};

/// How far the sides of a seam of an altered pattern are from the ratio they have as drawn, m of side a.
double seam_difference(const Pattern& drawn, const Pattern& pattern, int seam);

/// Throws what fit() would throw whatever the drape, before there is one: std::invalid_argument for bounds, a start outside of
/// them, elastics and shrunk cloth that no pattern can have within them, seams that leave nothing to alter, an optimiser that cannot keep them.
void refuse_fit(const MovingFlat& moving, const Eigen::VectorXd& start, const FitOptions& options);

/// From `start`, amounts within their bounds, at rest at drape.state. Throws as refuse_fit(), and std::runtime_error when a goal
/// is not a number.
FitResult fit(AlteredDrape& drape, const std::vector<FitGoal>& goals, const Eigen::VectorXd& start, const Points& at_rest,
              const FitOptions& options = {});

} // namespace toile

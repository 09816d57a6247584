// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/fit/fit.h"

#include "draping/fit/adjoint.h"
#include "geometry/text.h"
#include "patterns/check.h"
#include "patterns/shrink.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace toile {

namespace {

using Eigen::VectorXd;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double length_step = 1e-6;  // of an amount, of the difference by which a seam's slope is found
constexpr double seam_unit = 1e-3;    // m, in which the optimiser is told of seams
constexpr double moved = 1e-6;        // m for an amount of 1: a seam that an alteration changes by less it does not change
constexpr double independent = 1e-6;  // of the largest slope: seams below follow from others
constexpr double at_rest = 1e-3;      // residual beyond which an equilibrium is none
constexpr double comfortable = 0.5;   // of its tolerance, with which a goal ends the search
constexpr double at_bound = 1e-3;     // of the room between bounds
constexpr double gain = 0.01;         // of the value, for which another round is begun, or another step made
constexpr double least_stay = 1e-6;
constexpr double rounding = 1e-9;     // of ratios and shares

/// Points of a panel about their mean, in the cloth at rest.
std::vector<Vec2> about_mean(const MovingFlat& moving, int panel) {
    const FlatLevel& level = moving.flat.levels.back();
    std::vector<Vec2> points;
    Vec2 mean = Vec2::Zero();
    for (std::size_t v = 0; v < level.points.size(); ++v) {
        if (level.panel_of_point[v] != panel) continue;
        points.push_back(to_rest(moving.drawn.panels[panel]) * level.points[v]);
        mean += points.back();
    }
    for (Vec2& p : points) p -= mean / double(points.size());
    return points;
}

/// Sum of the squares of what the points of an edge move by, toward the middle of a part of it that is gathered by so much.
double along_span(const MovingFlat& moving, const EdgeSpan& span, double by) {
    const auto [low, high] = std::minmax(span.t0, span.t1);
    double sum = 0;
    for (const double t : moving.flat.levels.back().border_at[span.panel][span.edge])
        if (t >= low && t <= high) sum += std::pow(by * ((t - low) / (high - low) - 0.5), 2);
    return sum;
}

/// Sum of the squares of what the points move by for a unit of what alters rest lengths: cloth shrinks about its middle, and
/// is gathered along an elastic or a seam toward the middle of that.
double gathering(const MovingFlat& moving, const Alteration& a) {
    double sum = 0;
    for (const ShrinkMove& m : a.shrinks)
        for (const Vec2& p : about_mean(moving, m.panel)) sum += m.share.cwiseProduct(p).squaredNorm();
    for (const ElasticMove& m : a.elastics) {
        const EdgeSpan& span = moving.drawn.elastics[m.elastic].span;
        sum += along_span(moving, span, m.ratio * length_at_rest(moving.drawn, span));
    }
    for (const EaseMove& m : a.eases)
        for (const EdgeSpan& span : moving.drawn.seams[m.seam].a) sum += along_span(moving, span, m.length);
    return sum;
}

/// What the amounts cost by themselves: for a unit of cost an alteration moves the cloth's points by a tolerance, in their
/// root mean square. One over the square of an amount.
VectorXd cost_of(const MovingFlat& moving, const VectorXd& at, double tolerance) {
    const int level = int(moving.flat.levels.size()) - 1;
    VectorXd cost(at.size());
    for (Eigen::Index k = 0; k < at.size(); ++k) {
        const auto points = [&](double by) {
            VectorXd near = at;
            near[k] += by;
            return moved_points(moving, altered(moving.drawn, moving.alterations, near), level);
        };
        const std::vector<Vec2> low = points(-length_step), high = points(length_step);
        double sum = 0;
        for (std::size_t v = 0; v < low.size(); ++v) sum += (high[v] - low[v]).squaredNorm();
        const double points_in_all = double(low.size());
        const double square = sum / points_in_all / (4 * length_step * length_step) + gathering(moving, moving.alterations[k]) / points_in_all;
        cost[k] = std::max(square, 1e-6) / (tolerance * tolerance);
    }
    return cost;
}

struct Seams {
    const MovingFlat& moving;

    /// Beyond the ease as drawn and what is asked to be eased.
    double difference(int seam, const VectorXd& amounts) const {
        double asked = 0;
        for (std::size_t k = 0; k < moving.alterations.size(); ++k)
            for (const EaseMove& m : moving.alterations[k].eases)
                if (m.seam == seam) asked += amounts[Eigen::Index(k)] * m.length;
        return seam_difference(moving.drawn, altered(moving.drawn, moving.alterations, amounts), seam) - asked;
    }
    VectorXd slope(int seam, const VectorXd& amounts) const {
        VectorXd g(amounts.size());
        for (Eigen::Index k = 0; k < g.size(); ++k) {
            VectorXd low = amounts, high = amounts;
            low[k] -= length_step;
            high[k] += length_step;
            g[k] = (difference(seam, high) - difference(seam, low)) / (2 * length_step);
        }
        return g;
    }
};

/// Seams that alterations can make unequal: their slopes where all are off their bounds a little, one row each.
std::vector<int> seams_at_stake(const MovingFlat& moving, const VectorXd& aside, Eigen::MatrixXd& slopes) {
    const Seams seams{moving};
    std::vector<int> found;
    std::vector<VectorXd> rows;
    for (int s = 0; s < int(moving.drawn.seams.size()); ++s) {
        const VectorXd slope = seams.slope(s, aside);
        if (!(slope.cwiseAbs().maxCoeff() > moved)) continue;
        found.push_back(s);
        rows.push_back(slope);
    }
    slopes.resize(Eigen::Index(rows.size()), aside.size());
    for (std::size_t r = 0; r < rows.size(); ++r) slopes.row(Eigen::Index(r)) = rows[r];
    return found;
}

/// Those of them from which the others follow, as the mirror image of a seam does from it where both sides are altered alike.
std::vector<int> independent_of(const std::vector<int>& seams, const Eigen::MatrixXd& slopes) {
    if (seams.empty()) return {};
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(slopes.transpose());
    qr.setThreshold(independent);
    std::vector<int> kept;
    for (Eigen::Index k = 0; k < qr.rank(); ++k) kept.push_back(seams[qr.colsPermutation().indices()[k]]);
    std::sort(kept.begin(), kept.end());
    return kept;
}

struct Search {
    AlteredDrape& drape;
    const std::vector<FitGoal>& goals;
    const FitOptions& options;
    std::chrono::steady_clock::time_point started;
    VectorXd cost; ///< of the square of an amount, before it is weighed by options.stay
    FitResult& result;

    struct Known {
        VectorXd amounts;
        Points x;
        double value;
    };
    std::vector<Known> known; ///< of this round, first where it began
    Points shape;             ///< from which it began, when that is told
    bool met = false, stopped = false;

    double cost_of(const VectorXd& amounts) const { return cost.dot(amounts.cwiseAbs2()); }

    double whole_value(const VectorXd& amounts, const Points& x) const {
        return value(goals, drape.garment_at(amounts), x) + options.stay * cost_of(amounts);
    }

    bool meets(const VectorXd& amounts, const Points& x, double share) const {
        const Garment garment = drape.garment_at(amounts);
        return std::all_of(goals.begin(), goals.end(),
                           [&](const FitGoal& g) { return miss(g, garment, x) <= share * g.tolerance; });
    }

    /// The equilibrium, from the nearest that is known, or from the shape: a fold that has popped would stay so.
    const Known* rest(const VectorXd& amounts) {
        const auto off = [&](const Known& k) { return cost_of(k.amounts - amounts); };
        const auto nearest =
            std::min_element(known.begin(), known.end(), [&](const Known& a, const Known& b) { return off(a) < off(b); });
        if (nearest->amounts == amounts) return &*nearest;
        Points x = options.begin ? shape : nearest->x;
        ++result.evaluations;
        try {
            if (!(drape.rest(amounts, x).residual <= at_rest)) return ++result.not_at_rest, nullptr;
        } catch (const std::invalid_argument&) { // folded over: farther than this is no pattern
            return ++result.not_at_rest, nullptr;
        }
        known.push_back({amounts, x, whole_value(amounts, x)});
        return &known.back();
    }

    double evaluate(const VectorXd& amounts, VectorXd* gradient) {
        const Known* at = rest(amounts);
        if (!at) return infinity;
        met = meets(amounts, at->x, comfortable);
        if (gradient && !met) {
            const Points x = at->x;
            if (!fit_gradient(drape, goals, amounts, x, *gradient)) return infinity;
            *gradient += 2 * options.stay * cost.cwiseProduct(amounts);
        }
        if (options.progress && !options.progress(result.evaluations, at->value)) stopped = true;
        return at->value;
    }

    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count(); }
    bool spent() const { return seconds() > options.max_seconds || result.evaluations >= options.max_evaluations; }
    bool over() const { return met || stopped || spent(); }
};

/// What bends downward, as a girth may, is left out; what no goal feels is not quite flat.
Eigen::MatrixXd curvature_of(Search& search, const VectorXd& start) {
    Eigen::MatrixXd found = Eigen::MatrixXd::Zero(start.size(), start.size());
    fit_curvature(search.drape, search.goals, start, search.known[0].x, found);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> bent(found);
    const VectorXd upward = bent.eigenvalues().cwiseMax(0);
    found = bent.eigenvectors() * upward.asDiagonal() * bent.eigenvectors().transpose();
    found.diagonal() += 2 * std::max(search.options.stay, least_stay) * search.cost;
    return found;
}

OptimiseProblem problem_of(Search& search, const std::vector<int>& seams, const VectorXd& start) {
    const MovingFlat& moving = search.drape.moving();
    OptimiseProblem p;
    p.start = p.low = p.high = start;
    for (Eigen::Index k = 0; k < start.size(); ++k) {
        p.low[k] = moving.alterations[k].low;
        p.high[k] = moving.alterations[k].high;
    }
    p.curvature = curvature_of(search, start);
    p.value = [&search](const VectorXd& amounts, VectorXd* g) { return search.evaluate(amounts, g); };
    p.stop = [&search] { return search.over(); };
    for (const int s : seams)
        p.equalities.push_back({moving.drawn.seams[s].name, [&moving, s](const VectorXd& amounts, VectorXd* g) {
                                    if (g) *g = Seams{moving}.slope(s, amounts) / seam_unit;
                                    return Seams{moving}.difference(s, amounts) / seam_unit;
                                }});
    return p;
}

/// What alterations within their bounds may make of a number, and which of them do.
struct Reach {
    double low, high;
    std::string names{};

    void add(const Alteration& a, double slope) {
        if (slope == 0) return;
        low += std::min(slope * a.low, slope * a.high);
        high += std::max(slope * a.low, slope * a.high);
        if (!names.ends_with('"' + a.name + '"')) names += (names.empty() ? "" : " and ") + ('"' + a.name + '"');
    }
    bool beyond(double least, double most) const { return low < least - rounding || high > most + rounding; }
};

void refuse_elastic(const MovingFlat& moving, int elastic) {
    const Elastic& e = moving.drawn.elastics[elastic];
    Reach ratio{e.ratio, e.ratio};
    for (const Alteration& a : moving.alterations)
        for (const ElasticMove& m : a.elastics)
            if (m.elastic == elastic) ratio.add(a, m.ratio);
    if (ratio.beyond(least_ratio, 1))
        throw std::invalid_argument(text("%s may make the elastic on edge %d of panel %s from %.4g to %.4g times as long as its cloth of %.4g mm, "
                                         "expected %.4g to 1",
                                         ratio.names.c_str(), e.span.edge, moving.drawn.panels[e.span.panel].name.c_str(), ratio.low,
                                         ratio.high, 1e3 * length_at_rest(moving.drawn, e.span), least_ratio));
}

void refuse_shrink(const MovingFlat& moving, int panel, bool warp) {
    const Panel& p = moving.drawn.panels[panel];
    Reach shrink{p.shrink[warp], p.shrink[warp]};
    for (const Alteration& a : moving.alterations)
        for (const ShrinkMove& m : a.shrinks)
            if (m.panel == panel) shrink.add(a, m.share[warp]);
    if (shrink.beyond(-most_shrink, most_shrink))
        throw std::invalid_argument(text("%s may shrink panel %s from %.4g to %.4g %% along its %s, expected %.4g to %.4g", shrink.names.c_str(),
                                         p.name.c_str(), 100 * shrink.low, 100 * shrink.high, warp ? "warp" : "weft", -100 * most_shrink,
                                         100 * most_shrink));
}

void refuse(const MovingFlat& moving, const VectorXd& start) {
    if (moving.alterations.empty()) throw std::invalid_argument("there is nothing to alter");
    for (std::size_t k = 0; k < moving.alterations.size(); ++k) {
        const Alteration& a = moving.alterations[k];
        const double at = start[Eigen::Index(k)];
        if (!(a.low < a.high))
            throw std::invalid_argument(text("alteration \"%s\" has nowhere to go: its bounds are %.4g and %.4g %s", a.name.c_str(),
                                             in_unit(a, a.low), in_unit(a, a.high), unit_of(a)));
        if (!(at >= a.low && at <= a.high))
            throw std::invalid_argument(text("alteration \"%s\" starts at %.4g %s, outside of its bounds %.4g and %.4g %s",
                                             a.name.c_str(), in_unit(a, at), unit_of(a), in_unit(a, a.low), in_unit(a, a.high), unit_of(a)));
    }
    for (int e = 0; e < int(moving.drawn.elastics.size()); ++e) refuse_elastic(moving, e);
    for (int p = 0; p < int(moving.drawn.panels.size()); ++p)
        for (const bool warp : {false, true}) refuse_shrink(moving, p, warp);
}

/// The seams that alterations can make unequal, those of them that have to be told to the optimiser, and that.
struct Stakes {
    std::vector<int> all, told;
    Optimiser optimiser = Optimiser::slsqp;
};

Stakes stakes_of(const MovingFlat& moving, const VectorXd& start, const FitOptions& options) {
    refuse(moving, start);
    VectorXd aside = start;
    for (std::size_t k = 0; k < moving.alterations.size(); ++k) // where symmetry hides no slope
        aside[Eigen::Index(k)] += 0.01 * (moving.alterations[k].high - moving.alterations[k].low);
    Stakes s;
    Eigen::MatrixXd slopes;
    s.all = seams_at_stake(moving, aside, slopes);
    s.told = independent_of(s.all, slopes);
    if (Eigen::Index(s.told.size()) >= start.size())
        throw std::invalid_argument(text("%d seams whose sides have to stay as long as each other leave %d alterations nothing to "
                                         "choose; alter both sides of each alike",
                                         int(s.told.size()), int(start.size())));
    s.optimiser = options.optimiser.value_or(s.told.empty() ? Optimiser::lbfgs : Optimiser::slsqp);
    if (s.optimiser == Optimiser::lbfgs && !s.told.empty())
        throw std::invalid_argument("lbfgs keeps bounds alone, and " + moving.drawn.seams[s.told[0]].name +
                                    " has to keep the lengths of its sides: slsqp or cobyla");
    return s;
}

void note_bounds(const MovingFlat& moving, FitResult& r) {
    for (std::size_t k = 0; k < moving.alterations.size(); ++k) {
        const Alteration& a = moving.alterations[k];
        const double at = r.amounts[Eigen::Index(k)], near = at_bound * (a.high - a.low);
        if (at < a.low + near || at > a.high - near) r.at_bounds.push_back(a.name);
    }
}

/// The sentence of a search that did not meet its goals.
std::string explain(const FitResult& r, const std::vector<FitGoal>& goals, const std::string& how) {
    std::string missed;
    for (std::size_t k = 0; k < goals.size(); ++k)
        if (!(r.after[k] <= goals[k].tolerance))
            missed += (missed.empty() ? "" : "; ") + text("\"%s\" is missed by %.3g of %.3g allowed", goals[k].name.c_str(),
                                                          r.after[k], goals[k].tolerance);
    std::string bounds;
    for (const std::string& name : r.at_bounds) bounds += (bounds.empty() ? ", with these at their bounds: " : ", ") + name;
    return how + (missed.empty() ? "" : ": " + missed) + bounds;
}

} // namespace

const char* to_string(FitEnd end) {
    switch (end) {
    case FitEnd::met: return "met";
    case FitEnd::nearest: return "nearest";
    case FitEnd::limit: return "limit";
    case FitEnd::stopped: return "stopped";
    case FitEnd::unreachable: return "unreachable";
    }
    return "nearest";
}

double seam_difference(const Pattern& drawn, const Pattern& pattern, int seam) {
    const SeamLengths before = seam_lengths(drawn, drawn.seams[seam]), now = seam_lengths(pattern, drawn.seams[seam]);
    return now.a - before.a / before.b * now.b;
}

void refuse_fit(const MovingFlat& moving, const VectorXd& start, const FitOptions& options) { stakes_of(moving, start, options); }

FitResult fit(AlteredDrape& drape, const std::vector<FitGoal>& goals, const VectorXd& start, const Points& at_rest_there,
              const FitOptions& options) {
    const MovingFlat& moving = drape.moving();
    const auto started = std::chrono::steady_clock::now();
    FitResult r;
    r.amounts = start;
    r.x = at_rest_there;
    const Stakes stakes = stakes_of(moving, start, options);
    r.seams = int(stakes.all.size());
    r.optimiser = stakes.optimiser;

    double strictest = infinity;
    for (const FitGoal& g : goals) strictest = std::min(strictest, g.tolerance);
    Search search{drape, goals, options, started, cost_of(moving, start, strictest), r, {}, {}};

    double last = infinity;
    OptimiseResult found;
    for (r.rounds = 1; r.rounds <= options.max_rounds; ++r.rounds) {
        if (options.begin) r.x = search.shape = options.begin(r.amounts);
        drape.anchor(r.amounts, r.x);
        search.known = {{r.amounts, r.x, search.whole_value(r.amounts, r.x)}};
        const double now = search.known[0].value;
        if (r.rounds == 1)
            for (const FitGoal& g : goals) r.before.push_back(miss(g, drape.garment_at(r.amounts), r.x));
        const bool good = search.meets(r.amounts, r.x, r.rounds == 1 ? comfortable : 1);
        if (good || (r.rounds > 1 && !(now < (1 - gain) * last)) || search.stopped) break;
        last = now;
        OptimiseOptions o;
        o.optimiser = r.optimiser;
        const int left = std::max(1, options.max_evaluations - r.evaluations);
        o.max_evaluations = o.optimiser == Optimiser::cobyla ? left : std::min(left, options.round_evaluations);
        o.value_tolerance = gain;
        o.equal_within = options.equal_within / seam_unit;
        search.met = false;
        found = optimise(problem_of(search, stakes.told, r.amounts), o);
        if (found.end == OptimiseEnd::failed) break;
        r.amounts = found.at;
        r.x = search.rest(r.amounts)->x;
        if (search.over() && !search.met) break;
    }
    r.rounds = std::min(r.rounds, options.max_rounds);
    for (const FitGoal& g : goals) r.after.push_back(miss(g, drape.garment_at(r.amounts), r.x));
    std::string worst;
    for (const int s : stakes.all)
        if (const double off = std::abs(Seams{moving}.difference(s, r.amounts)); off > r.unequal) {
            r.unequal = off;
            worst = moving.drawn.seams[s].name;
        }
    note_bounds(moving, r);
    r.seconds = search.seconds();
    const bool equal = r.unequal <= 2 * options.equal_within, all = search.meets(r.amounts, r.x, 1);
    if (!equal) {
        r.end = FitEnd::unreachable;
        r.why = explain(r, goals, text("%s cannot be kept equal: its sides differ by %.3g mm", worst.c_str(), 1e3 * r.unequal));
    } else if (all) {
        r.end = FitEnd::met;
    } else if (search.stopped) {
        r.end = FitEnd::stopped;
        r.why = explain(r, goals, "stopped by the caller");
    } else if (search.spent()) {
        r.end = FitEnd::limit;
        r.why = explain(r, goals, text("stopped after %d equilibria and %.3g s", r.evaluations, r.seconds));
    } else {
        r.end = FitEnd::nearest;
        r.why = explain(r, goals, found.end == OptimiseEnd::failed ? found.why : "no alterations within the bounds come nearer");
    }
    return r;
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/contact/friction.h"

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

constexpr double hold = 0.998;       // share of the limit at which a node gives way,
constexpr double most_kept = 0.995;  // which it keeps at first
constexpr double least_kept = 0.95;  // and at last
constexpr double give = 2;           // it does so over this many slips

// The force as a share of the limit, over y = u / slip, its derivative and its integral: hold (2y - y^2) up to
// y = 1, down from hold to what is kept by a smooth step, then that.
struct Law {
    double force, slope, integral;
};

Law law(double y, double kept) {
    if (y < 1) return {hold * y * (2 - y), 2 * hold * (1 - y), hold * y * y * (1 - y / 3)};
    const double q = std::min((y - 1) / give, 1.0), lost = hold - kept;
    const double held = 2 * hold / 3 + hold * (y - 1);
    if (q < 1)
        return {hold - lost * q * q * (3 - 2 * q), -6 * lost * q * (1 - q) / give,
                held - lost * give * q * q * q * (1 - q / 2)};
    return {kept, 0, held - lost * (give / 2 + y - 1 - give)};
}

// The force per distance, finite at 0.
double force_over_length(double u, double slip, double kept) {
    return u < slip ? hold * (2 - u / slip) / slip : law(u / slip, kept).force / u;
}

double share(const Friction& f, const Points& x, const Tie& tie) {
    return law(slide(tie, x).norm() / f.slip, tie.kept).force;
}

/// By how much, as a share, the lagged normal force may be off before friction has to be told: little for a tie about
/// to give way, more for one that slides or hardly needs friction.
double slack(const Friction& f, const Points& x, const Tie& tie) {
    return 0.3 * std::min(1 - tie.kept, 1 - share(f, x, tie));
}

Mat3 stiffness(const Friction& f, const Points& x, const Tie& tie, bool exact) {
    const Vec3 u = slide(tie, x);
    const double length = u.norm();
    const double across = force_over_length(length, f.slip, tie.kept);
    Mat3 m = across * (Mat3::Identity() - tie.normal * tie.normal.transpose());
    if (length > 1e-9 * f.slip) {
        const Vec3 n = u / length;
        const double ahead = law(length / f.slip, tie.kept).slope / f.slip;
        m += ((exact ? ahead : std::max(ahead, 0.0)) - across) * n * n.transpose();
    }
    return f.coefficient * tie.force * m;
}

} // namespace

Friction friction_at(const Points& x, double coefficient) {
    Friction f;
    f.coefficient = coefficient;
    f.ties.resize(x.size());
    for (int i = 0; i < int(x.size()); ++i) {
        Tie& tie = f.ties[i];
        tie.point = {i, i, i, i};
        tie.weight = {1, 0, 0, 0};
        tie.place = x[i];
        tie.kept = most_kept;
    }
    return f;
}

Vec3 held_vector(const Tie& tie, const Points& x) {
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < 4; ++k)
        if (tie.weight[k] != 0) sum += tie.weight[k] * x[tie.point[k]];
    return sum;
}

Vec3 slide(const Tie& tie, const Points& x) {
    const Vec3 d = held_vector(tie, x) - tie.place;
    return d - d.dot(tie.normal) * tie.normal;
}

double value(const Friction& f, const Points& x) {
    double sum = 0;
    for (const Tie& tie : f.ties)
        if (tie.force > 0)
            sum += f.coefficient * tie.force * f.slip * law(slide(tie, x).norm() / f.slip, tie.kept).integral;
    return sum;
}

Vec3 friction_force(const Friction& f, const Points& x, int t) {
    const Tie& tie = f.ties[t];
    if (!(tie.force > 0)) return Vec3::Zero();
    const Vec3 u = slide(tie, x);
    return -f.coefficient * tie.force * force_over_length(u.norm(), f.slip, tie.kept) * u;
}

void add_gradient(const Friction& f, const Points& x, Eigen::VectorXd& g) {
    for (int t = 0; t < int(f.ties.size()); ++t) {
        if (!(f.ties[t].force > 0)) continue;
        const Vec3 force = friction_force(f, x, t);
        for (int k = 0; k < 4; ++k)
            if (const double w = f.ties[t].weight[k]; w != 0) g.segment<3>(3 * f.ties[t].point[k]) -= w * force;
    }
}

bool add_hessian(const Friction& f, const Points& x, bool exact, BlockMatrix& h) {
    bool complete = true;
    for (const Tie& tie : f.ties) {
        if (!(tie.force > 0)) continue;
        const Mat3 m = stiffness(f, x, tie, exact);
        for (int k = 0; k < 4; ++k) {
            if (tie.weight[k] == 0) continue;
            h.add_diagonal(tie.point[k], tie.weight[k] * tie.weight[k] * m);
            for (int l = 0; l < 4; ++l) {
                if (tie.point[l] >= tie.point[k] || tie.weight[l] == 0) continue;
                if (const int slot = h.find(tie.point[k], tie.point[l]); slot >= 0)
                    h.add_off_diagonal(tie.point[l], slot, tie.weight[k] * tie.weight[l] * m);
                else
                    complete = false;
            }
        }
    }
    return complete;
}

void couplings(const Friction& f, std::vector<std::pair<int, int>>& pairs) {
    for (const Tie& tie : f.ties)
        for (int k = 0; k < 4; ++k)
            for (int l = 0; l < k; ++l)
                if (tie.force > 0 && tie.weight[k] != 0 && tie.weight[l] != 0)
                    pairs.emplace_back(tie.point[k], tie.point[l]);
}

double hardest(const Friction& f, const Tie& tie) { return hold * f.coefficient * tie.force; }

void hold_by(Friction& f, const Points& x, int t, const Vec3& force) {
    Tie& tie = f.ties[t];
    const double most = f.coefficient * tie.force, size = force.norm();
    tie.place = held_vector(tie, x);
    if (!(most > 0 && size > 0)) return;
    // hold (2y - y^2) = share of the limit
    const double y = 1 - std::sqrt(1 - std::min(size / (hold * most), 1.0));
    tie.place += y * f.slip / size * force;
}

Vec3 dragged(const Friction& f, const Vec3& slide) {
    const double reach = (1 + give) * f.slip, length = slide.norm();
    return length > reach ? Vec3(reach / length * slide) : slide;
}

bool renew(Friction& f, const Points& x, const Points& force, const std::vector<double>& least, bool trusted) {
    bool rising = false;
    for (int t = 0; t < int(f.ties.size()); ++t) {
        Tie& tie = f.ties[t];
        const Vec3 gone = slide(tie, x), left = dragged(f, gone);
        if (left != gone) tie.place = held_vector(tie, x) - left;
        const double now = force[t].norm();
        if (now == 0) {
            tie.force = 0;
        } else if (std::abs(now - tie.force) > slack(f, x, tie) * now) {
            tie.force = trusted ? now : std::min(now, std::max(2 * tie.force, least[t]));
            tie.normal = force[t] / now;
            rising = rising || tie.force < now;
        }
    }
    return rising;
}

void follow(Friction& f, const Points& x, int t, double force, bool at_rest) {
    Tie& tie = f.ties[t];
    const bool last = tie.kept <= least_kept; // and what slides stays as it is
    if (friction_force(f, x, t).norm() > f.coefficient * force) {
        tie.force = std::min(tie.force, force);
        if (tie.raised && at_rest) tie.kept = std::max(least_kept, 1 - 2 * (1 - tie.kept));
        tie.raised = false;
        return;
    }
    const double used = share(f, x, tie);
    const bool slips = last ? used > tie.kept : used >= tie.kept;
    if (slips && force - tie.force > slack(f, x, tie) * force) {
        tie.force = force;
        tie.raised = true;
    }
}

} // namespace toile

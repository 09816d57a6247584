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

Vec3 along(const Friction& f, const Points& x, int i) {
    const Vec3 d = x[i] - f.place[i];
    return d - d.dot(f.normal[i]) * f.normal[i];
}

double share(const Friction& f, const Points& x, int i) {
    return law(along(f, x, i).norm() / f.slip, f.kept[i]).force;
}

} // namespace

Friction friction_at(const Points& x, double coefficient) {
    Friction f;
    f.coefficient = coefficient;
    f.place = x;
    f.normal.assign(x.size(), Vec3::UnitY());
    f.force.assign(x.size(), 0.0);
    f.kept.assign(x.size(), most_kept);
    f.raised.assign(x.size(), 0);
    return f;
}

double value(const Friction& f, const Points& x) {
    double sum = 0;
    for (std::size_t i = 0; i < f.force.size(); ++i)
        if (f.force[i] > 0)
            sum += f.coefficient * f.force[i] * f.slip * law(along(f, x, int(i)).norm() / f.slip, f.kept[i]).integral;
    return sum;
}

Vec3 friction_force(const Friction& f, const Points& x, int i) {
    if (f.force.empty() || !(f.force[i] > 0)) return Vec3::Zero();
    const Vec3 u = along(f, x, i);
    return -f.coefficient * f.force[i] * force_over_length(u.norm(), f.slip, f.kept[i]) * u;
}

void add_gradient(const Friction& f, const Points& x, Eigen::VectorXd& g) {
    for (std::size_t i = 0; i < f.force.size(); ++i) g.segment<3>(3 * i) -= friction_force(f, x, int(i));
}

double friction_slack(const Friction& f, const Points& x, int i) {
    return 0.3 * std::min(1 - f.kept[i], 1 - share(f, x, i));
}

void hold_by(Friction& f, const Points& x, int i, const Vec3& force) {
    const double most = f.coefficient * f.force[i], size = force.norm();
    f.place[i] = x[i];
    if (!(most > 0 && size > 0)) return;
    // hold (2y - y^2) = share of the limit
    const double y = 1 - std::sqrt(1 - std::min(size / (hold * most), 1.0));
    f.place[i] += y * f.slip / size * force;
}

void drag_places(Friction& f, const Points& x) {
    const double reach = (1 + give) * f.slip;
    for (std::size_t i = 0; i < f.force.size(); ++i) {
        const Vec3 u = along(f, x, int(i));
        const double length = u.norm();
        if (length > reach) f.place[i] = x[i] - reach / length * u;
    }
}

void follow(Friction& f, const Points& x, int i, double force, bool at_rest) {
    const bool last = f.kept[i] <= least_kept; // and what slides stays as it is
    if (friction_force(f, x, i).norm() > f.coefficient * force) {
        f.force[i] = std::min(f.force[i], force);
        if (f.raised[i] && at_rest) f.kept[i] = std::max(least_kept, 1 - 2 * (1 - f.kept[i]));
        f.raised[i] = 0;
        return;
    }
    const double used = share(f, x, i);
    const bool slips = last ? used > f.kept[i] : used >= f.kept[i];
    if (slips && force - f.force[i] > friction_slack(f, x, i) * force) {
        f.force[i] = force;
        f.raised[i] = 1;
    }
}

void add_hessian(const Friction& f, const Points& x, bool exact, BlockMatrix& h) {
    for (std::size_t i = 0; i < f.force.size(); ++i) {
        if (!(f.force[i] > 0)) continue;
        const Vec3 u = along(f, x, int(i));
        const double length = u.norm(), most = f.coefficient * f.force[i];
        const Mat3 tangent = Mat3::Identity() - f.normal[i] * f.normal[i].transpose();
        const double across = force_over_length(length, f.slip, f.kept[i]);
        Mat3 m = across * tangent;
        if (length > 1e-9 * f.slip) {
            const Vec3 n = u / length;
            const double ahead = law(length / f.slip, f.kept[i]).slope / f.slip;
            m += ((exact ? ahead : std::max(ahead, 0.0)) - across) * n * n.transpose();
        }
        h.add_diagonal(int(i), most * m);
    }
}

} // namespace toile

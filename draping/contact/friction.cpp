// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/contact/friction.h"

namespace toile {

namespace {

// f'(u) rises from 0 to 1 at u = slip: 2y - y^2, y = u / slip. f is its integral.
double integral(double u, double slip) {
    const double y = u / slip;
    return y < 1 ? slip * (y * y - y * y * y / 3) : u - slip / 3;
}
double rise_over_length(double u, double slip) { return u < slip ? (2 - u / slip) / slip : 1 / u; }

Vec3 along(const Friction& f, const Points& x, int i) {
    const Vec3 d = x[i] - f.place[i];
    return d - d.dot(f.normal[i]) * f.normal[i];
}

} // namespace

double value(const Friction& f, const Points& x) {
    double sum = 0;
    for (std::size_t i = 0; i < f.force.size(); ++i)
        if (f.force[i] > 0) sum += f.coefficient * f.force[i] * integral(along(f, x, int(i)).norm(), f.slip);
    return sum;
}

Vec3 friction_force(const Friction& f, const Points& x, int i) {
    if (f.force.empty() || !(f.force[i] > 0)) return Vec3::Zero();
    const Vec3 u = along(f, x, i);
    return -f.coefficient * f.force[i] * rise_over_length(u.norm(), f.slip) * u;
}

void add_gradient(const Friction& f, const Points& x, Eigen::VectorXd& g) {
    for (std::size_t i = 0; i < f.force.size(); ++i) g.segment<3>(3 * i) -= friction_force(f, x, int(i));
}

void add_hessian(const Friction& f, const Points& x, BlockMatrix& h) {
    for (std::size_t i = 0; i < f.force.size(); ++i) {
        if (!(f.force[i] > 0)) continue;
        const Vec3 u = along(f, x, int(i));
        const double length = u.norm(), most = f.coefficient * f.force[i];
        const Mat3 tangent = Mat3::Identity() - f.normal[i] * f.normal[i].transpose();
        Mat3 m = rise_over_length(length, f.slip) * tangent;
        if (length > 1e-9 * f.slip) { // along u the force rises slower: 2(1 - y)/slip, then not at all
            const Vec3 n = u / length;
            const double ahead = length < f.slip ? 2 * (1 - length / f.slip) / f.slip : 0;
            m += (ahead - rise_over_length(length, f.slip)) * n * n.transpose();
        }
        h.add_diagonal(int(i), most * m);
    }
}

} // namespace toile

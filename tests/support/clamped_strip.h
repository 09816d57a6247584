// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A strip of unit length and a bending stiffness of 1 N m that is clamped at one end, whatever it is made of.

#include "tests/support/plates.h"
#include "tests/support/static_solver.h"

namespace toile::test {

/// Both arms of a strip that is clamped in its middle.
struct ClampedStrip {
    FlatMesh mesh;
    int nodes = 0;
    std::vector<Term> terms;
    std::vector<double> areas;
};

/// From its half on x >= 0; `terms` says what a garment is made of.
inline ClampedStrip clamped_strip(const FlatMesh& half, const std::function<std::vector<Term>(const Garment&)>& terms) {
    ClampedStrip s;
    s.mesh = with_mirror_image(half);
    const Garment garment = garment_of(s.mesh);
    s.nodes = garment.node_count;
    s.terms = terms(garment);
    s.areas = node_areas(garment);
    return s;
}

/// Both arms by one: nodes at x = 0 are held, those at x < 0 mirror those at x > 0.
inline Freedoms clamped(const ClampedStrip& s, const Eigen::VectorXd& q) {
    Freedoms freedoms(q);
    const std::vector<int> twin = twins(s.mesh.points);
    for (int i = 0; i < s.nodes; ++i)
        for (int c = 0; c < 3; ++c) {
            if (std::abs(s.mesh.points[i].x()) < 1e-12) freedoms.hold(3 * i + c, q[3 * i + c]);
            if (twin[i] != i) freedoms.tie(3 * i + c, 3 * twin[i] + c, c == 0 ? -1 : 1);
        }
    freedoms.number();
    return freedoms;
}

struct Hung {
    bool converged = false, stable = false;
    double drop_over_reach = 0;
};

/// The strip under a weight of gamma N/m2, from the elastica to rest.
inline Hung hang(const ClampedStrip& s, double gamma) {
    const std::vector<Vec2> curve = elastica(gamma);
    Eigen::VectorXd q(3 * s.nodes), load = Eigen::VectorXd::Zero(3 * s.nodes);
    for (int i = 0; i < s.nodes; ++i) {
        const Vec2& p = s.mesh.points[i];
        const Vec2 at = curve[std::lround(std::abs(p.x()) * (int(curve.size()) - 1))];
        q.segment<3>(3 * i) << std::copysign(at.x(), p.x()), p.y(), -at.y();
        load[3 * i + 2] = -gamma * s.areas[i];
    }
    const StaticResult r = solve_static(s.terms, load, clamped(s, q), q);
    double x = 0, z = 0;
    for (int i = 0; i < s.nodes; ++i)
        if (s.mesh.points[i].x() > 1 - 1e-9) x += r.q[3 * i], z -= r.q[3 * i + 2];
    return {r.converged, r.stable, z / x};
}

} // namespace toile::test

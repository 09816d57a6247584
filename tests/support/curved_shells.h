// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Shells with known answers: a shallow cap and a corrugated sheet.

#include "tests/support/curved_cloth.h"

namespace toile::test {

// ---- the cap

inline constexpr double cap_radius = 10; // m, of its sphere; its rim has 1 m, so that it is 50 mm high

inline Cloth cap(int rings, std::uint64_t seed) {
    return pressed(disc(rings, 0.2, seed), [](const Vec2& p) -> Vec3 {
        return {p.x(), p.y(), (1 - p.squaredNorm()) / (2 * cap_radius)};
    });
}

// How high its middle lies over its rim, m.
inline double height(const Points& x, int rings) {
    double rim = 0;
    for (std::size_t i = x.size() - 6 * rings; i < x.size(); ++i) rim += x[i].z() / (6 * rings);
    return x[0].z() - rim;
}

struct Threshold {
    double lambda = 0;
    bool settled = false; ///< whether every cap that was tried came to rest
};

/// From which slenderness (12 (1 - nu^2))^(1/4) a / sqrt(R h) on a cap that is turned inside out stays so, to `within`, by
/// bisection; each cap starts from where the last that stayed came to rest. Shell theory: 5.0873 at nu = 0.
inline Threshold bistable_from(int rings, double within, std::uint64_t seed = 3) {
    const Cloth c = cap(rings, seed);
    Points inverted = c.x;
    for (Vec3& p : inverted) p.z() = -p.z();
    Threshold found{0, true};
    const auto stays = [&](double lambda, Points x) {
        Fabric fabric = isotropic(1e5, 1e5 / (std::pow(lambda, 4) * cap_radius * cap_radius));
        fabric.density = 1; // kg/m2, by which settle() counts forces
        FreeCloth cloth = free_cloth(c.garment, fabric);
        found.settled &= comes_to_rest(cloth, x, 1e-4, 1000);
        const bool stayed = height(x, rings) < 0;
        if (stayed) inverted = x;
        return stayed;
    };
    double low = 4, high = 6;
    found.settled &= stays(high, inverted) && !stays(low, inverted);
    while (high - low > within) {
        const double middle = (low + high) / 2;
        (stays(middle, inverted) ? high : low) = middle;
    }
    found.lambda = (low + high) / 2;
    return found;
}

// ---- the corrugation

inline constexpr double pitch = 0.05, amplitude = 0.005, thickness = 0.001, bend = 1; // m, N m; settle() counts in joules

// Height of the sheet's middle over x in [0, pitch], symmetric about the middle of the pitch.
inline double corrugation(double x) { return -amplitude * std::cos(2 * std::numbers::pi * x / pitch); }

struct Corrugated {
    Cloth cloth;
    Fabric fabric = isotropic(12 * bend / (thickness * thickness), bend);
    int columns = 0, rows = 0; ///< of squares; node i + (columns + 1) j
    double width = 0;          ///< m, along the corrugation
};

inline Corrugated corrugated(int columns, int rows) {
    const double edge = pitch / columns;
    Corrugated c{pressed(halved_squares(columns, rows, edge), [](const Vec2& p) -> Vec3 {
        return {p.x(), p.y(), corrugation(p.x())};
    })};
    c.fabric.density = 1e4; // kg/m2, by which settle() counts forces: the exact Hessian is used from the start
    c.columns = columns, c.rows = rows, c.width = rows * edge;
    return c;
}

struct Stiffness {
    double ratio = 0; ///< to that of a flat sheet
    bool settled = false;
};

/// Energy at rest with the nodes where `held` pinned at `bent`, over that of a flat sheet of the same D bent to `curvature`
/// (1/m) over the same base.
inline Stiffness stiffness_ratio(const Corrugated& c, const Points& bent, double curvature, const std::function<bool(int, int)>& held) {
    FreeCloth cloth = free_cloth(c.cloth.garment, c.fabric);
    Points x = bent;
    Random random(6);
    for (int j = 0; j <= c.rows; ++j)
        for (int i = 0; i <= c.columns; ++i) {
            const int node = i + (c.columns + 1) * j;
            if (held(i, j))
                cloth.pin(node);
            else
                x[node] += random.vec3(1e-7);
        }
    const bool settled = comes_to_rest(cloth, x, 1e-5);
    return {cloth.value(x) / (0.5 * bend * curvature * curvature * pitch * c.width), settled};
}

// The ridges bent to circles about an axis far above: every section across them stays as it is and turns.
inline Stiffness stiffness_along(const Corrugated& c) {
    const double curvature = 0.02;
    Points bent = c.cloth.x;
    for (Vec3& p : bent) {
        const double r = 1 / curvature - p.z(), angle = (p.y() - c.width / 2) * curvature;
        p = {p.x(), r * std::sin(angle), 1 / curvature - r * std::cos(angle)};
    }
    return stiffness_ratio(c, bent, curvature, [&](int, int j) { return j == 0 || j == c.rows; });
}

// Every section across the ridges unbent alike along its arc, by `turn` in all.
inline Stiffness stiffness_across(const Corrugated& c) {
    const double turn = 0.05;
    const auto slope = [](double x) { return 2 * std::numbers::pi * amplitude / pitch * std::sin(2 * std::numbers::pi * x / pitch); };
    const int steps = 4000; // a multiple of the columns
    double arc = 0;
    for (int i = 0; i < steps; ++i) arc += std::hypot(1, slope(pitch * (i + 0.5) / steps)) * pitch / steps;
    Points bent = c.cloth.x;
    Vec2 at(0, corrugation(0));
    double s = 0;
    for (int i = 0; i <= steps; ++i) {
        if (i % (steps / c.columns) == 0)
            for (int j = 0; j <= c.rows; ++j) {
                Vec3& p = bent[i / (steps / c.columns) + (c.columns + 1) * j];
                p = {at.x(), p.y(), at.y()};
            }
        const double m = slope(pitch * (i + 0.5) / steps), ds = std::hypot(1, m) * pitch / steps;
        const double angle = std::atan(m) + turn * ((s + ds / 2) / arc - 0.5);
        at += ds * Vec2(std::cos(angle), std::sin(angle));
        s += ds;
    }
    return stiffness_ratio(c, bent, turn / pitch, [&](int i, int) { return i <= 1 || i >= c.columns - 1; });
}

} // namespace toile::test

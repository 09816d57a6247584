// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Where the lines of one panel cross or touch.

#include "patterns/pattern.h"

namespace toile {

/// A chain of edges of a panel and what it is called in messages.
struct Chain {
    const Loop* edges = nullptr;
    bool closed = true;
    bool may_touch = false; ///< an inner line: may end on other lines
};

struct LineCrossing {
    int chain_a = 0, edge_a = 0, chain_b = 0, edge_b = 0; ///< (chain, edge) of a not after that of b
    Vec2 at = Vec2::Zero();                               ///< metres
    bool touch = false;                                   ///< meet without passing through each other
};

struct CrossingOptions {
    double sag = 1e-5;    ///< metres; curves are looked at as polylines this near
    double corner = 2e-4; ///< metres around the corner of two neighbouring edges where they may meet
};

/// Pairs of edges that cross, or touch where they are not neighbours, each pair once, sorted; at most about a
/// thousand. All coordinates must be finite and all edges of the panel's chains within `extent` metres of
/// each other. Decided exactly for points rounded to a grid of extent / 2^24, at least a micrometre.
std::vector<LineCrossing> find_crossings(const std::vector<Chain>& chains, double extent,
                                     const CrossingOptions& options = {});

/// True when p lies inside the closed loop (even-odd), curves taken as polylines within 1e-5 m.
bool contains(const Loop& loop, const Vec2& p);

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Where theory says that methods begin to fail. docs/stability.md has the derivations in words; what symplectic Euler bears is
// Fastest::step() of draping/solve/stability.h.

#include <vector>

namespace toile {

/// Longest step (s) for which M + h^2 K of two free masses (kg) and the spring between them is not indefinite: K has
/// -2 stiffness (rest - length) / length across the spring, so h = sqrt(mass length / (2 stiffness (rest - length))). Infinity for a
/// spring that is not compressed.
double indefinite_step(double mass, double stiffness, double rest, double length);
/// The same of any cloth, by the lowest eigenvalue of M^-1 K (1/s2).
double indefinite_step(double lowest);

/// Longest step (s) by which implicit Euler leaves a swing of `frequency` (rad/s) the share `left` of its amplitude after a period.
/// A step divides the amplitude by sqrt(1 + z^2), z = frequency h, and a period has 2 pi / z of them: pi log(1 + z^2) = -z log(left).
double swing_step(double frequency, double left);

/// The same of BDF2: a step divides the amplitude by |2 - sqrt(1 + 2 i z)|.
double bdf2_swing_step(double frequency, double left);

/// What an iteration of projective dynamics leaves of an error across cloth that is drawn out by `strain`. Lines of unit stiffness are
/// bound by 1 in all directions, and resist turning by 1 - 1 / (1 + strain) alone: the rest of it is left. `shared` is what both
/// have beside (bending over stretch): 1 - strain / (1 + strain) without it, which is 1 - strain for small ones.
double projective_rate(double strain, double shared = 0);

/// What a sweep of position-based dynamics leaves of the slowest error of a chain of so many links that hangs from one end.
/// Multipliers solve A l = b, A tridiagonal with s (w_a + w_b) + 1 and -s, s = `softness` (link stiffness times h^2 over the mass of a
/// node), w the mobility of a link's ends: 0 where the chain is held, 1 / `end_mass` at its free end, 1 elsewhere. A sweep is one of Gauss and
/// Seidel, which leaves the square of what Jacobi's leaves (Young 1954), his largest eigenvalue. For s to infinity and an end as heavy
/// as the rest that is cos(pi / 2 links): 1 - (pi / 2 links)^2 per sweep, so N^2 sweeps.
double sweep_rate(int links, double softness, double end_mass = 1);

/// How often a rate has to be applied to come from 1 to `left`.
double times_until(double rate, double left);

enum class ChainOrder { from_held_end, from_free_end };

/// What sweeps of limits on elongation leave of a chain of equal masses, but for its free end's, that hangs from the other, each link longer
/// than its limit by 1: the excess of every link, from the held end on. A link that is too long moves its ends by their mobilities, the
/// first its free end by all; one that is not too long is left.
std::vector<double> limited_chain(int links, ChainOrder order, int sweeps, double end_mass = 1);
/// Sweeps until no link is too long by more than `left` of that.
int limit_sweeps(int links, ChainOrder order, double left, double end_mass = 1);

} // namespace toile

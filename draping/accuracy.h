// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What a drape that was asked for to an accuracy has found out about its own error.

#include <optional>
#include <string>
#include <vector>

namespace toile {

/// What the error is of.
enum class AccuracyOf {
    place, ///< m, RMS distance of the surface
    strain ///< a share, RMS difference of the strains along warp and weft (draping/strain_difference.h)
};

/// One mesh of such a drape, brought to rest as a finest level is, from where the mesh before it came to rest.
struct AccuracyMesh {
    double edge_length = 0; ///< m
    int vertices = 0;
    int iterations = 0;
    double seconds = 0;
    std::optional<double> difference; ///< from the mesh before, as AccuracyOf says; nothing: the first
    double motion = 0;                ///< m, of the node that its last iteration moved farthest
};

/// A choice of the program's own, and the measure that it was made by.
struct AccuracyDecision {
    std::string what;    ///< a sentence
    std::string measure; ///< what `value` is of
    double value = 0;    ///< in the unit of its measure: m, s, a share
    bool taken_back = false; ///< it turned out wrong, and the next decisions stand for it
};

struct AccuracyReport {
    AccuracyOf of = AccuracyOf::place;       ///< what `asked`, estimates and differences are of, and so their unit
    std::optional<double> asked;             ///< nothing: there was a budget
    std::optional<double> budget;            ///< s
    std::optional<double> estimate;          ///< of the last mesh; nothing: there was but one
    double discretisation = 0, residual = 0; ///< what of the estimate the mesh and the forces left make
    double order = 0;                        ///< power of the edge length that the differences are taken to fall by
    bool met = false;                        ///< estimate <= asked, or in the budget; at rest
    std::vector<AccuracyMesh> meshes;
    std::vector<AccuracyDecision> decisions;
};

inline constexpr double cautious_order = 0.25; ///< of two meshes alone: two of three tops and trousers went as far from 20 to 10 mm as from 40 to 20
inline constexpr double assumed_order = 1.5; ///< the most that is taken: real garments showed 1 to 2, and one small difference may be chance

/// The order by which differences fall: `before` from edge length a to b, `after` from b to c. No more than assumed_order;
/// negative when they grow. a > b > c > 0, differences > 0.
double measured_order(double before, double after, double a, double b, double c);

/// How far a drape would go at half its edge length when it went `difference` from an edge length `ratio` times its own:
/// what a geometric series of this order goes on by. ratio > 1.
double expected_change(double difference, double ratio, double order);

} // namespace toile

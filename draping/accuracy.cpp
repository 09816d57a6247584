// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/accuracy.h"

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

/// (s^p - 1) / p, the distance from edge length h to s h of a drape that is C h^p / p from its limit, over C h^p.
double way(double s, double p) { return std::abs(p) < 1e-6 ? std::log(s) : (std::pow(s, p) - 1) / p; }

} // namespace

double measured_order(double before, double after, double a, double b, double c) {
    // before / after = (a^p - b^p) / (b^p - c^p) rises with p.
    const auto ratio = [&](double p) { return way(a / b, p) / -way(c / b, p); };
    double low = -10, high = assumed_order;
    if (ratio(high) <= before / after) return high;
    for (int k = 0; k < 60; ++k) {
        const double middle = (low + high) / 2;
        (ratio(middle) < before / after ? low : high) = middle;
    }
    return high;
}

double expected_change(double difference, double ratio, double order) {
    return difference * -way(0.5, order) / way(ratio, order);
}

} // namespace toile

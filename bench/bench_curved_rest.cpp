// SPDX-License-Identifier: GPL-3.0-or-later
// The figures of docs/curved_rest.md: how far shells with known answers are off on meshes of several sizes.

#include "tests/support/curved_shells.h"

#include <cstdio>

using namespace toile;
using namespace toile::test;

int main() {
    std::puts("cap: edge over rim radius, threshold on three meshes, off shell theory");
    for (const int rings : {5, 7, 10, 14, 20}) {
        std::printf("1/%d", rings);
        for (const std::uint64_t seed : {1, 2, 3}) {
            const Threshold found = bistable_from(rings, 2e-3, seed);
            std::printf("  %.4f (%+.2f %%)%s", found.lambda, 100 * (found.lambda / 5.087275721655189 - 1),
                        found.settled ? "" : " not at rest");
        }
        std::puts("");
    }
    std::puts("corrugation: columns per pitch, along the ridges, across");
    for (const int columns : {8, 10, 16, 20, 25}) {
        const Stiffness along = stiffness_along(corrugated(columns, 2 * columns)),
                        across = stiffness_across(corrugated(columns, columns / 2));
        std::printf("%d  %.3f (%+.2f %%)  %.5f (%+.2f %%)%s\n", columns, along.ratio,
                    100 * (along.ratio / 157.99410512854251 - 1), across.ratio,
                    100 * (across.ratio / 0.9154293859909557 - 1),
                    along.settled && across.settled ? "" : "  not at rest");
    }
}

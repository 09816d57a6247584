// SPDX-License-Identifier: GPL-3.0-or-later
// Implicit Euler with the exact second derivative of compressed cloth: from sqrt(m l / 2 k (l0 - l)) on its matrix is not positive definite.

#include "draping/solve/implicit.h"
#include "draping/stability/boundary.h"
#include "tests/stability/scenes.h"
#include "tests/support/free_springs.h"

using namespace toile;
using namespace toile::test;

namespace {

/// One step of two free masses and a spring of 10 cm pushed together to `length` (m).
bool steps(double length, double step, bool projected) {
    Spring spring{0, 1, 0.1};
    spring.stiffness = 200;
    FreeCloth problem(std::make_unique<Springs>(std::vector<Spring>{spring}), {0.01, 0.01}, projected);
    NoContact response;
    ImplicitStepper stepper(problem, response, {step, 0, 1e9});
    Moving cloth{{{0, 0, 0}, {length, 0, 0}}};
    cloth.velocity.assign(2, Vec3::Zero());
    try {
        stepper.step(cloth, {});
    } catch (const std::runtime_error&) {
        return false;
    }
    return true;
}

} // namespace

TEST_CASE("stability: two masses and a compressed spring have steps up to sqrt of m l over 2 k times what it lacks") {
    for (const double length : {0.099, 0.09, 0.05, 0.01}) {
        const double bound = std::sqrt(0.01 * length / (2 * 200 * (0.1 - length)));
        INFO(length);
        CHECK(indefinite_step(0.01, 200, 0.1, length) == Approx(bound).epsilon(1e-12));
        CHECK(steps(length, (1 - 1e-6) * bound, false)); // nothing but rounding is in the way
        CHECK(!steps(length, (1 + 1e-6) * bound, false));
        CHECK(steps(length, 100 * bound, true));
    }
    CHECK(std::isinf(indefinite_step(0.01, 200, 0.1, 0.11)));
    CHECK(steps(0.11, 1e3, false));
}

TEST_CASE("stability: compressed strips have steps as long as their lowest eigenvalue allows") {
    for (const Method method : {Method::springs_implicit, Method::triangles}) {
        const StabilityScene s = stability_scene(method, "compressed, exact second derivative");
        // Both are found to rounding: of eigenvalues within 1e-9 of the largest, which is up to 1e4 times the lowest.
        CHECK(check_boundary(s, stability_meshes(5), {1e4, 1e6}, 0.999, 1.001) == 36);
    }
}

TEST_CASE("stability: a strip that is too stiff to buckle bears any step") {
    // Held at both ends, by compression 0.05 its plate buckles where 0.05 k = pi^2 D / L^2 to within the edges' share: at 197, not at 100.
    const StabilityScene s = stability_scene(Method::triangles, "compressed, exact second derivative");
    for (const StabilityMesh& mesh : stability_meshes(0)) {
        const StabilityColumn column = s.run(mesh, 100, {1e3});
        CHECK(std::isinf(column.boundary));
        CHECK(column.outcomes[0].failure == "");
        CHECK(!std::isinf(s.run(mesh, 1000, {}).boundary));
    }
}

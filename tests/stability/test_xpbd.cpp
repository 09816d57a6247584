// SPDX-License-Identifier: GPL-3.0-or-later
// Position-based dynamics: a chain of N links takes of the order of N^2 sweeps.

#include "draping/solve/free_cloth.h"
#include "draping/solve/xpbd.h"
#include "draping/stability/boundary.h"
#include "tests/stability/scenes.h"
#include "tests/support/free_springs.h"

using namespace toile;
using namespace toile::test;

namespace {

/// Links of 1 cm as constraints, one after the other.
class Chain final : public ConstraintEnergy {
public:
    Chain(int links, double stiffness) : links_(links), stiffness_(stiffness) {}

    int constraint_count() const override { return links_; }
    Constraint constraint(int k, const Points& x) const override {
        const Vec3 d = x[k + 1] - x[k];
        Constraint c;
        c.count = 2;
        c.nodes = {k, k + 1};
        c.value = d.norm() - 0.01;
        c.gradient[0] = -d.normalized();
        c.gradient[1] = d.normalized();
        c.stiffness = stiffness_;
        return c;
    }
    double value(const Points& x) const override {
        double sum = 0;
        for (int k = 0; k < links_; ++k) sum += 0.5 * stiffness_ * std::pow(constraint(k, x).value, 2);
        return sum;
    }
    void add_gradient(const Points&, Eigen::VectorXd&) const override {}
    void couplings(std::vector<std::pair<int, int>>&) const override {}
    void add_hessian(const Points&, HessianKind, BlockMatrix&) const override {}

private:
    int links_;
    double stiffness_;
};

constexpr double mass = 1e-4, step = 0.01; // kg, s

/// How far the lower end of a hanging chain is after one step of so many sweeps, m.
double fallen(int links, double softness, int sweeps) {
    auto model = std::make_unique<Chain>(links, softness * mass / (step * step));
    const Chain& energy = *model;
    auto problem = std::make_unique<FreeCloth>(std::move(model), std::vector<double>(links + 1, mass));
    problem->gravity = 0.1;
    problem->pin(0);
    NoContact response;
    XpbdStepper stepper(std::move(problem), energy, response, {step, 0, 1e9}, {1, sweeps});
    Moving cloth;
    for (int i = 0; i <= links; ++i) cloth.x.push_back({0, -0.01 * i, 0});
    const double start = cloth.x.back().y();
    stepper.step(cloth, {});
    return start - cloth.x.back().y();
}

/// What a sweep leaves of the error, between two numbers of sweeps.
double rate(int links, double softness, int from, int to) {
    const double exact = fallen(links, softness, 100 * links * links);
    return std::pow((fallen(links, softness, to) - exact) / (fallen(links, softness, from) - exact), 1.0 / (to - from));
}

} // namespace

TEST_CASE("stability: a sweep of a chain leaves what theory says") {
    for (const auto& [links, softness, from, to] : {std::tuple{10, 1e5, 80, 160}, {20, 1e5, 300, 600}, {10, 10.0, 40, 80}, {20, 10.0, 60, 120}}) {
        INFO(links << " links, softness " << softness);
        const double measured = rate(links, softness, from, to), theory = sweep_rate(links, softness);
        CHECK(std::log(measured) / std::log(theory) == Approx(1).epsilon(0.02)); // what is left of faster errors
    }
    CHECK(std::log(sweep_rate(100, 1e9)) / std::log(sweep_rate(200, 1e9)) == Approx(4).epsilon(0.02)); // N^2
}

TEST_CASE("stability: stiff strips take the sweeps of a chain of their rows") {
    // Aligned squares are chains of their edges; inner ones belong to two triangles, and so are swept twice, so that the borders are
    // slowest. 15 %: theory has the slowest error alone, the first sweeps are not yet at its rate.
    CHECK(check_boundary(stability_scene(Method::xpbd, "let go"), {{MeshKind::aligned, 0}}, {1e3, 1e4, 1e5, 1e7}, 0.85, 1.15) == 4);
    CHECK(stability_scene(Method::xpbd, "let go").run({MeshKind::aligned, 0}, 100, {1}).outcomes[0].failure == ""); // so soft that it hardly pulls
}

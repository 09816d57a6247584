// SPDX-License-Identifier: GPL-3.0-or-later
// The bake-off behind docs/bending.md: bending elements against known answers and against each other.
// bench_bending [test ...] with tests out of: plate cylinder twist cantilever lateral cost sheet. Default:
// all.

#include "bench/asked.h"
#include "bench/bending/candidates.h"
#include "tests/support/hanging_sheet.h"
#include "tests/support/plates.h"

#include <Eigen/Geometry>

#include <chrono>
#include <cstdio>

using namespace toile;
using namespace toile::bench;
using namespace toile::test;
using Eigen::VectorXd;

namespace {

constexpr double pi = std::numbers::pi;
constexpr int seeds = 5;

Fabric plate_fabric(double k, double d) {
    Fabric f;
    f.name = "plate";
    f.stretch_warp = f.stretch_weft = k;
    f.shear = k / 2;
    f.compression = 1;
    f.bend_warp = f.bend_weft = d;
    f.bend_twist = d / 2;
    return f;
}

VectorXd placed(const Discretisation& plate, const std::function<Vec3(const Vec2&)>& map) {
    VectorXd q = VectorXd::Zero(plate.freedoms());
    for (std::size_t i = 0; i < plate.carriers.size(); ++i)
        q.segment<3>(3 * i) = map(plate.carriers[i]);
    return q;
}

VectorXd weight_load(const Discretisation& plate, const Vec3& per_area) {
    VectorXd load = VectorXd::Zero(plate.freedoms());
    for (std::size_t i = 0; i < plate.carriers.size(); ++i)
        load.segment<3>(3 * i) = plate.areas[i] * per_area;
    return load;
}

// Carriers stay; what else there is takes the values of least energy.
VectorXd relax_extras(const Discretisation& plate, const VectorXd& q) {
    if (plate.extras == 0) return q;
    Freedoms freedoms(q);
    for (int i = 0; i < int(3 * plate.carriers.size()); ++i)
        freedoms.hold(i, q[i]);
    freedoms.number();
    return solve_static({plate.bend}, VectorXd::Zero(q.size()), freedoms, q).q;
}

struct Worst {
    double low = 1e300, high = -1e300;
    void add(double e) { low = std::min(low, e), high = std::max(high, e); }
};

void print(const char* what, const Worst& w) {
    std::printf("  %s %+.2f .. %+.2f %%", what, 100 * w.low, 100 * w.high);
}

// Simply supported unit square under unit pressure, small deflection: load times deflection against Navier's
// series.
void supported_plate(const Candidate& candidate) {
    double exact = 0;
    for (int m = 1; m < 60; m += 2)
        for (int n = 1; n < 60; n += 2)
            exact += 64 / (std::pow(pi, 8) * m * m * n * n * std::pow(m * m + n * n, 2));
    for (int n : {10, 20, 40}) {
        Worst worst;
        for (int seed = 1; seed <= seeds; ++seed) {
            const Discretisation plate =
                candidate.make(garment_of(jittered_rectangle(1, 1, 1.0 / n, 0.3, seed)), plate_fabric(1, 1));
            const VectorXd q = placed(plate, [](const Vec2& p) { return Vec3(p.x(), p.y(), 0); });
            Freedoms freedoms(q);
            for (std::size_t i = 0; i < plate.carriers.size(); ++i) {
                const Vec2& p = plate.carriers[i];
                const bool border = std::min(p.minCoeff(), 1 - p.maxCoeff()) < 1e-9;
                for (int c = 0; c < (border ? 3 : 2); ++c)
                    freedoms.hold(3 * i + c, q[3 * i + c]);
            }
            freedoms.number();
            Entries entries;
            plate.bend.add_hessian(q, HessianKind::exact, entries);
            const Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<double>> solver(freedoms.reduce(entries));
            const VectorXd load = freedoms.reduce(weight_load(plate, Vec3(0, 0, 1)));
            worst.add(load.dot(solver.solve(load)) / exact - 1);
        }
        std::printf("  n %d:", n);
        print("", worst);
    }
    std::printf("\n");
}

// Bending energy of nodes on a cylinder of radius 1/2, rolled in 8 directions, and of a twist.
void rolled(const Candidate& candidate, bool twist) {
    for (int n : {20, 40}) {
        Worst worst;
        for (int seed = 1; seed <= seeds; ++seed) {
            const Discretisation plate =
                candidate.make(garment_of(jittered_rectangle(1, 1, 1.0 / n, 0.3, seed)), plate_fabric(1, 1));
            for (int direction = 0; direction < (twist ? 4 : 8); ++direction) {
                const double a = pi * direction / 8, kappa = twist ? 0.1 : 2;
                const VectorXd q = placed(plate, [&](const Vec2& p) -> Vec3 {
                    const double u = std::cos(a) * (p.x() - 0.5) + std::sin(a) * (p.y() - 0.5);
                    const double v = -std::sin(a) * (p.x() - 0.5) + std::cos(a) * (p.y() - 0.5);
                    if (twist) return {u, v, kappa * u * v};
                    return {std::sin(kappa * u) / kappa, v, (1 - std::cos(kappa * u)) / kappa};
                });
                const double exact = kappa * kappa * (twist ? 1 : 0.5);
                worst.add(plate.bend.value(relax_extras(plate, q)) / exact - 1);
            }
        }
        std::printf("  n %d:", n);
        print("", worst);
    }
    std::printf("\n");
}

Freedoms clamped(const Discretisation& plate, const VectorXd& q, const Vec3& mirror_sign) {
    Freedoms freedoms(q);
    const std::vector<int> twin = twins(plate.carriers);
    for (std::size_t i = 0; i < twin.size(); ++i)
        for (int c = 0; c < 3; ++c)
            if (std::abs(plate.carriers[i].x()) < 1e-12) freedoms.hold(int(3 * i + c), q[3 * i + c]);
    for (std::size_t i = 0; i < twin.size(); ++i)
        for (int c = 0; c < 3; ++c)
            if (twin[i] != int(i)) freedoms.tie(int(3 * i + c), 3 * twin[i] + c, mirror_sign[c]);
    freedoms.number();
    return freedoms;
}

// Tip of a heavy strip, w / L = 0.25, gamma = 10: H / W against the inextensible 1.06680232.
void cantilever(const Candidate& candidate, double compression) {
    const std::vector<Vec2> curve = elastica(10);
    for (double k : {1e3, 2e6})
        for (int n : {10, 20, 40}) {
            Worst worst;
            int iterations = 0, failed = 0;
            const auto start = std::chrono::steady_clock::now();
            for (int seed = 1; seed <= seeds; ++seed) {
                const FlatMesh mesh = with_mirror_image(jittered_rectangle(1, 0.25, 1.0 / n, 0.3, seed));
                Fabric fabric = plate_fabric(k, 1);
                fabric.compression = compression;
                const Discretisation plate = candidate.make(garment_of(mesh), fabric);
                const VectorXd q = placed(plate, [&](const Vec2& p) -> Vec3 {
                    const Vec2 at = curve[std::lround(std::abs(p.x()) * (int(curve.size()) - 1))];
                    return {p.x() < 0 ? -at.x() : at.x(), p.y(), -at.y()};
                });
                const StaticResult r =
                    solve_static({plate.stretch, plate.bend}, weight_load(plate, Vec3(0, 0, -10)),
                                 clamped(plate, q, Vec3(-1, 1, 1)), relax_extras(plate, q));
                double x = 0, z = 0;
                for (std::size_t i = 0; i < plate.carriers.size(); ++i)
                    if (plate.carriers[i].x() > 1 - 1e-9) x += r.q[3 * i], z -= r.q[3 * i + 2];
                worst.add(z / x / 1.066802320433086 - 1);
                iterations += r.iterations;
                failed += !r.converged;
            }
            std::printf("  k %.0e n %d:", k, n);
            print("", worst);
            std::printf(" (%d iterations, %.0f s%s)\n", iterations,
                        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
                        failed ? ", NOT ALL CONVERGED" : "");
            std::fflush(stdout);
        }
}

// Is the flat strip on edge stable under its own weight?
bool stands(const Discretisation& plate, double gamma, VectorXd& q) {
    Freedoms plane = clamped(plate, q, Vec3(-1, 1, 1));
    Freedoms all = plane;
    for (std::size_t i = 0; i < plate.carriers.size(); ++i)
        plane.hold(int(3 * i + 2), 0);
    for (int i = int(3 * plate.carriers.size()); i < plate.freedoms(); ++i)
        plane.hold(i, 0);
    plane.number();
    const StaticResult r =
        solve_static({plate.stretch, plate.bend}, weight_load(plate, Vec3(0, -gamma, 0)), plane, q);
    q = r.q;
    Entries entries;
    plate.stretch.add_hessian(q, HessianKind::exact, entries);
    plate.bend.add_hessian(q, HessianKind::exact, entries);
    return positive_definite(all.reduce(entries));
}

void lateral(const Candidate& candidate) {
    const double exact = 21.32550098856998;
    for (int n : {10, 20, 40}) {
        Worst worst;
        for (int seed = 1; seed <= seeds; ++seed) {
            const FlatMesh mesh = with_mirror_image(jittered_rectangle(1, 0.25, 1.0 / n, 0.3, seed));
            const Discretisation plate = candidate.make(garment_of(mesh), plate_fabric(2e6, 1));
            VectorXd q = placed(plate, [](const Vec2& p) { return Vec3(p.x(), p.y(), 0); });
            double low = 0.4 * exact, high = 2 * exact;
            for (int i = 0; i < 11; ++i) {
                const double middle = (low + high) / 2;
                (stands(plate, middle, q) ? low : high) = middle;
            }
            worst.add(low / exact - 1);
        }
        std::printf("  n %d:", n);
        print("", worst);
        std::fflush(stdout);
    }
    std::printf("\n");
}

void cost(const Candidate& candidate) {
    static const FlatMesh mesh = jittered_rectangle(0.94, 0.94, 0.01, 0.2, 1);
    const FactorCost c = factor_cost(candidate.make(garment_of(mesh), plate_fabric(2000, 1e-5)));
    std::printf("  %zu nodes: %d unknowns, %.1f M entries, %.3f s\n", mesh.points.size(), c.unknowns,
                c.entries / 1e6, c.seconds);
}

// The element that was kept, by the solver of drapes: how far a sheet that hangs by two corners moves when
// its membrane becomes a hundred times stiffer.
void hanging_sheet() {
    for (double edge : {0.02, 0.01})
        for (int seed = 1; seed <= 3; ++seed) {
            const auto start = std::chrono::steady_clock::now();
            const std::vector<HungSheet> hung = hang_sheet(edge, seed, {1e3, 1e4, 1e5});
            const HungSheet &soft = hung[0], &stiff = hung[2];
            std::printf("  %2.0f mm, mesh %d: drop %.1f mm, farthest %.1f mm (%.1f %%); sag %.2f, %.2f, %.2f "
                        "mm (%+.1f %%), "
                        "%d, %d, %d iterations, %.0f s%s\n",
                        1e3 * edge, seed, 1e3 * soft.drop, 1e3 * farthest(soft, stiff),
                        100 * farthest(soft, stiff) / soft.drop, 1e3 * soft.sag, 1e3 * hung[1].sag,
                        1e3 * stiff.sag, 100 * (stiff.sag / soft.sag - 1), soft.iterations,
                        hung[1].iterations, stiff.iterations,
                        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
                        soft.settled && hung[1].settled && stiff.settled ? "" : ", NOT ALL SETTLED");
            std::fflush(stdout);
        }
}

} // namespace

int main(int count, char** words) {
    for (const Candidate& candidate : candidates()) {
        const auto run = [&](const char* test, const std::function<void()>& body) {
            if (!asked(count, words, test)) return;
            std::printf("%s, %s\n", candidate.name.c_str(), test);
            body();
            std::fflush(stdout);
        };
        run("plate", [&] { supported_plate(candidate); });
        run("cylinder", [&] { rolled(candidate, false); });
        run("twist", [&] { rolled(candidate, true); });
        run("lateral", [&] { lateral(candidate); });
        run("cantilever", [&] { cantilever(candidate, 1); });
        run("cost", [&] { cost(candidate); });
    }
    if (asked(count, words, "sheet")) {
        std::printf("a sheet by two corners\n");
        hanging_sheet();
    }
}

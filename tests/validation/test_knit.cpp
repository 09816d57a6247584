// SPDX-License-Identifier: GPL-3.0-or-later
// A strip of a knit, pulled along its wales and along its courses, against the curves that the fabric was given.

#include "draping/energy/sheet.h"
#include "draping/energy/triangles.h"

#include "tests/support/energy_checks.h"
#include "tests/support/static_solver.h"

#include <catch2/catch.hpp>

#include <numbers>

using namespace toile;
using namespace toile::test;
using Eigen::VectorXd;

namespace {

Term term_of(std::shared_ptr<Energy> model) {
    const auto places = [](const VectorXd& q) {
        Points x(q.size() / 3);
        flat(x) = q;
        return x;
    };
    return {[=](const VectorXd& q) { return model->value(places(q)); },
            [=](const VectorXd& q, VectorXd& g) { model->add_gradient(places(q), g); },
            [=](const VectorXd& q, HessianKind kind, Entries& out) {
                BlockMatrix matrix = full_matrix(int(q.size() / 3));
                model->find_blocks(matrix);
                model->add_hessian(places(q), kind, matrix);
                const Eigen::MatrixXd h = dense(matrix.rows(), [&](const VectorXd& v, VectorXd& y) {
                    matrix.multiply(v, y);
                    model->add_left_out(places(q), v, y);
                });
                for (int i = 0; i < h.rows(); ++i)
                    for (int j = 0; j < h.cols(); ++j)
                        if (h(i, j) != 0) out.emplace_back(i, j, h(i, j));
            }};
}

struct Pulled {
    double tension = 0; ///< N per metre of flat width
    double width = 0;   ///< at the end, m
};

/// A strip of 200 by 50 mm, its ends pulled apart along x by `stretch` and free to become narrower.
Pulled pull_strip(const FlatMesh& mesh, const std::shared_ptr<Energy>& model, double stretch, double narrowed) {
    const double length = 0.2, width = 0.05;
    const int n = int(mesh.points.size());
    VectorXd q(3 * n);
    for (int i = 0; i < n; ++i)
        q.segment<3>(3 * i) << (1 + stretch) * mesh.points[i].x(), narrowed * mesh.points[i].y(), 0;
    Freedoms freedoms(q);
    for (int i = 0; i < n; ++i) {
        freedoms.hold(3 * i + 2, 0);
        if (std::abs(mesh.points[i].x() - length / 2) > length / 2 - 1e-9) freedoms.hold(3 * i, q[3 * i]);
    }
    freedoms.hold(1, q[1]);
    freedoms.number();
    StaticOptions options;
    options.tolerance = 1e-8;
    VectorXd load = VectorXd::Zero(3 * n);
    load[1] = 1; // on a node that is held: only sets the scale of the residual
    const Term term = term_of(model);
    const StaticResult r = solve_static({term}, load, freedoms, q, options);
    REQUIRE(r.converged);
    VectorXd g = VectorXd::Zero(3 * n);
    term.add_gradient(r.q, g);
    Pulled pulled;
    double low = 1, high = -1;
    for (int i = 0; i < n; ++i) {
        if (mesh.points[i].x() > length - 1e-9) pulled.tension += g[3 * i] / width;
        low = std::min(low, r.q[3 * i + 1]);
        high = std::max(high, r.q[3 * i + 1]);
    }
    pulled.width = high - low;
    return pulled;
}

} // namespace

TEST_CASE("a strip of a knit stretches by the curve of its fabric", "[validation]") {
    const FlatMesh mesh = jittered_rectangle(0.2, 0.05, 0.02, 0.25, 1);
    for (const char* name : {"jersey", "rib"})
        for (const bool warp : {true, false}) {
            const Fabric& f = fabric_preset(name);
            const Garment garment = garment_of(mesh, warp ? 0.5 * std::numbers::pi : 0);
            const StretchCurve curve = stretch_curve(warp ? f.curve_warp : f.curve_weft);
            // Contraction is by the coupling of the first slopes.
            const double ratio = warp ? f.poisson
                                      : f.poisson * membrane_curve(f.curve_weft).first_slope() /
                                            membrane_curve(f.curve_warp).first_slope();
            for (const double s : {0.05, 0.1, 0.2}) {
                INFO(name << (warp ? " along the warp, by " : " along the weft, by ") << s);
                const double narrowed = std::sqrt(1 - 2 * ratio * s * (1 + s / 2));
                const auto sheet = std::make_shared<SheetEnergy>(make_sheet(garment, {f}));
                const Pulled p = pull_strip(mesh, sheet, s, 1);
                CHECK(p.tension == Approx(evaluate(curve, s).tension).epsilon(0.01));
                CHECK(p.width == Approx(0.05 * narrowed).epsilon(1e-3));
                // Triangles have the curve itself, and no contraction.
                const auto triangles = std::make_shared<TriangleCloth>(garment, std::vector<Fabric>{f});
                CHECK(pull_strip(mesh, triangles, s, 0.99).tension == Approx(evaluate(curve, s).tension).epsilon(1e-4));
            }
        }
}

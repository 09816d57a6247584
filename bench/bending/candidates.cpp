// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/bending/candidates.h"

#include "draping/energy/hinge.h"

#include <Eigen/Dense>

#include <chrono>

namespace toile::bench {

namespace {

using Eigen::VectorXd;
using test::Entries;
using test::Term;

// An energy 1/2 D |sum_a stencil_a x_a|^2, with a scalar stencil.
struct Square {
    std::vector<int> at;
    VectorXd stencil;
    double weight;
};

Term squares_term(const std::vector<Square>& squares) {
    const auto image = [](const Square& s, const VectorXd& q) {
        Vec3 v = Vec3::Zero();
        for (std::size_t a = 0; a < s.at.size(); ++a)
            v += s.stencil[a] * q.segment<3>(3 * s.at[a]);
        return v;
    };
    return {[=](const VectorXd& q) {
                double sum = 0;
                for (const Square& s : squares)
                    sum += 0.5 * s.weight * image(s, q).squaredNorm();
                return sum;
            },
            [=](const VectorXd& q, VectorXd& g) {
                for (const Square& s : squares) {
                    const Vec3 force = s.weight * image(s, q);
                    for (std::size_t a = 0; a < s.at.size(); ++a)
                        g.segment<3>(3 * s.at[a]) += s.stencil[a] * force;
                }
            },
            [=](const VectorXd&, HessianKind, Entries& entries) {
                for (const Square& s : squares)
                    for (std::size_t a = 0; a < s.at.size(); ++a)
                        for (std::size_t b = 0; b < s.at.size(); ++b)
                            for (int i = 0; i < 3; ++i)
                                entries.emplace_back(3 * s.at[a] + i, 3 * s.at[b] + i,
                                                     s.weight * s.stencil[a] * s.stencil[b]);
            }};
}

double hinge_area(const Garment& garment, const Hinge& hinge) {
    return rest_area(garment.rest.edges[hinge.triangles[0]]) + rest_area(garment.rest.edges[hinge.triangles[1]]);
}

HingeAngle angle_of(const std::array<int, 4>& nodes, const VectorXd& q) {
    std::array<Vec3, 4> x;
    for (int i = 0; i < 4; ++i) x[i] = q.segment<3>(3 * nodes[i]);
    return hinge_angle(x);
}

Term hinge_term(const Garment& garment, double d) {
    const std::vector<Hinge> hinges = hinges_of(garment);
    std::vector<double> weight;
    for (const Hinge& h : hinges)
        weight.push_back(d * (garment.uv[h.nodes[1]] - garment.uv[h.nodes[0]]).squaredNorm() /
                         hinge_area(garment, h));
    return {[=](const VectorXd& q) {
                double sum = 0;
                for (std::size_t i = 0; i < hinges.size(); ++i)
                    sum += 0.5 * weight[i] * std::pow(angle_of(hinges[i].nodes, q).value, 2);
                return sum;
            },
            [=](const VectorXd& q, VectorXd& g) {
                for (std::size_t i = 0; i < hinges.size(); ++i) {
                    const HingeAngle angle = angle_of(hinges[i].nodes, q);
                    for (int a = 0; a < 4; ++a)
                        g.segment<3>(3 * hinges[i].nodes[a]) += weight[i] * angle.value * angle.gradient[a];
                }
            },
            [=](const VectorXd& q, HessianKind, Entries& entries) { // Gauss-Newton; exact where flat
                for (std::size_t i = 0; i < hinges.size(); ++i) {
                    const HingeAngle angle = angle_of(hinges[i].nodes, q);
                    for (int a = 0; a < 12; ++a)
                        for (int b = 0; b < 12; ++b)
                            entries.emplace_back(
                                3 * hinges[i].nodes[a / 3] + a % 3, 3 * hinges[i].nodes[b / 3] + b % 3,
                                weight[i] * angle.gradient[a / 3][a % 3] * angle.gradient[b / 3][b % 3]);
                }
            }};
}

// Mid-edge normals (Grinspun, Gingold, Reisman and Zorin 2006): one angle per inner edge, by which the
// mid-edge normal leaves the mean of its triangles' normals; free at borders, where it takes the value of
// least energy.
struct MidEdge {
    std::vector<Hinge> hinge_of_edge; ///< edge < 0: border
    struct Side {
        int edge;
        double sign; ///< of the edge's own angle, seen from this triangle
        Vec3 turn;   ///< curvature (xx, yy, sqrt2 xy) times root of D A per angle
    };
    std::vector<std::array<Side, 3>> triangles;
};

struct MidEdgeResidual {
    Vec3 value = Vec3::Zero();
    std::vector<std::pair<int, Vec3>> derivative; ///< freedom, column
};

MidEdgeResidual residual_of(const MidEdge& m, int t, const VectorXd& q, int first_extra) {
    MidEdgeResidual r;
    for (const auto& side : m.triangles[t]) {
        const Hinge& hinge = m.hinge_of_edge[side.edge];
        double turn = side.sign * q[first_extra + side.edge];
        r.derivative.emplace_back(first_extra + side.edge, side.sign * side.turn);
        if (hinge.edge >= 0) {
            const HingeAngle angle = angle_of(hinge.nodes, q);
            turn += angle.value / 2;
            for (int a = 0; a < 4; ++a)
                for (int i = 0; i < 3; ++i)
                    r.derivative.emplace_back(3 * hinge.nodes[a] + i, angle.gradient[a][i] / 2 * side.turn);
        }
        r.value += turn * side.turn;
    }
    return r;
}

Term mid_edge_term(const Garment& garment, double d) {
    MidEdge m;
    m.hinge_of_edge.resize(garment.edges.size(), Hinge{-1, {}, {}});
    for (const Hinge& h : hinges_of(garment))
        m.hinge_of_edge[h.edge] = h;
    for (int t = 0; t < int(garment.triangles.size()); ++t) {
        std::array<MidEdge::Side, 3> sides;
        for (int k = 0; k < 3; ++k) {
            const Vec2 a = garment.uv[garment.triangles[t][(k + 1) % 3]],
                       b = garment.uv[garment.triangles[t][(k + 2) % 3]];
            const Vec2 n = Vec2((b - a).y(), -(b - a).x()).normalized();
            const double scale = (b - a).norm() / rest_area(garment.rest.edges[t]) * std::sqrt(d * rest_area(garment.rest.edges[t]));
            const int e = garment.edges.of_triangle[t][k];
            const bool first = garment.edges.incident[garment.edges.first[e]] == t;
            sides[k] = {e, first ? 1.0 : -1.0,
                        scale * Vec3(n.x() * n.x(), n.y() * n.y(), std::sqrt(2) * n.x() * n.y())};
        }
        m.triangles.push_back(sides);
    }
    const int first = 3 * garment.node_count;
    return {[=](const VectorXd& q) {
                double sum = 0;
                for (int t = 0; t < int(m.triangles.size()); ++t)
                    sum += 0.5 * residual_of(m, t, q, first).value.squaredNorm();
                return sum;
            },
            [=](const VectorXd& q, VectorXd& g) {
                for (int t = 0; t < int(m.triangles.size()); ++t) {
                    const MidEdgeResidual r = residual_of(m, t, q, first);
                    for (const auto& [i, column] : r.derivative)
                        g[i] += column.dot(r.value);
                }
            },
            [=](const VectorXd& q, HessianKind, Entries& entries) { // Gauss-Newton; exact where flat
                for (int t = 0; t < int(m.triangles.size()); ++t) {
                    const MidEdgeResidual r = residual_of(m, t, q, first);
                    for (const auto& [i, a] : r.derivative)
                        for (const auto& [j, b] : r.derivative)
                            entries.emplace_back(i, j, a.dot(b));
                }
            }};
}

// The curvature of every triangle's own quadratic, neighbours not consulted.
Term fit_term(const Garment& garment, double d) {
    std::vector<Square> squares;
    const std::vector<Patch> patches = make_patches(garment);
    for (int t = 0; t < int(patches.size()); ++t) {
        const Patch& p = patches[t];
        const Eigen::MatrixXd rows = curvature_of_edges(garment.rest.edges[t]) * p.curve.leftCols(p.count);
        for (int i = 0; i < 3; ++i)
            squares.push_back({{p.nodes.begin(), p.nodes.begin() + p.count},
                               rows.row(i),
                               (i == 2 ? 2 : 1) * d * rest_area(garment.rest.edges[t])});
    }
    return squares_term(squares);
}

std::vector<double> thirds(const Garment& garment, const std::function<int(int t, int k)>& carrier,
                           int count) {
    std::vector<double> areas(count, 0);
    for (int t = 0; t < int(garment.triangles.size()); ++t)
        for (int k = 0; k < 3; ++k)
            areas[carrier(t, k)] += rest_area(garment.rest.edges[t]) / 3;
    return areas;
}

Discretisation on_nodes(const Garment& garment, const Fabric& fabric, bool arcs, const Term& bend,
                        int extras = 0) {
    Discretisation plate;
    plate.carriers = garment.uv;
    plate.areas = thirds(
        garment, [&](int t, int k) { return garment.triangles[t][k]; }, garment.node_count);
    plate.extras = extras;
    plate.stretch = test::stretch_term(make_stretch(garment, {fabric}, {arcs}), garment.node_count);
    plate.bend = bend;
    return plate;
}

// Nonconforming (English and Bridson 2008): freedoms at edge middles, affine on each triangle. Bending by the
// jump of the map's gradient over the edge, weighted like the hinge.
Discretisation crouzeix_raviart(const Garment& garment, const Fabric& fabric) {
    const int edges = garment.edges.size();
    Discretisation plate;
    for (const auto& e : garment.edges.ends)
        plate.carriers.push_back((garment.uv[e[0]] + garment.uv[e[1]]) / 2);
    plate.areas = thirds(
        garment, [&](int t, int k) { return garment.edges.of_triangle[t][k]; }, edges);

    // The triangle of the three middles undergoes the same affine map.
    Garment middles;
    middles.node_count = edges;
    middles.uv = plate.carriers;
    for (int e = 0; e < edges; ++e)
        middles.node_of_vertex.push_back(e);
    middles.panel_of_triangle.assign(garment.triangles.size(), 0);
    for (const auto& e : garment.edges.of_triangle) {
        middles.triangles.push_back({e[0], e[1], e[2]});
        Mat2 rest;
        rest << middles.uv[e[1]] - middles.uv[e[0]], middles.uv[e[2]] - middles.uv[e[0]];
        middles.rest.edges.push_back(rest);
    }
    std::vector<StretchElement> elements = make_stretch(middles, {fabric}, {false});
    for (StretchElement& e : elements)
        e.area *= 4;
    plate.stretch = test::stretch_term(elements, edges);

    std::vector<Square> squares;
    for (const Hinge& h : hinges_of(garment)) {
        std::vector<int> at;
        Eigen::Matrix2Xd jump(2, 6); // gradient of the map, first triangle minus second
        for (int side = 0; side < 2; ++side) {
            const int t = h.triangles[side];
            const Mat2 inverse = garment.rest.edges[t].inverse();
            Eigen::Matrix<double, 2, 3> gradient; // of the barycentric coordinates
            gradient << -(inverse.row(0) + inverse.row(1)).transpose(), inverse.row(0).transpose(),
                inverse.row(1).transpose();
            for (int k = 0; k < 3; ++k)
                at.push_back(garment.edges.of_triangle[t][k]);
            jump.middleCols<3>(3 * side) = (side == 0 ? -2 : 2) * gradient;
        }
        const double length = (garment.uv[h.nodes[1]] - garment.uv[h.nodes[0]]).squaredNorm();
        for (int i = 0; i < 2; ++i)
            squares.push_back({at, jump.row(i), fabric.bend_warp * length / hinge_area(garment, h)});
    }
    plate.bend = squares_term(squares);
    return plate;
}

} // namespace

std::vector<Candidate> candidates() {
    const auto patch = [](bool arcs) {
        return [arcs](const Garment& g, const Fabric& f) {
            return on_nodes(g, f, arcs, test::bend_term(make_bending(g, {f}), g.node_count));
        };
    };
    return {
        {"shared slopes, arcs", patch(true)},
        {"shared slopes, chords", patch(false)},
        {"fit per triangle, arcs",
         [](const Garment& g, const Fabric& f) { return on_nodes(g, f, true, fit_term(g, f.bend_warp)); }},
        {"hinge",
         [](const Garment& g, const Fabric& f) { return on_nodes(g, f, false, hinge_term(g, f.bend_warp)); }},
        {"mid-edge normals",
         [](const Garment& g, const Fabric& f) {
             return on_nodes(g, f, false, mid_edge_term(g, f.bend_warp), g.edges.size());
         }},
        {"Crouzeix-Raviart", crouzeix_raviart},
    };
}

FactorCost factor_cost(const Discretisation& plate) {
    VectorXd q = VectorXd::Zero(plate.freedoms());
    for (std::size_t i = 0; i < plate.carriers.size(); ++i)
        q.segment<2>(3 * i) = plate.carriers[i];
    Entries entries;
    plate.stretch.add_hessian(q, HessianKind::projected, entries);
    plate.bend.add_hessian(q, HessianKind::projected, entries);
    Eigen::SparseMatrix<double> h(q.size(), q.size());
    h.setFromTriplets(entries.begin(), entries.end());
    Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<double>> solver;
    solver.cholmod().nmethods = 1;
    solver.cholmod().method[0].ordering = CHOLMOD_METIS;
    solver.setShift(1e-3 * h.diagonal().mean());
    solver.analyzePattern(h);
    FactorCost cost;
    cost.unknowns = int(q.size());
    cost.entries = solver.cholmod().lnz;
    cost.seconds = 1e9;
    for (int run = 0; run < 3; ++run) {
        const auto start = std::chrono::steady_clock::now();
        solver.factorize(h);
        cost.seconds = std::min(
            cost.seconds, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return cost;
}

} // namespace toile::bench

// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/stretch.h"

#include "geometry/parallel.h"
#include "geometry/text.h"

#include <Eigen/Dense>

#include <stdexcept>

namespace toile {

namespace {

constexpr int chunk = 256;

// What an arc adds to its chord's strain tends to this. It leaves bends that the mesh resolves alone, and keeps
// the chords of those it does not (a radius of an edge's length) from passing for cloth twice as long.
constexpr double most_arc = 0.005;

// Edge k runs from corner k + 1 to corner k + 2.
int edge_start(int k) {
    return (k + 1) % 3;
}
int edge_end(int k) {
    return (k + 2) % 3;
}

/// What all triangles of a fabric share.
struct Resistance {
    double weft = 0, warp = 0; ///< N/m; of curves, the first slopes
    Mat3 full;
    std::shared_ptr<const MembraneCurves> curves;
};

Mat3 moduli(const Fabric& f, double weft, double warp) {
    const double minor = f.poisson * weft / warp;
    const double scale = 1 / (1 - f.poisson * minor);
    if (!(warp > 0 && weft > 0 && f.shear > 0 && f.poisson >= 0 && scale > 0))
        throw std::invalid_argument(
            "fabric \"" + f.name +
            "\": stretch_warp, stretch_weft and shear must be positive and poisson between 0 "
            "and the root of stretch_warp / stretch_weft");
    Mat3 c = Mat3::Zero();
    c(0, 0) = scale * weft;
    c(1, 1) = scale * warp;
    c(0, 1) = c(1, 0) = scale * f.poisson * weft;
    c(2, 2) = f.shear;
    return c;
}

void refuse_softening(const Fabric& f, const Resistance& r) {
    const auto lost = [](const StretchCurve& curve) { return curve.empty() ? 0.0 : curve.first_slope() - least_slope(curve); };
    const double weft = r.full(0, 0) - lost(r.curves->weft), warp = r.full(1, 1) - lost(r.curves->warp);
    if (weft > 0 && warp > 0 && weft * warp > r.full(0, 1) * r.full(0, 1)) return;
    throw std::invalid_argument("fabric \"" + f.name + "\": its stretch curves become too flat for a Poisson ratio of " +
                                text("%.3g: expected the product of their least slopes to stay above about %.2g of that of "
                                     "their first",
                                     f.poisson, f.poisson * f.poisson * r.weft / r.warp));
}

Resistance resistance_of(const Fabric& f) {
    Resistance r{f.stretch_weft, f.stretch_warp, Mat3::Zero(), nullptr};
    if (!f.curve_weft.empty() || !f.curve_warp.empty()) {
        const MembraneCurves curves{membrane_curve(f.curve_weft), membrane_curve(f.curve_warp)};
        if (!curves.weft.empty()) r.weft = curves.weft.first_slope();
        if (!curves.warp.empty()) r.warp = curves.warp.first_slope();
        r.curves = std::make_shared<const MembraneCurves>(curves);
    }
    r.full = moduli(f, r.weft, r.warp);
    if (r.curves) refuse_softening(f, r);
    return r;
}

StretchElement make_element(const Mat2& rest, const Resistance& resistance, double compression, const Patch& patch) {
    StretchElement element;
    element.patch = patch;
    element.area = rest_area(rest);
    const std::array<Vec2, 3> corner{Vec2(0, 0), Vec2(rest.col(0)), Vec2(rest.col(1))};
    Mat3 squares;
    for (int k = 0; k < 3; ++k) {
        const Vec2 e = corner[edge_end(k)] - corner[edge_start(k)];
        element.length_squared[k] = e.squaredNorm();
        squares.row(k) << e.x() * e.x(), e.y() * e.y(), e.x() * e.y();
    }
    element.to_strain = squares.inverse();
    element.full = resistance.full;
    element.weft = resistance.weft;
    element.warp = resistance.warp;
    element.compression = compression;
    element.curves = resistance.curves;
    return element;
}

// Where the element is: edges, their turning, and what follows from their lengths.
struct Shape {
    std::array<Vec3, 3> edge, turning;
    std::array<double, 3> arc_slope, arc_bend; ///< derivatives of what an arc adds, by |q|^2 / 24
    Vec3 strain;
};

Shape shape_of(const StretchElement& element, const Points& x) {
    const Patch& patch = element.patch;
    Shape shape;
    Vec3 g;
    for (int k = 0; k < 3; ++k) {
        shape.edge[k] = x[patch.nodes[edge_end(k)]] - x[patch.nodes[edge_start(k)]];
        shape.turning[k].setZero();
    }
    const Vec3& origin = x[patch.nodes[0]];
    for (int a = 1; a < patch.count; ++a) {
        const Vec3 to = x[patch.nodes[a]] - origin;
        for (int k = 0; k < 3; ++k)
            shape.turning[k] += patch.curve(k, a) * to;
    }
    for (int k = 0; k < 3; ++k) {
        const double arc = shape.turning[k].squaredNorm() / 24, most = most_arc * element.length_squared[k];
        const double rest = most / (most + arc);
        g[k] = 0.5 * (shape.edge[k].squaredNorm() - element.length_squared[k]) + arc * rest;
        shape.arc_slope[k] = rest * rest;
        shape.arc_bend[k] = -2 * rest * rest * rest / most;
    }
    shape.strain = element.to_strain * g;
    return shape;
}

// Derivative of g_k by the position of patch node a.
Vec3 length_gradient(const StretchElement& element, const Shape& shape, int k, int a) {
    Vec3 gradient = shape.arc_slope[k] * element.patch.curve(k, a) / 12 * shape.turning[k];
    if (a == edge_end(k)) gradient += shape.edge[k];
    if (a == edge_start(k)) gradient -= shape.edge[k];
    return gradient;
}

// The stress with its compressive principal part taken off.
Vec3 tensile(const Vec3& stress) {
    Mat2 s;
    s << stress[0], stress[2], stress[2], stress[1];
    const double mean = s.trace() / 2, radius = std::hypot((s(0, 0) - s(1, 1)) / 2, s(0, 1));
    if (mean - radius >= 0) return stress;
    if (mean + radius <= 0) return Vec3::Zero();
    // Only the larger principal value, mean + radius, stays: times the projector on its direction.
    const Mat2 kept = (mean + radius) / (2 * radius) * (s - (mean - radius) * Mat2::Identity());
    return {kept(0, 0), kept(1, 1), kept(0, 1)};
}

// What a measured curve has more than the straight line of its first slope; nothing under compression.
CurveState beyond_line(const StretchCurve& curve, double strain) {
    if (curve.empty() || strain <= 0) return {};
    CurveState at = evaluate(curve, strain);
    const double k = curve.first_slope();
    at.energy -= 0.5 * k * strain * strain;
    at.tension -= k * strain;
    at.slope -= k;
    return at;
}

} // namespace

StretchResponse stretch_response(const StretchElement& element, const Vec3& strain) {
    const double share = element.compression;
    StretchResponse full{0, element.full * strain, element.full};
    StretchResponse slack{0, Vec3::Zero(), Mat3::Zero()};
    full.energy = 0.5 * strain.dot(full.stress);
    CurveState more[2];
    if (element.curves) {
        more[0] = beyond_line(element.curves->weft, strain[0]);
        more[1] = beyond_line(element.curves->warp, strain[1]);
        for (int c = 0; c < 2; ++c) {
            full.energy += more[c].energy;
            full.stress[c] += more[c].tension;
            full.tangent(c, c) += more[c].slope;
        }
    }
    if (full.stress[0] >= 0 && full.stress[1] >= 0) return full;
    const bool weft = full.stress[1] < 0 && strain[0] > 0, warp = full.stress[0] < 0 && strain[1] > 0;
    if (weft) slack.tangent(0, 0) = element.weft;
    if (warp) slack.tangent(1, 1) = element.warp;
    slack.tangent(2, 2) = element.full(2, 2);
    slack.stress = slack.tangent * strain;
    slack.energy = 0.5 * strain.dot(slack.stress);
    if (element.curves)
        for (int c = 0; c < 2; ++c) {
            if (!(c == 0 ? weft : warp)) continue;
            slack.energy += more[c].energy;
            slack.stress[c] += more[c].tension;
            slack.tangent(c, c) += more[c].slope;
        }
    return {(1 - share) * slack.energy + share * full.energy, (1 - share) * slack.stress + share * full.stress,
            (1 - share) * slack.tangent + share * full.tangent};
}

void check_membrane(const Fabric& fabric) {
    resistance_of(fabric);
}

std::vector<StretchElement> make_stretch(const Garment& garment, const std::vector<Fabric>& fabrics,
                                         const StretchOptions& options) {
    std::vector<Patch> patches;
    if (options.arc_edges) patches = make_patches(garment);
    std::vector<Resistance> resistances;
    for (const Fabric& fabric : fabrics) resistances.push_back(resistance_of(fabric));
    std::vector<StretchElement> elements;
    for (int t = 0; t < int(garment.triangles.size()); ++t) {
        Patch patch;
        if (options.arc_edges) {
            patch = patches[t];
        } else {
            const Triangle nodes = garment.nodes(t);
            patch.count = 3;
            std::copy(nodes.begin(), nodes.end(), patch.nodes.begin());
            patch.curve.setZero();
        }
        const int panel = garment.panel_of_triangle[t];
        elements.push_back(make_element(garment.rest.edges[t], resistances[panel], fabrics[panel].compression, patch));
    }
    return elements;
}

Vec3 stretch_strain(const StretchElement& element, const Points& x) {
    return shape_of(element, x).strain;
}

double stretch_value(const StretchElement& element, const Points& x) {
    return element.area * stretch_response(element, stretch_strain(element, x)).energy;
}

namespace {

void gradient_with(const StretchElement& element, const Shape& shape, const Vec3& stress,
                   std::array<Vec3, Patch::max_nodes>& gradient) {
    const Vec3 force = element.area * element.to_strain.transpose() * stress;
    for (int a = 0; a < element.patch.count; ++a) {
        gradient[a].setZero();
        for (int k = 0; k < 3; ++k)
            gradient[a] += shape.arc_slope[k] * element.patch.curve(k, a) * force[k] / 12 * shape.turning[k];
    }
    for (int k = 0; k < 3; ++k) {
        gradient[edge_end(k)] += force[k] * shape.edge[k];
        gradient[edge_start(k)] -= force[k] * shape.edge[k];
    }
}

} // namespace

void stretch_gradient(const StretchElement& element, const Points& x,
                      std::array<Vec3, Patch::max_nodes>& gradient) {
    const Shape shape = shape_of(element, x);
    gradient_with(element, shape, stretch_response(element, shape.strain).stress, gradient);
}

void stretch_gradient(const StretchElement& element, const Vec3& stress, const Points& x,
                      std::array<Vec3, Patch::max_nodes>& gradient) {
    gradient_with(element, shape_of(element, x), stress, gradient);
}

StretchCurvature stretch_curvature(const StretchElement& element, const Points& x, HessianKind kind) {
    const Shape shape = shape_of(element, x);
    const StretchResponse response = stretch_response(element, shape.strain);
    const bool project = kind == HessianKind::projected;
    const auto forces = [&](const Vec3& stress) {
        return Vec3(element.area * element.to_strain.transpose() * stress);
    };
    StretchCurvature h;
    h.patch = &element.patch;
    h.count = element.patch.count;
    const auto& curve = element.patch.curve;

    // What multiplies the identity: arcs by their curve rows, chords by corner.
    const Vec3 force = forces(response.stress);
    Vec3 arc = force.cwiseProduct(Vec3(shape.arc_slope[0], shape.arc_slope[1], shape.arc_slope[2])) / 12;
    if (project) arc = arc.cwiseMax(0);
    for (int a = 0; a < h.count; ++a)
        for (int b = 0; b <= a; ++b)
            h.identity(a, b) = arc[0] * curve(0, a) * curve(0, b) + arc[1] * curve(1, a) * curve(1, b) +
                               arc[2] * curve(2, a) * curve(2, b);
    const Vec3 chord = project ? forces(tensile(response.stress)) : force;
    for (int k = 0; k < 3; ++k) {
        const int a = edge_start(k), b = edge_end(k);
        h.identity(a, a) += chord[k];
        h.identity(b, b) += chord[k];
        h.identity(std::max(a, b), std::min(a, b)) -= chord[k];
    }

    // Derivatives of the three lengths by node, and with them the products tangent x derivative; the bending of
    // what arcs add is one more term in the turning of each edge.
    const Mat3 tangent = element.area * element.to_strain.transpose() * response.tangent * element.to_strain;
    h.turning = shape.turning;
    for (int k = 0; k < 3; ++k) {
        h.bend[k] = force[k] * shape.arc_bend[k] / 144;
        if (project) h.bend[k] = std::max(h.bend[k], 0.0);
    }
    for (int a = 0; a < h.count; ++a) {
        for (int k = 0; k < 3; ++k) h.length[a].col(k) = length_gradient(element, shape, k, a);
        h.pull[a] = h.length[a] * tangent;
    }
    return h;
}

void stretch_hessian(const StretchElement& element, const Points& x, HessianKind kind,
                     StretchHessian& hessian) {
    const StretchCurvature curvature = stretch_curvature(element, x, kind);
    hessian.resize(3 * curvature.count, 3 * curvature.count);
    for (int a = 0; a < curvature.count; ++a)
        for (int b = 0; b <= a; ++b) {
            const Mat3 block = curvature.block(a, b);
            hessian.block<3, 3>(3 * a, 3 * b) = block;
            hessian.block<3, 3>(3 * b, 3 * a) = block.transpose();
        }
}

double stretch_value(const std::vector<StretchElement>& elements, const Points& x) {
    return parallel_sum(int(elements.size()), chunk, [&](int begin, int end) {
        double sum = 0;
        for (int t = begin; t < end; ++t)
            sum += stretch_value(elements[t], x);
        return sum;
    });
}

void stretch_gradient(const std::vector<StretchElement>& elements, const Points& x, Points& gradient) {
    std::vector<std::array<Vec3, Patch::max_nodes>> parts(elements.size());
    parallel_for(int(elements.size()), chunk, [&](int begin, int end) {
        for (int t = begin; t < end; ++t)
            stretch_gradient(elements[t], x, parts[t]);
    });
    for (std::size_t t = 0; t < elements.size(); ++t)
        for (int a = 0; a < elements[t].patch.count; ++a)
            gradient[elements[t].patch.nodes[a]] += parts[t][a];
}

} // namespace toile

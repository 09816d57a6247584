// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/rest_curvature.h"

#include "geometry/parallel.h"

#include <Eigen/Dense>

namespace toile {

namespace {

constexpr int chunk = 256;

// The triangle's unit normal n, the gradients of its barycentric coordinates, and sum = sum_a weights_a x_a. As a corner i
// moves, dn = -gradient_i (n . dx_i) and dgradient_j = -(gradient_j . dx_i) gradient_i + (gradient_i . gradient_j) (n . dx_i) n.
struct Frame {
    Vec3 normal = Vec3::Zero(), sum = Vec3::Zero();
    std::array<Vec3, 3> gradient{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};

    /// The energy's gradient by node a is this times the normal.
    double along(const RestCurvature& c, int a) const { return (a < 3 ? sum.dot(gradient[a]) : 0) - c.weights[a]; }
};

Frame frame_of(const RestCurvature& c, const Points& x) {
    Frame f;
    const Vec3& origin = x[c.nodes[0]];
    for (std::size_t a = 1; a < c.nodes.size(); ++a) f.sum += c.weights[a] * (x[c.nodes[a]] - origin);
    const Vec3 e1 = x[c.nodes[1]] - origin, e2 = x[c.nodes[2]] - origin, across = e1.cross(e2);
    const double twice_area = across.norm();
    if (twice_area == 0) return f;
    f.normal = across / twice_area;
    f.gradient[1] = e2.cross(f.normal) / twice_area;
    f.gradient[2] = f.normal.cross(e1) / twice_area;
    f.gradient[0] = -f.gradient[1] - f.gradient[2];
    return f;
}

std::vector<Frame> frames_of(const std::vector<RestCurvature>& curved, const Points& x) {
    std::vector<Frame> frames(curved.size());
    parallel_for(int(curved.size()), chunk, [&](int begin, int end) {
        for (int t = begin; t < end; ++t) frames[t] = frame_of(curved[t], x);
    });
    return frames;
}

void add_product(const RestCurvature& c, const Frame& f, const Eigen::VectorXd& v, Eigen::VectorXd& product) {
    const auto at = [&](std::size_t a) { return 3 * Eigen::Index(c.nodes[a]); };
    Vec3 turn = Vec3::Zero(), drift = Vec3::Zero(); // -dn, and the sum of what multiplies n times v
    for (int i = 0; i < 3; ++i) turn += f.normal.dot(v.segment<3>(at(i))) * f.gradient[i];
    for (std::size_t a = 0; a < c.nodes.size(); ++a) drift += f.along(c, int(a)) * v.segment<3>(at(a));
    for (std::size_t a = 0; a < c.nodes.size(); ++a) product.segment<3>(at(a)) -= f.along(c, int(a)) * turn;
    const Vec3 slope = f.sum.dot(f.normal) * turn - drift;
    for (int i = 0; i < 3; ++i) product.segment<3>(at(i)) += f.gradient[i].dot(slope) * f.normal;
}

} // namespace

std::vector<RestCurvature> make_rest_curvature(const Garment& garment, const std::vector<Fabric>& fabrics) {
    std::vector<RestCurvature> curved;
    if (garment.rest.curvature.empty()) return curved;
    const std::vector<BendRows> rows = bend_rows(garment);
    for (std::size_t t = 0; t < rows.size(); ++t) {
        const Vec3 k = garment.rest.curvature[t].col(2);
        const Vec3 moment = rest_area(garment.rest.edges[t]) * bend_moduli(fabrics[garment.panel_of_triangle[t]]) * k;
        const Eigen::VectorXd weights = rows[t].rows.transpose() * moment;
        curved.push_back({rows[t].nodes, {weights.begin(), weights.end()}, 0.5 * k.dot(moment)});
    }
    return curved;
}

double value(const std::vector<RestCurvature>& curved, const Points& x) {
    return parallel_sum(int(curved.size()), chunk, [&](int begin, int end) {
        double sum = 0;
        for (int t = begin; t < end; ++t) {
            const Frame f = frame_of(curved[t], x);
            sum += curved[t].most - f.normal.dot(f.sum);
        }
        return sum;
    });
}

void add_gradient(const std::vector<RestCurvature>& curved, const Points& x, Eigen::VectorXd& g) {
    const std::vector<Frame> frames = frames_of(curved, x);
    for (std::size_t t = 0; t < curved.size(); ++t)
        for (std::size_t a = 0; a < curved[t].nodes.size(); ++a)
            g.segment<3>(3 * Eigen::Index(curved[t].nodes[a])) += frames[t].along(curved[t], int(a)) * frames[t].normal;
}

void add_product(const std::vector<RestCurvature>& curved, const Points& x, const Eigen::VectorXd& v,
                 Eigen::VectorXd& product) {
    const std::vector<Frame> frames = frames_of(curved, x);
    for (std::size_t t = 0; t < curved.size(); ++t) add_product(curved[t], frames[t], v, product);
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/rest/nearest.h"

#include "draping/algebra/cholesky.h"
#include "geometry/random.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace toile {

namespace {

using Eigen::VectorXd;

constexpr double least_damping = 1e-10; // shares of the largest entry of the diagonal: rigid motions cost nothing
constexpr double first_damping = 1e-4;
constexpr double exact_below = 1e-3;    // of the gradient, from where on the second derivative is exact
constexpr int shaken_starts = 6;        // of each start and its mirror image
constexpr double shake = 0.5;           // of an edge, across the surface
constexpr double off_saddle = 1e-3;
constexpr int most_saddles = 5;
constexpr double same_energy = 1e-6;    // two shapes are one when they differ by less than this share,
constexpr double same_angle = 1e-3;     // and in all angles by less, rad
constexpr double mirror_angle = 0.2;    // rad; what is prescribed need not have a mirror image

double weight_of(const Prescribed& data) {
    return std::accumulate(data.length_weight.begin(), data.length_weight.end(), 0.0) +
           std::accumulate(data.angle_weight.begin(), data.angle_weight.end(), 0.0);
}

double mean_length(const Prescribed& data) {
    return std::accumulate(data.length.begin(), data.length.end(), 0.0) / double(data.length.size());
}

class Descent {
public:
    Descent(const Prescribed& data, const Points& start)
        : data_(data), energy_(data), x(start) {
        std::vector<std::pair<int, int>> pairs;
        energy_.couplings(pairs);
        matrix_ = BlockMatrix(int(x.size()), pairs);
        factor_.analyse(matrix_);
        arrive();
    }

    double gradient() const { return gradient_measure(data_, g_); }
    double energy() const { return e_; }

    /// Whether the second derivative is positive but for rigid motions.
    bool at_minimum() {
        assemble(HessianKind::exact);
        matrix_.add_to_diagonal(VectorXd::Constant(g_.size(), 1e-7 * diagonal_));
        return factor_.factorise(matrix_);
    }

    /// One step; false when no step goes down.
    bool step() {
        for (int tries = 0; tries < 40; ++tries) {
            const HessianKind kind = exact_ ? HessianKind::exact : HessianKind::projected;
            assemble(kind);
            matrix_.add_to_diagonal(VectorXd::Constant(g_.size(), damping_ * diagonal_));
            if (factor_.factorise(matrix_)) {
                VectorXd d;
                factor_.solve(-g_, d);
                Points trial = x;
                flat(trial) += d;
                const double gain = e_ - energy_.value(trial);
                const double promised = -g_.dot(d) / 2;
                const double noise = 1e-14 * std::abs(e_);
                if (gain > 1e-4 * promised || (promised < noise && gain >= -noise)) {
                    x = std::move(trial);
                    arrive();
                    if (gain > 0.7 * promised) damping_ = std::max(least_damping, damping_ / 5);
                    exact_ = gradient() < exact_below;
                    return true;
                }
            }
            damping_ *= 4;
            if (damping_ > 1e8) return false;
        }
        return false;
    }

private:
    void arrive() {
        e_ = energy_.value(x);
        g_.setZero(3 * Eigen::Index(x.size()));
        energy_.add_gradient(x, g_);
    }
    void assemble(HessianKind kind) {
        matrix_.set_zero();
        energy_.add_hessian(x, kind, matrix_);
        diagonal_ = 0;
        for (int k = 0; k < matrix_.rows(); ++k)
            diagonal_ = std::max(diagonal_, matrix_.values()[matrix_.scalar_columns()[k]]);
    }

    const Prescribed& data_;
    PrescribedEnergy energy_;
    BlockMatrix matrix_;
    Cholesky factor_;
    VectorXd g_;
    double e_ = 0, diagonal_ = 0, damping_ = first_damping;
    bool exact_ = false;

public:
    Points x;
};

/// The direction in which a set of points is thinnest.
Vec3 normal_of(const Points& x) {
    Vec3 mean = Vec3::Zero();
    for (const Vec3& p : x) mean += p / double(x.size());
    Mat3 spread = Mat3::Zero();
    for (const Vec3& p : x) spread += (p - mean) * (p - mean).transpose();
    return Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors().col(0);
}

Points mirrored(Points x, const Vec3& normal) {
    for (Vec3& p : x) p -= 2 * p.dot(normal) * normal;
    return x;
}

bool alike(const std::vector<double>& a, const std::vector<double>& b, double sign, double tolerance) {
    for (std::size_t e = 0; e < a.size(); ++e)
        if (!(std::abs(std::remainder(a[e] - sign * b[e], 2 * M_PI)) < tolerance)) return false;
    return true;
}

} // namespace

std::vector<double> angles_of(const Prescribed& data, const Points& x) {
    std::vector<double> angles(data.edges.size(), 0.0);
    for (const Hinge& h : hinges_of(data.edges, data.triangles))
        angles[h.edge] = hinge_angle(h.nodes, x).value;
    return angles;
}

Points shaken(const Prescribed& data, Points x, double share, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    const double reach = share * mean_length(data);
    Points normal(x.size(), Vec3::Zero());
    for (const Triangle& t : data.triangles) {
        const Vec3 n = (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]);
        for (const int i : t) normal[i] += n;
    }
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += reach * next_signed(random) * normal[i].normalized();
    return x;
}

double gradient_measure(const Prescribed& data, const Eigen::VectorXd& g) {
    const double weight = weight_of(data);
    return g.size() == 0 || weight == 0 ? 0 : g.cwiseAbs().maxCoeff() * mean_length(data) / weight;
}

NearestShape nearest_shape(const Prescribed& data, const Points& start, const NearestOptions& options) {
    NearestShape shape;
    shape.x = start;
    for (int saddles = 0;; ++saddles) {
        Descent descent(data, shape.x);
        shape.end = NearestEnd::iterations;
        while (descent.gradient() > options.tolerance && shape.iterations < options.max_iterations) {
            if (!descent.step()) {
                shape.end = NearestEnd::stalled;
                break;
            }
            ++shape.iterations;
        }
        shape.x = descent.x;
        shape.energy = descent.energy();
        shape.gradient = descent.gradient();
        if (shape.gradient > options.tolerance) return shape;
        shape.end = NearestEnd::minimum;
        if (descent.at_minimum()) return shape;
        shape.end = NearestEnd::saddle;
        if (saddles == most_saddles) return shape;
        shape.x = shaken(data, shape.x, off_saddle, saddles);
    }
}

std::vector<FoundShape> distinct_shapes(const Prescribed& data, const Points& start,
                                        const std::function<NearestShape(const Points&)>& find) {
    std::vector<FoundShape> found;
    std::vector<std::vector<double>> angles;
    const auto look_from = [&](const Points& x) {
        FoundShape f{find(x), -1};
        if (f.shape.end != NearestEnd::minimum) return;
        const std::vector<double> a = angles_of(data, f.shape.x);
        for (std::size_t k = 0; k < found.size(); ++k)
            if (std::abs(found[k].shape.energy - f.shape.energy) <= same_energy * (1e-9 * weight_of(data) + f.shape.energy) &&
                alike(a, angles[k], 1, same_angle))
                return;
        found.push_back(std::move(f));
        angles.push_back(a);
    };
    const Points mirror = mirrored(start, normal_of(start));
    for (int k = 0; k <= shaken_starts; ++k)
        for (const Points* from : {&start, &mirror}) look_from(k == 0 ? *from : shaken(data, *from, shake, k));
    std::vector<int> order(found.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return found[a].shape.energy < found[b].shape.energy; });
    std::vector<FoundShape> sorted;
    for (const int k : order) {
        FoundShape& f = sorted.emplace_back(std::move(found[k]));
        for (int other = 0; other < int(order.size()); ++other)
            if (order[other] != k && alike(angles[k], angles[order[other]], -1, mirror_angle)) f.mirror = other;
    }
    return sorted;
}

std::vector<FoundShape> nearest_shapes(const Prescribed& data, const Points& start, const NearestOptions& options) {
    return distinct_shapes(data, start, [&](const Points& x) { return nearest_shape(data, x, options); });
}

} // namespace toile

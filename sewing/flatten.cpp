// SPDX-License-Identifier: GPL-3.0-or-later
#include "sewing/flatten.h"

#include "geometry/edges.h"
#include "geometry/text.h"
#include "sewing/flat_energy.h"
#include "sewing/mesh_grain.h"
#include "sewing/sparse_solve.h"

#include <Eigen/SVD>
#include <Eigen/SparseLU>

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace toile {

namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Slopes = Eigen::Matrix<double, 2, 3>; // derivatives of barycentric coordinates in the triangle's own plane, 1/m

constexpr double damping = 1e-8;  // by which the Hessian's diagonal is enlarged: pieces may be moved and turned for nothing
constexpr double near_fold = 0.8; // share of the step at which the first triangle has no area that is taken at most
constexpr double decrease = 1e-4; // share of the decrease that the slope promises (Armijo)

struct Flatter { // a triangle in its own plane
    Triangle points{};
    Slopes slopes;
    double area = 0;
};

Flatter flatter(const TriMesh& piece, const Triangle& t, int first) {
    const Mat2 edges = edges_in_grain(piece.points[t[1]] - piece.points[t[0]], piece.points[t[2]] - piece.points[t[0]], Vec3::UnitY());
    Slopes s;
    s.rightCols<2>() = edges.inverse().transpose();
    s.col(0) = -s.col(1) - s.col(2);
    return {{t[0] + first, t[1] + first, t[2] + first}, s, 0.5 * edges.determinant()};
}

double area_of(const TriMesh& mesh) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles) sum += triangle_area(mesh.points, t);
    return sum;
}

/// The border on a circle by its lengths, points within by mean values of their neighbours; as large as the piece.
std::vector<Vec2> on_a_disc(const TriMesh& piece) {
    const std::vector<int> border = border_loop(piece);
    const double radius = std::sqrt(area_of(piece) / EIGEN_PI);
    std::vector<double> along{0};
    for (std::size_t k = 0; k < border.size(); ++k)
        along.push_back(along.back() + (piece.points[border[(k + 1) % border.size()]] - piece.points[border[k]]).norm());
    const Eigen::Index n = Eigen::Index(piece.points.size());
    Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(n, 2);
    std::vector<char> held(piece.points.size(), 0);
    for (std::size_t k = 0; k < border.size(); ++k) {
        const double angle = 2 * EIGEN_PI * along[k] / along.back();
        right.row(border[k]) << radius * std::cos(angle), radius * std::sin(angle);
        held[border[k]] = 1;
    }
    std::vector<Eigen::Triplet<double>> entries; // of each held point 1, of others the weights of neighbours, which sum to 0
    for (int i = 0; i < int(n); ++i)
        if (held[i]) entries.emplace_back(i, i, 1);
    for (const Triangle& t : piece.triangles)
        for (int k = 0; k < 3; ++k) {
            const int i = t[k];
            if (held[i]) continue;
            const Vec3 a = piece.points[t[(k + 1) % 3]] - piece.points[i], b = piece.points[t[(k + 2) % 3]] - piece.points[i];
            const double half = std::tan(0.5 * std::atan2(a.cross(b).norm(), a.dot(b)));
            entries.emplace_back(i, t[(k + 1) % 3], half / a.norm());
            entries.emplace_back(i, t[(k + 2) % 3], half / b.norm());
            entries.emplace_back(i, i, -half / a.norm() - half / b.norm());
        }
    Sparse matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SparseLU<Sparse> factor(matrix);
    const Eigen::MatrixX2d solved = factor.solve(right);
    std::vector<Vec2> flat(piece.points.size());
    for (Eigen::Index i = 0; i < n; ++i) flat[i] = solved.row(i).transpose();
    return flat;
}

Mat2 map_of(const Flatter& t, const std::vector<Vec2>& flat) {
    Mat2 j = Mat2::Zero();
    for (int k = 0; k < 3; ++k) j += flat[t.points[k]] * t.slopes.col(k).transpose();
    return j;
}

/// The share of a step, at most `most`, after which the determinant of j + share * by is 0.
double share_to_fold(const Mat2& j, const Mat2& by, double most) {
    const double a = by.determinant(), c = j.determinant();
    const double b = j(0, 0) * by(1, 1) + j(1, 1) * by(0, 0) - j(0, 1) * by(1, 0) - j(1, 0) * by(0, 1);
    const double root = b * b - 4 * a * c;
    if (root < 0) return most;
    const double q = -0.5 * (b + std::copysign(std::sqrt(root), b));
    for (const double s : {q / a, c / q})
        if (s > 0 && s < most) most = s; // not a number where there is no such root
    return most;
}

/// All pieces in one vector of places.
class Flattening {
public:
    Flattening(const std::vector<TriMesh>& pieces, const std::vector<SewnEdges>& sewn, double weight) : weight_(weight) {
        for (const TriMesh& piece : pieces) {
            first_.push_back(int(flat_.size()));
            for (const Triangle& t : piece.triangles) triangles_.push_back(flatter(piece, t, first_.back()));
            const std::vector<Vec2> start = on_a_disc(piece);
            flat_.insert(flat_.end(), start.begin(), start.end());
        }
        first_.push_back(int(flat_.size()));
        for (const auto& [piece, points] : sewn)
            sewn_.push_back({points[0][0] + first_[piece[0]], points[0][1] + first_[piece[0]], points[1][0] + first_[piece[1]],
                             points[1][1] + first_[piece[1]]});
    }

    /// One round; the longest move of a point, m.
    double step() {
        Eigen::VectorXd slope = Eigen::VectorXd::Zero(Eigen::Index(2 * flat_.size()));
        const Sparse hessian = derivatives(slope);
        const Eigen::MatrixXd solved = solve_definite(hessian, -slope);
        std::vector<Vec2> way(flat_.size());
        for (std::size_t i = 0; i < way.size(); ++i) way[i] = solved.block<2, 1>(Eigen::Index(2 * i), 0);
        double share = 1 / near_fold;
        for (const Flatter& t : triangles_) share = share_to_fold(map_of(t, flat_), map_of(t, way), share);
        share *= near_fold;
        const double promised = slope.dot(solved.col(0)), before = energy(flat_);
        double longest = 0;
        for (const Vec2& w : way) longest = std::max(longest, w.norm());
        std::vector<Vec2> moved = flat_;
        for (int halved = 0; halved < 40; ++halved, share *= 0.5) {
            for (std::size_t i = 0; i < way.size(); ++i) moved[i] = flat_[i] + share * way[i];
            if (!(energy(moved) <= before + decrease * share * promised)) continue;
            flat_ = std::move(moved);
            break;
        }
        return longest;
    }

    /// What was up comes to lie up: images of the vertical laid into each triangle, by area.
    std::vector<Vec2> turned_up(int piece) const {
        Vec2 up = Vec2::Zero();
        for (const Flatter& t : triangles_)
            if (t.points[0] >= first_[piece] && t.points[0] < first_[piece + 1]) up += t.area * map_of(t, flat_).col(1);
        Mat2 turn;
        turn << up.y(), -up.x(), up.x(), up.y();
        std::vector<Vec2> out;
        for (int i = first_[piece]; i < first_[piece + 1]; ++i) out.push_back(turn * (flat_[i] - flat_[first_[piece]]) / up.norm());
        return out;
    }

private:
    std::array<Vec2, 4> ends(const std::array<int, 4>& e, const std::vector<Vec2>& flat) const { return {flat[e[0]], flat[e[1]], flat[e[2]], flat[e[3]]}; }

    double energy(const std::vector<Vec2>& flat) const {
        double sum = 0;
        for (const Flatter& t : triangles_) sum += t.area * flat_energy(map_of(t, flat));
        for (const auto& e : sewn_) sum += weight_ * sewn_energy(ends(e, flat));
        return sum;
    }

    /// Adds to `slope`; the Hessian's positive part, damped.
    Sparse derivatives(Eigen::VectorXd& slope) const {
        std::vector<Eigen::Triplet<double>> entries;
        entries.reserve(36 * triangles_.size() + 64 * sewn_.size());
        const auto add = [&](const auto& points, const auto& gradient, const auto& hessian) {
            for (int i = 0; i < gradient.size(); ++i) {
                const int row = 2 * points[i / 2] + i % 2;
                slope[row] += gradient[i];
                for (int k = 0; k < gradient.size(); ++k) entries.emplace_back(row, 2 * points[k / 2] + k % 2, hessian(i, k));
            }
        };
        for (const Flatter& t : triangles_) {
            Vec4 g;
            Mat4 h;
            flat_energy(map_of(t, flat_), &g, &h);
            Eigen::Matrix<double, 4, 6> by_places = Eigen::Matrix<double, 4, 6>::Zero();
            for (int k = 0; k < 3; ++k)
                for (int c = 0; c < 2; ++c) by_places.block<2, 2>(2 * c, 2 * k).diagonal().setConstant(t.slopes(c, k));
            const Eigen::Matrix<double, 6, 1> gradient = t.area * by_places.transpose() * g;
            const Eigen::Matrix<double, 6, 6> hessian = t.area * by_places.transpose() * h * by_places;
            add(t.points, gradient, hessian);
        }
        for (const auto& e : sewn_) {
            Eigen::Matrix<double, 8, 1> g;
            Eigen::Matrix<double, 8, 8> h;
            sewn_energy(ends(e, flat_), &g, &h);
            add(e, weight_ * g, weight_ * h);
        }
        Sparse matrix(slope.size(), slope.size());
        matrix.setFromTriplets(entries.begin(), entries.end());
        for (int i = 0; i < int(slope.size()); ++i) matrix.coeffRef(i, i) *= 1 + damping;
        return matrix;
    }

    double weight_;
    std::vector<int> first_; ///< by piece, its first place; and the end
    std::vector<Flatter> triangles_;
    std::vector<std::array<int, 4>> sewn_;
    std::vector<Vec2> flat_;
};

} // namespace

void expect_disc(const TriMesh& piece) {
    border_loop(piece);
    const EdgeTable edges = make_edges(piece.triangles, int(piece.points.size()));
    if (int(piece.points.size()) - edges.size() + int(piece.triangles.size()) != 1) throw std::invalid_argument("it has a handle");
    for (const Triangle& t : piece.triangles) {
        const Vec3 a = piece.points[t[1]] - piece.points[t[0]], b = piece.points[t[2]] - piece.points[t[0]];
        if (!(edges_in_grain(a, b, Vec3::UnitY()).determinant() > 0))
            throw std::invalid_argument(text("its triangle of points %d, %d and %d has no area", t[0], t[1], t[2]));
    }
}

std::vector<int> border_loop(const TriMesh& piece) {
    const EdgeTable edges = make_edges(piece.triangles, int(piece.points.size()));
    std::vector<int> next(piece.points.size(), -1);
    std::size_t count = 0;
    for (std::size_t t = 0; t < piece.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k)
            if (edges.triangles_at(edges.of_triangle[t][k]) == 1) {
                next[piece.triangles[t][(k + 1) % 3]] = piece.triangles[t][(k + 2) % 3];
                ++count;
            }
    if (count == 0) throw std::invalid_argument("it is closed");
    const int first = int(std::find_if(next.begin(), next.end(), [](int n) { return n >= 0; }) - next.begin());
    std::vector<int> loop{first};
    while (next[loop.back()] != first && loop.size() <= count) loop.push_back(next[loop.back()]);
    if (loop.size() != count) {
        for (const int p : loop) next[p] = -1;
        const auto other = std::find_if(next.begin(), next.end(), [](int n) { return n >= 0; });
        const Vec3& at = piece.points[other == next.end() ? loop.back() : int(other - next.begin())];
        throw std::invalid_argument("it has a hole, or borders that touch" + text(", at (%.3f, %.3f, %.3f)", at.x(), at.y(), at.z()));
    }
    return loop;
}

std::vector<Flattened> flatten(const std::vector<TriMesh>& pieces, const std::vector<SewnEdges>& sewn, const FlattenOptions& options) {
    Flattening flattening(pieces, sewn, options.seam_weight);
    double area = 0;
    for (const TriMesh& piece : pieces) area += area_of(piece);
    Flattened all;
    while (!all.settled && all.rounds < options.max_rounds) {
        all.settled = flattening.step() < options.tolerance * std::sqrt(area);
        ++all.rounds;
    }
    std::vector<Flattened> out(pieces.size(), all);
    for (std::size_t p = 0; p < pieces.size(); ++p) out[p].points = flattening.turned_up(int(p));
    return out;
}

Vec2 laid_strain(const TriMesh& piece, const std::vector<Vec2>& flat, int t) {
    const Triangle& n = piece.triangles[t];
    Mat2 cut;
    cut << flat[n[1]] - flat[n[0]], flat[n[2]] - flat[n[0]];
    Eigen::Matrix<double, 3, 2> space;
    space << piece.points[n[1]] - piece.points[n[0]], piece.points[n[2]] - piece.points[n[0]];
    const Eigen::Matrix<double, 3, 2> map = space * cut.inverse();
    return Eigen::JacobiSVD<Eigen::Matrix<double, 3, 2>>(map).singularValues().array() - 1;
}

} // namespace toile

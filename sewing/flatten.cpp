// SPDX-License-Identifier: GPL-3.0-or-later
#include "sewing/flatten.h"

#include "geometry/edges.h"
#include "geometry/text.h"
#include "sewing/mesh_grain.h"

#include <Eigen/SVD>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <stdexcept>

namespace toile {

namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Slopes = Eigen::Matrix<double, 2, 3>; // derivatives of barycentric coordinates in the triangle's own plane, 1/m

struct Flatter { // a triangle in its own plane
    Triangle points{};
    Slopes slopes;
    double area = 0;
};

std::vector<Flatter> triangles_of(const TriMesh& piece) {
    std::vector<Flatter> all;
    for (const Triangle& t : piece.triangles) {
        const Vec3 a = piece.points[t[1]] - piece.points[t[0]], b = piece.points[t[2]] - piece.points[t[0]];
        const Mat2 edges = edges_in_grain(a, b, Vec3::UnitY());
        if (!(edges.determinant() > 0))
            throw std::invalid_argument(text("flatten: the triangle of points %d, %d and %d has no area", t[0], t[1], t[2]));
        Slopes s;
        s.rightCols<2>() = edges.inverse().transpose();
        s.col(0) = -s.col(1) - s.col(2);
        all.push_back({t, s, 0.5 * edges.determinant()});
    }
    return all;
}

/// Two points far from each other.
std::array<int, 2> far_apart(const TriMesh& piece, const std::vector<int>& border) {
    const auto farthest = [&](int from) {
        return *std::max_element(border.begin(), border.end(), [&](int p, int q) {
            return (piece.points[p] - piece.points[from]).norm() < (piece.points[q] - piece.points[from]).norm();
        });
    };
    const int a = farthest(border[0]);
    return {a, farthest(a)};
}

/// Least sum of area |grad u - turned grad v|^2 with two points held where they are as far apart as in space.
std::vector<Vec2> conformal(const TriMesh& piece, const std::vector<Flatter>& triangles, const std::array<int, 2>& held) {
    const int n = int(piece.points.size());
    const double apart = (piece.points[held[1]] - piece.points[held[0]]).norm();
    Eigen::VectorXd fixed = Eigen::VectorXd::Zero(2 * n);
    fixed[2 * held[1] + 1] = apart;
    std::vector<int> row(2 * n, -1);
    int count = 0;
    for (int i = 0; i < n; ++i)
        for (int c = 0; c < 2; ++c)
            if (i != held[0] && i != held[1]) row[2 * i + c] = count++;
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
    for (const Flatter& t : triangles) {
        Eigen::Matrix<double, 2, 6> r; // u_x - v_y and u_y + v_x by u0 v0 u1 v1 u2 v2
        for (int k = 0; k < 3; ++k) {
            const Vec2 s = t.slopes.col(k);
            r.col(2 * k) = s;
            r.col(2 * k + 1) = Vec2(-s.y(), s.x());
        }
        const Eigen::Matrix<double, 6, 6> h = t.area * r.transpose() * r;
        for (int i = 0; i < 6; ++i)
            for (int j = 0; j < 6; ++j) {
                const int a = 2 * t.points[i / 2] + i % 2, b = 2 * t.points[j / 2] + j % 2;
                if (row[a] < 0) continue;
                if (row[b] < 0)
                    right[row[a]] -= h(i, j) * fixed[b];
                else
                    entries.emplace_back(row[a], row[b], h(i, j));
            }
    }
    Sparse matrix(count, count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Sparse> factor(matrix);
    const Eigen::VectorXd solved = factor.solve(right);
    std::vector<Vec2> flat(n);
    for (int i = 0; i < n; ++i)
        for (int c = 0; c < 2; ++c) flat[i][c] = row[2 * i + c] < 0 ? fixed[2 * i + c] : solved[row[2 * i + c]];
    return flat;
}

Mat2 map_of(const Flatter& t, const std::vector<Vec2>& flat) {
    Mat2 j = Mat2::Zero();
    for (int k = 0; k < 3; ++k) j += flat[t.points[k]] * t.slopes.col(k).transpose();
    return j;
}

Mat2 nearest_rotation(const Mat2& j) {
    const Vec2 c = Vec2(j(0, 0) + j(1, 1), j(1, 0) - j(0, 1)).normalized();
    Mat2 r;
    r << c.x(), -c.y(), c.y(), c.x();
    return r;
}

void scale_to_area(const std::vector<Flatter>& triangles, std::vector<Vec2>& flat) {
    double space = 0, plane = 0;
    for (const Flatter& t : triangles) space += t.area, plane += t.area * std::abs(map_of(t, flat).determinant());
    for (Vec2& p : flat) p *= std::sqrt(space / plane);
}

/// What was up comes to lie up: images of the vertical laid into each triangle, by area.
void turn_up(const std::vector<Flatter>& triangles, std::vector<Vec2>& flat) {
    Vec2 up = Vec2::Zero();
    for (const Flatter& t : triangles) up += t.area * map_of(t, flat).col(1);
    Mat2 turn;
    turn << up.y(), -up.x(), up.x(), up.y();
    for (Vec2& p : flat) p = turn * p / up.norm();
}

/// The rounds of places and rotations.
class Rounds {
public:
    Rounds(const TriMesh& piece, const std::vector<Flatter>& triangles, const std::vector<int>& border, double weight)
        : triangles_(triangles), weight_(weight) {
        for (std::size_t k = 0; k < border.size(); ++k) {
            const int a = border[k], b = border[(k + 1) % border.size()];
            edges_.push_back({a, b});
            lengths_.push_back((piece.points[b] - piece.points[a]).norm());
        }
        std::vector<Eigen::Triplet<double>> entries;
        const auto add = [&](int i, int j, double v) {
            if (i > 0 && j > 0) entries.emplace_back(i - 1, j - 1, v); // the first point stays
        };
        for (const Flatter& t : triangles)
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) add(t.points[i], t.points[j], t.area * t.slopes.col(i).dot(t.slopes.col(j)));
        for (const auto& [a, b] : edges_) add(a, a, weight), add(b, b, weight), add(a, b, -weight), add(b, a, -weight);
        const int n = int(piece.points.size()) - 1;
        Sparse matrix(n, n);
        matrix.setFromTriplets(entries.begin(), entries.end());
        factor_.compute(matrix);
    }

    std::vector<Vec2> next(const std::vector<Vec2>& flat) const {
        Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(Eigen::Index(flat.size()), 2);
        for (const Flatter& t : triangles_) {
            const Mat2 r = nearest_rotation(map_of(t, flat));
            for (int k = 0; k < 3; ++k) right.row(t.points[k]) += (t.area * r * t.slopes.col(k)).transpose();
        }
        for (std::size_t e = 0; e < edges_.size(); ++e) {
            const auto& [a, b] = edges_[e];
            const Vec2 pull = weight_ * lengths_[e] * (flat[b] - flat[a]).normalized();
            right.row(b) += pull.transpose();
            right.row(a) -= pull.transpose();
        }
        const Eigen::MatrixX2d x = factor_.solve(right.bottomRows(right.rows() - 1));
        std::vector<Vec2> moved(flat.size(), Vec2::Zero());
        for (std::size_t i = 1; i < flat.size(); ++i) moved[i] = x.row(Eigen::Index(i) - 1).transpose();
        return moved;
    }

private:
    const std::vector<Flatter>& triangles_;
    double weight_;
    std::vector<std::array<int, 2>> edges_;
    std::vector<double> lengths_;
    Eigen::SimplicialLDLT<Sparse> factor_;
};

} // namespace

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
    if (loop.size() != count) throw std::invalid_argument("it has a hole, or borders that touch");
    return loop;
}

Flattened flatten(const TriMesh& piece, const FlattenOptions& options) {
    const std::vector<int> border = border_loop(piece);
    const std::vector<Flatter> triangles = triangles_of(piece);
    Flattened out;
    out.points = conformal(piece, triangles, far_apart(piece, border));
    scale_to_area(triangles, out.points);
    const Vec2 first = out.points[0];
    for (Vec2& p : out.points) p -= first;
    const Rounds rounds(piece, triangles, border, options.border_weight);
    double size = 0;
    for (const Flatter& t : triangles) size += t.area;
    while (!out.settled && out.rounds < options.max_rounds) {
        std::vector<Vec2> moved = rounds.next(out.points);
        double most = 0;
        for (std::size_t i = 0; i < moved.size(); ++i) most = std::max(most, (moved[i] - out.points[i]).norm());
        out.points = std::move(moved);
        out.settled = most < options.tolerance * std::sqrt(size);
        ++out.rounds;
    }
    turn_up(triangles, out.points);
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

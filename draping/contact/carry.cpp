// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/contact/carry.h"

#include "geometry/foot.h"
#include "geometry/parallel.h"
#include "sewing/sparse_solve.h"

#include <cmath>

namespace toile {

namespace {

constexpr double on_body = 1e5;   // weight of the anchor's motion, over that of one neighbour's, for cloth on the body
constexpr double off_body = 0.01; // m, distance at which a sixteenth of that weight is left
constexpr double least = 1e-6;    // weight that is always left

Vec3 at(const Points& p, const Triangle& t, const Vec3& corner) {
    return corner[0] * p[t[0]] + corner[1] * p[t[1]] + corner[2] * p[t[2]];
}

/// Axes that go with a triangle; of one without area, any.
Mat3 axes(const Points& p, const Triangle& t) {
    const Vec3 along = p[t[1]] - p[t[0]], normal = along.cross(p[t[2]] - p[t[0]]);
    if (!(normal.squaredNorm() > 0)) return Mat3::Identity();
    Mat3 m;
    m << along.normalized(), normal.normalized(), along.cross(normal).normalized();
    return m;
}

} // namespace

std::vector<Anchor> find_anchors(const Points& x, const TriMesh& body) {
    const Bvh tree(triangle_boxes(body.points, body.triangles, 0));
    std::vector<Anchor> anchors(x.size());
    parallel_for(int(x.size()), 256, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
            const Foot foot = foot_on(body, tree, x[i]);
            const Nearest& n = foot.nearest;
            anchors[i] = {foot.triangle, {n.weight[1], n.weight[2], n.weight[3]}, std::sqrt(n.squared)};
        }
    });
    return anchors;
}

Eigen::VectorXd carried(const std::vector<Anchor>& anchors, const TriMesh& body, const Points& motion,
                        const EdgeTable& edges, const std::vector<char>& pinned) {
    const int n = int(anchors.size());
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd diagonal(n);
    Eigen::MatrixXd pull(n, 3);
    for (int i = 0; i < n; ++i) {
        const double near = off_body / (off_body + anchors[i].distance);
        diagonal[i] = pinned[i] ? 1 : least + on_body * near * near * near * near;
        pull.row(i) = diagonal[i] * at(motion, body.triangles[anchors[i].triangle], anchors[i].corner).transpose();
        if (pinned[i]) pull.row(i).setZero();
    }
    for (const auto& [a, b] : edges.ends) {
        if (!pinned[a]) diagonal[a] += 1;
        if (!pinned[b]) diagonal[b] += 1;
        if (pinned[a] || pinned[b]) continue; // what stays pulls by its motion, which is none
        entries.emplace_back(a, b, -1);
        entries.emplace_back(b, a, -1);
    }
    for (int i = 0; i < n; ++i) entries.emplace_back(i, i, diagonal[i]);
    Eigen::SparseMatrix<double> matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::MatrixXd d = solve_definite(matrix, pull);
    Eigen::VectorXd dx(3 * n);
    for (int i = 0; i < n; ++i) dx.segment<3>(3 * i) = d.row(i).transpose();
    return dx;
}

void carry_places(Friction& friction, const std::vector<Anchor>& anchors, const TriMesh& body, const Points& moved) {
    for (std::size_t i = 0; i < friction.ties.size(); ++i) {
        Tie& tie = friction.ties[i];
        if (!(tie.force > 0)) continue;
        const Triangle& t = body.triangles[anchors[i].triangle];
        const Mat3 turn = axes(moved, t) * axes(body.points, t).transpose();
        const Vec3 from = at(body.points, t, anchors[i].corner), to = at(moved, t, anchors[i].corner);
        tie.place = to + turn * (tie.place - from);
        tie.normal = turn * tie.normal;
    }
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/nonconforming/midpoint_cloth.h"

#include <Eigen/Dense>

#include <algorithm>
#include <limits>

namespace toile {

namespace {

using Coordinates = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

constexpr double softest = 300;       // N/m, of bars to begin with: a softer membrane lets Newton's steps be longer
constexpr double stiff = 2400;        // where all of them get to, by a factor of
constexpr double stiffer = 2;         // a round
constexpr double nearly = 3000;       // times the strain to be kept, below which what is left is no want of rest:
constexpr double fallen = 0.3;        // a bar or tie of which a round leaves more than this share pushes against what is stiff, as
constexpr double stiffest = 1e5;      // the body's barrier or a held node is, and becomes stiffer by itself, up to this
constexpr double stiffer_alone = 3;
constexpr double first_tie = 2e3;     // N/m

} // namespace

MidpointCloth::MidpointCloth(const Garment& garment, const std::vector<Fabric>& fabrics)
    : garment_(garment), nodes_(garment.node_count), ends_(garment.edges.ends), cloth_(make_nonconforming_cloth(garment, fabrics)),
      tension_(Eigen::VectorXd::Zero(cloth_.bars.size())), stiffness_(Eigen::VectorXd::Constant(cloth_.bars.size(), softest)),
      last_misfit_(Eigen::VectorXd::Constant(cloth_.bars.size(), std::numeric_limits<double>::infinity())) {
    held_.assign(nodes_, Vec3::Zero());
    tie_ = Eigen::VectorXd::Constant(nodes_, first_tie);
    last_gap_ = Eigen::VectorXd::Constant(nodes_, std::numeric_limits<double>::infinity());
    for (const Mat2& e : garment.rest.edges) {
        const Vec2 d[3] = {rest_edge(e, 0) / 2, rest_edge(e, 1) / 2, rest_edge(e, 2) / 2};
        Mat3 to_stress;
        for (int k = 0; k < 3; ++k) to_stress.col(k) << d[k].x() * d[k].x(), d[k].y() * d[k].y(), d[k].x() * d[k].y();
        to_stress_.push_back(to_stress);
        to_weights_.push_back(to_stress.inverse());
    }
    beyond_compact_ = cloth_.bending.stiffness - cloth_.bending.compact;
    for (const Bar& bar : cloth_.bars) mean_length_ += bar.length / double(cloth_.bars.size());
    constant_ = constants();
}

std::vector<MidpointCloth::Constant> MidpointCloth::constants() const {
    const auto& ghost = cloth_.midpoints.ghost;
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](int i, int j, double v) {
        if (i >= j) entries.emplace_back(i, j, v);
    };
    for (int i = 0; i < nodes_; ++i) {
        if (ghost.outerIndexPtr()[i] == ghost.outerIndexPtr()[i + 1]) continue;
        add(i, i, tie_[i]);
        for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator a(ghost, i); a; ++a) {
            add(nodes_ + int(a.col()), i, -tie_[i] * a.value());
            for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator b(ghost, i); b; ++b)
                add(nodes_ + int(a.col()), nodes_ + int(b.col()), tie_[i] * a.value() * b.value());
        }
    }
    const auto& bend = cloth_.bending.compact;
    for (int j = 0; j < bend.outerSize(); ++j)
        for (Eigen::SparseMatrix<double>::InnerIterator e(bend, j); e; ++e) add(nodes_ + int(e.row()), nodes_ + j, e.value());
    const int n = nodes_ + cloth_.midpoints.count();
    Eigen::SparseMatrix<double> sum(n, n);
    sum.setFromTriplets(entries.begin(), entries.end());
    std::vector<Constant> found;
    for (int j = 0; j < n; ++j)
        for (Eigen::SparseMatrix<double>::InnerIterator e(sum, j); e; ++e) found.push_back({int(e.row()), j, -1, e.value()});
    return found;
}

std::vector<double> MidpointCloth::masses(std::vector<double> of_nodes) const {
    for (double& m : of_nodes) m /= 2;
    for (const double m : cloth_.midpoints.mass) of_nodes.push_back(m / 2);
    return of_nodes;
}

void MidpointCloth::carry(Points& x, const Points& nodes) const {
    if (x.empty()) x.assign(nodes_ + ends_.size(), Vec3::Zero());
    // P of the means of ends is the nodes again, so that gaps stay as they are.
    for (std::size_t e = 0; e < ends_.size(); ++e)
        for (const int i : ends_[e]) x[nodes_ + e] += (nodes[i] - x[i]) / 2;
    std::copy(nodes.begin(), nodes.end(), x.begin());
}

Points MidpointCloth::gaps(const Points& x) const {
    const Points at = ghost_nodes(cloth_.midpoints, midpoints(x));
    Points gap(nodes_, Vec3::Zero());
    const auto* first = cloth_.midpoints.ghost.outerIndexPtr();
    for (int i = 0; i < nodes_; ++i)
        if (first[i] < first[i + 1]) gap[i] = x[i] - at[i];
    return gap;
}

double MidpointCloth::pull(int b, const Points& x) const {
    const Bar& bar = cloth_.bars[b];
    const double now = (x[nodes_ + bar.a] - x[nodes_ + bar.b]).norm();
    return tension_[b] + stiffness_[b] * (now - bar.length) * (now + bar.length) / (2 * bar.length);
}

double MidpointCloth::largest_gap(const Points& x) const {
    double most = 0;
    for (const Vec3& gap : gaps(x)) most = std::max(most, gap.norm());
    return most / mean_length_;
}

std::optional<double> MidpointCloth::kept_strain(const Points& x) const { return largest_triangle_strain(garment_, midpoints(x)); }

double MidpointCloth::value(const Points& x) const {
    const Points m = midpoints(x), gap = gaps(x);
    double sum = bend_value(cloth_.bending, m);
    const Eigen::VectorXd c = misfit(cloth_.bars, m);
    for (Eigen::Index b = 0; b < c.size(); ++b) sum += (tension_[b] + 0.5 * stiffness_[b] * c[b]) * c[b];
    for (int i = 0; i < nodes_; ++i) sum += held_[i].dot(gap[i]) + 0.5 * tie_[i] * gap[i].squaredNorm();
    return sum;
}

void MidpointCloth::add_gradient(const Points& x, Eigen::VectorXd& g) const {
    const Points m = midpoints(x);
    Points tie = gaps(x);
    for (int i = 0; i < nodes_; ++i) {
        tie[i] = held_[i] + tie_[i] * tie[i];
        g.segment<3>(3 * i) += tie[i];
    }
    const Points bend = bend_gradient(cloth_.bending, m), back = from_ghost_nodes(cloth_.midpoints, tie);
    const Eigen::VectorXd own = tension_ + stiffness_.cwiseProduct(misfit(cloth_.bars, m));
    Eigen::VectorXd of_midpoints = Eigen::VectorXd::Zero(3 * Eigen::Index(m.size()));
    add_tensions(cloth_.bars, m, own, of_midpoints);
    for (std::size_t e = 0; e < m.size(); ++e) of_midpoints.segment<3>(3 * e) += bend[e] - back[e];
    g.tail(of_midpoints.size()) += of_midpoints;
}

void MidpointCloth::couplings(std::vector<std::pair<int, int>>& pairs) const {
    for (const Constant& c : constant_)
        if (c.row != c.column) pairs.emplace_back(c.row, c.column);
    for (const Bar& bar : cloth_.bars) pairs.emplace_back(nodes_ + bar.a, nodes_ + bar.b);
    for (const auto& [a, b] : ends_) pairs.emplace_back(a, b); // a body that touches an edge or triangle couples its nodes
}

void MidpointCloth::find_blocks(const BlockMatrix& h) {
    for (Constant& c : constant_)
        if (c.row != c.column) c.slot = h.find(c.row, c.column);
    bar_slot_.clear();
    for (const Bar& bar : cloth_.bars)
        bar_slot_.push_back(h.find(nodes_ + std::max(bar.a, bar.b), nodes_ + std::min(bar.a, bar.b)));
}

void MidpointCloth::add_hessian(const Points& x, HessianKind kind, BlockMatrix& h) const {
    for (const Constant& c : constant_) {
        if (c.row == c.column)
            h.add_diagonal(c.row, c.value * Mat3::Identity());
        else
            h.add_off_diagonal(c.column, c.slot, c.value * Mat3::Identity());
    }
    for (int t = 0; t < int(to_weights_.size()); ++t) {
        Vec3 weight;
        for (int k = 0; k < 3; ++k) weight[k] = pull(3 * t + k, x) / cloth_.bars[3 * t + k].length;
        if (kind == HessianKind::projected) {
            const Vec3 s = to_stress_[t] * weight;
            Mat2 stress;
            stress << s[0], s[2], s[2], s[1];
            Eigen::SelfAdjointEigenSolver<Mat2> eigen;
            eigen.computeDirect(stress);
            stress = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
            weight = to_weights_[t] * Vec3(stress(0, 0), stress(1, 1), stress(0, 1));
        }
        for (int k = 0; k < 3; ++k) {
            const Bar& bar = cloth_.bars[3 * t + k];
            const Vec3 row = (x[nodes_ + bar.a] - x[nodes_ + bar.b]) / bar.length;
            const Mat3 block = stiffness_[3 * t + k] * row * row.transpose() + weight[k] * Mat3::Identity();
            h.add_diagonal(nodes_ + bar.a, block);
            h.add_diagonal(nodes_ + bar.b, block);
            h.add_off_diagonal(nodes_ + std::min(bar.a, bar.b), bar_slot_[3 * t + k], -block);
        }
    }
}

void MidpointCloth::add_left_out(const Points&, const Eigen::VectorXd& v, Eigen::VectorXd& product) const {
    const Eigen::Index m = beyond_compact_.rows();
    const Coordinates beyond = beyond_compact_ * Eigen::Map<const Coordinates>(v.data() + 3 * nodes_, m, 3);
    Eigen::Map<Coordinates>(product.data() + 3 * nodes_, m, 3) += beyond;
}

bool MidpointCloth::take_up(const Points& x) {
    const double strain = *kept_strain(x), gap = largest_gap(x);
    const Eigen::VectorXd c = misfit(cloth_.bars, midpoints(x));
    tension_ += stiffness_.cwiseProduct(c);
    const auto harder = [&](double stiffness, double left, double last, double length) {
        const bool stays = left > std::max(kept * length, fallen * last);
        return stays && strain < nearly * kept ? std::min(stiffer_alone * stiffness, stiffest) : stiffness;
    };
    for (Eigen::Index b = 0; b < c.size(); ++b)
        stiffness_[b] = stiffness_[b] < stiff ? std::min(stiffer * stiffness_[b], stiff)
                                              : harder(stiffness_[b], std::abs(c[b]), last_misfit_[b], cloth_.bars[b].length);
    last_misfit_ = c.cwiseAbs();
    const Points gap_now = gaps(x);
    const Eigen::VectorXd ties_before = tie_;
    for (int i = 0; i < nodes_; ++i) {
        held_[i] += tie_[i] * gap_now[i];
        tie_[i] = harder(tie_[i], gap_now[i].norm(), last_gap_[i], mean_length_);
        last_gap_[i] = gap_now[i].norm();
    }
    if (tie_ != ties_before) {
        const std::vector<Constant> now = constants(); // of the same blocks
        for (std::size_t k = 0; k < now.size(); ++k) constant_[k].value = now[k].value;
    }
    return std::max(strain, gap) > kept;
}

} // namespace toile

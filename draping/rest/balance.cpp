// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/rest/balance.h"

#include "draping/algebra/cholesky.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>

namespace toile {

namespace {

using Eigen::VectorXd;

constexpr double first_ridge = 1e-12; // of the softest direction of a middling point; the matrix may lack a support
constexpr double most_ridge = 1e-4;
constexpr int most_refinements = 30;
constexpr double refined = 1e-12; // change of what is missing, as a share of it, from which on it stays
constexpr double first_spring = 1, last_spring = 1e-8; // of the same softness
constexpr int most_steps = 60;    // of Newton, for a strength of springs
constexpr double relaxed = 1e-7;  // of what is missing
constexpr double slack = 1e-10;   // of a bound
constexpr double nearest = 1e-6;  // what the sum of squares may be above the least, as a share

class Solver {
public:
    Solver(const std::vector<Member>& members, const Points& load, const std::vector<char>& held, double tolerance)
        : members_(members), held_(held), side_(members.size(), 0), force_(members.size(), 0.0), load_(flat(load)) {
        clear_held(load_);
        tolerance_ = tolerance * largest_of(load_);
        std::vector<std::pair<int, int>> pairs;
        for (const Member& m : members)
            for (int k = 0; k < m.count; ++k)
                for (int l = 0; l < k; ++l) pairs.emplace_back(m.nodes[k], m.nodes[l]);
        matrix_ = BlockMatrix(int(load.size()), pairs);
        factor_.analyse(matrix_);
        find_softness();
        for (std::size_t j = 0; j < members.size(); ++j) side_[j] = members[j].low == members[j].high;
    }

    /// Where no bound counts, one solution does. Else weak springs to where each point is, that take up what is missing, make
    /// it a convex problem without constraints; they are weakened until the sides that they show are the right ones.
    Balance run() {
        if (solve() && all_right() && (balanced() || is_nearest())) return result();
        VectorXd u = VectorXd::Zero(load_.size());
        std::vector<double> best;
        double least = std::numeric_limits<double>::infinity();
        bool reached = true;
        for (double spring = first_spring * softness_; reached && spring >= last_spring * softness_; spring /= 10) {
            reached = relax(spring, u);
            if (missing_.norm() < least) {
                least = missing_.norm();
                best = force_;
            }
            if (reached && solve() && all_right() && (balanced() || is_nearest())) return result();
        }
        force_ = best;
        return result();
    }

private:
    void clear_held(VectorXd& v) const {
        for (std::size_t i = 0; i < held_.size(); ++i)
            if (held_[i]) v.segment<3>(3 * i).setZero();
    }

    double along(const Member& m, const VectorXd& v) const {
        double sum = 0;
        for (int k = 0; k < m.count; ++k) sum += m.slope[k].dot(v.segment<3>(3 * m.nodes[k]));
        return sum;
    }

    double largest_of(const VectorXd& v) const {
        double most = 0;
        for (Eigen::Index i = 0; i < v.size(); i += 3) most = std::max(most, v.segment<3>(i).norm());
        return most;
    }

    /// The stiffness of a middling point in the direction in which it has least.
    void find_softness() {
        std::vector<Mat3> block(held_.size(), Mat3::Zero());
        for (const Member& m : members_)
            for (int k = 0; k < m.count; ++k) block[m.nodes[k]] += m.stiffness * m.slope[k] * m.slope[k].transpose();
        std::vector<double> soft;
        double most = 0;
        for (std::size_t i = 0; i < block.size(); ++i) {
            if (held_[i]) continue;
            const Vec3 values = Eigen::SelfAdjointEigenSolver<Mat3>(block[i], Eigen::EigenvaluesOnly).eigenvalues();
            soft.push_back(values[0]);
            most = std::max(most, values[2]);
        }
        if (!(most > 0)) return;
        std::nth_element(soft.begin(), soft.begin() + soft.size() / 2, soft.end());
        softness_ = std::max(soft[soft.size() / 2], 1e-9 * most);
    }

    bool factorise(double ridge) {
        matrix_.set_zero();
        for (std::size_t j = 0; j < members_.size(); ++j) {
            const Member& m = members_[j];
            if (side_[j] != 0) continue;
            Eigen::Matrix<double, 12, 1> slope;
            for (int k = 0; k < m.count; ++k) slope.segment<3>(3 * k) = m.slope[k];
            if (m.count == 2) {
                const Eigen::Matrix<double, 6, 1> s = slope.head<6>();
                matrix_.add_element<2>({m.nodes[0], m.nodes[1]}, m.stiffness * s * s.transpose());
            } else {
                matrix_.add_element<4>(m.nodes, m.stiffness * slope * slope.transpose());
            }
        }
        matrix_.add_to_diagonal(VectorXd::Constant(load_.size(), ridge));
        matrix_.pin(held_);
        ++factorisations_;
        return factor_.factorise(matrix_);
    }

    void find_missing() {
        missing_ = load_;
        for (std::size_t j = 0; j < members_.size(); ++j)
            for (int k = 0; k < members_[j].count; ++k)
                missing_.segment<3>(3 * members_[j].nodes[k]) -= force_[j] * members_[j].slope[k];
        clear_held(missing_);
    }

    /// Forces and displacement for the sides as they are. The free members may not hold everything, and the matrix then has a
    /// ridge alone, as small as rounding allows.
    bool solve() {
        for (; ridge_ <= most_ridge; ridge_ *= 100)
            if (factorise(ridge_ * softness_) && refine(ridge_ * softness_)) return true;
        ridge_ = most_ridge;
        return false;
    }

    /// What no free member can hold would be divided by the ridge alone: it is taken out by solving twice, or its
    /// displacement, of that size, would drown all others in rounding.
    bool refine(double ridge) {
        displacement_.setZero(load_.size());
        for (std::size_t j = 0; j < members_.size(); ++j)
            force_[j] = side_[j] < 0 ? members_[j].low : side_[j] > 0 ? members_[j].high : 0;
        find_missing();
        VectorXd y, held_up;
        for (int k = 0; k < most_refinements && largest_of(missing_) > 1e-3 * tolerance_; ++k) {
            factor_.solve(missing_, y);
            held_up = missing_ - ridge * y;
            factor_.solve(held_up, y);
            displacement_ += y;
            for (std::size_t j = 0; j < members_.size(); ++j)
                if (side_[j] == 0) force_[j] += members_[j].stiffness * along(members_[j], y);
            const VectorXd last = missing_;
            find_missing();
            if (largest_of(missing_ - last) <= refined * largest_of(missing_)) return true;
        }
        return balanced();
    }

    /// Least sum of force^2 / (2 stiffness) + missing^2 / (2 spring) within the bounds, by its dual: the sum over members of
    /// the energy that they take up within their bounds, which is convex and in pieces quadratic, by Newton steps. False when
    /// they do not get there.
    bool relax(double spring, VectorXd& u) {
        VectorXd d, out = imbalance(u, spring);
        for (int k = 0; k < most_steps && out.norm() > relaxed * missing_.norm(); ++k) {
            if (!factorise(spring)) return false;
            factor_.solve(out, d);
            u += step_along(u, d, out.dot(d), spring) * d;
            out = imbalance(u, spring);
        }
        return out.norm() <= relaxed * missing_.norm();
    }

    /// Where along d the slope, -`slope` at 0, has fallen to a share of that: 1 unless bounds are in the way.
    double step_along(const VectorXd& u, const VectorXd& d, double slope, double spring) {
        double low = 0, high = 1;
        const auto left = [&](double t) { return imbalance(u + t * d, spring).dot(d); };
        double at = left(high);
        for (int k = 0; k < 20 && at > slope / 2; ++k) at = left(high *= 2);
        double t = high;
        for (int k = 0; k < 40 && std::abs(at) > slope / 2; ++k) {
            (at > 0 ? low : high) = t;
            t = (low + high) / 2;
            at = left(t);
        }
        return t;
    }

    /// Forces and sides at a displacement, and what is missing beyond what springs take up.
    VectorXd imbalance(const VectorXd& u, double spring) {
        for (std::size_t j = 0; j < members_.size(); ++j) {
            const Member& m = members_[j];
            const double wish = m.stiffness * along(m, u);
            side_[j] = wish <= m.low ? -1 : wish >= m.high ? 1 : 0;
            force_[j] = std::clamp(wish, m.low, m.high);
        }
        find_missing();
        return missing_ - spring * u;
    }

    /// Whether the sum of squares is least but for a share: what other forces could gain at most, since it is convex.
    bool is_nearest() const {
        double gain = 0;
        for (std::size_t j = 0; j < members_.size(); ++j) {
            const double slope = along(members_[j], missing_);
            gain += slope * ((slope > 0 ? members_[j].high : members_[j].low) - force_[j]);
        }
        return gain <= nearest * missing_.squaredNorm();
    }

    bool balanced() const { return largest_of(missing_) <= tolerance_; }

    /// Whether no member is beyond its bounds, and none at a bound would leave it for less that is missing, or where that is
    /// the same, for a smaller sum.
    bool all_right() const {
        const bool met = balanced();
        for (std::size_t j = 0; j < members_.size(); ++j) {
            const Member& m = members_[j];
            const double room = slack * (m.high - m.low);
            if (side_[j] == 0) {
                if (force_[j] < m.low - room || force_[j] > m.high + room) return false;
                continue;
            }
            if (m.low == m.high) continue;
            double steepest = 0;
            for (int k = 0; k < m.count; ++k) steepest = std::max(steepest, m.slope[k].norm());
            const double gain = met ? 0 : -side_[j] * along(m, missing_) / steepest;
            const double wish = m.stiffness * along(m, displacement_);
            const bool smaller = side_[j] < 0 ? wish > m.low + room : wish < m.high - room;
            if (gain > tolerance_ || (gain > -tolerance_ && smaller)) return false;
        }
        return true;
    }

    Balance result() {
        Balance b;
        for (std::size_t j = 0; j < members_.size(); ++j)
            force_[j] = std::clamp(force_[j], members_[j].low, members_[j].high);
        find_missing();
        b.force = force_;
        b.missing.resize(held_.size());
        flat(b.missing) = missing_;
        b.factorisations = factorisations_;
        if (balanced())
            b.end = BalanceEnd::balanced;
        else if (is_nearest())
            b.end = BalanceEnd::nearest;
        return b;
    }

    const std::vector<Member>& members_;
    const std::vector<char>& held_;
    std::vector<signed char> side_; ///< -1, 1: at the low or high bound; 0: free
    std::vector<double> force_;
    VectorXd load_, missing_, displacement_;
    BlockMatrix matrix_;
    Cholesky factor_;
    double tolerance_ = 0, softness_ = 1, ridge_ = first_ridge;
    int factorisations_ = 0;
};

} // namespace

Balance balance(const std::vector<Member>& members, const Points& load, const std::vector<char>& held, double tolerance) {
    return Solver(members, load, held, tolerance).run();
}

} // namespace toile

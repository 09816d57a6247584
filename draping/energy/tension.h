// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What pulls in lines that keep their lengths: the multipliers of these constraints, as an energy.

#include "draping/energy/energy.h"

namespace toile {

/// C = (|x_b - x_a|^2 - length^2) / (2 length) = 0, whose gradient has the length of a unit vector where it holds.
struct LengthConstraint {
    int a = 0, b = 0;
    double length = 0; ///< m
};

/// C for another length at the same scale, m.
double violation(const LengthConstraint& c, double length, const Points& x);
/// Gradient of C by x_b; by x_a it is minus that.
inline Vec3 slope(const LengthConstraint& c, const Points& x) { return (x[c.b] - x[c.a]) / c.length; }
/// Elongation as a share of the length.
double strain(const LengthConstraint& c, const Points& x);

/// E = sum of tension C + 1/2 stiffness C^2: what lines of given tensions pull with at every place of their ends, and more
/// where they are longer than they should be (the augmented Lagrangian of Hestenes 1969). No energy that cloth stores, since C
/// is 0 when the lengths are kept.
class Tension final : public Energy {
public:
    explicit Tension(std::vector<LengthConstraint> lines);

    const std::vector<LengthConstraint>& lines() const { return lines_; }
    std::vector<double> newtons;   ///< per line; negative: it pushes
    std::vector<double> stiffness; ///< N/m, per line
    std::vector<double> target;    ///< m, the length that C of a line is about; that of the line unless another is given

    double value(const Points& x) const override;
    void add_gradient(const Points& x, Eigen::VectorXd& g) const override;
    void couplings(std::vector<std::pair<int, int>>& pairs) const override;
    /// Projected: what turns lines that push is left out.
    void add_hessian(const Points& x, HessianKind kind, BlockMatrix& h) const override;
    /// Tensions become what lines pull with at x (the method of multipliers); whether a strain is more than `kept`.
    bool take_up(const Points& x) override;

    static constexpr double kept = 1e-6; ///< strain

private:
    double violated(int k, const Points& x) const { return violation(lines_[k], target[k], x); }

    std::vector<LengthConstraint> lines_;
};

} // namespace toile

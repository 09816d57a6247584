// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Damped springs between nodes (Provot: Deformation Constraints in a Mass-Spring Model to Describe Rigid Cloth Behavior,
// 1995), in one phase or in two (Desbrun, Meyer, Barr: Interactive Animation of Cloth-like Objects in Virtual Reality,
// 2000). docs/methods.md derives what makes cloth of them.

#include "draping/energy/energy.h"

#include <limits>
#include <map>

namespace toile {

enum class SpringKind { warp, weft, shear, bend };

/// Pulls its ends together with `tension` where they are `length` apart, and with `stiffness` more for every metre
/// beyond, which is a spring of rest length r = length - tension / stiffness:
///   f = -[k_s (|x| - r) + k_d (v.x) / |x|] x / |x|.
struct Spring {
    int a = 0, b = 0;
    double length = 0;    ///< m, in flat cloth
    double tension = 0;   ///< N there; what makes a spring resist bending is that it pushes
    double stiffness = 0; ///< N/m, k_s
    double damping = 0;   ///< N s/m, k_d
    /// m of |x| - length, beyond which a spring of two phases has the stiffness `stiffness_beyond`.
    double threshold = std::numeric_limits<double>::infinity();
    double stiffness_beyond = 0; ///< N/m
    SpringKind kind = SpringKind::warp;
    double limit = 0; ///< elongation that the fabric bears, as a share of the length; 0: any
};

double pull(const Spring& spring, double distance);      ///< N, without damping
double stiffness(const Spring& spring, double distance); ///< N/m, there

class Springs final : public Energy {
public:
    explicit Springs(std::vector<Spring> springs) : springs_(std::move(springs)) {}

    const std::vector<Spring>& springs() const { return springs_; }

    double value(const Points& x) const override; ///< J, 0 where all have their length
    void add_gradient(const Points& x, Eigen::VectorXd& g) const override;
    void couplings(std::vector<std::pair<int, int>>& pairs) const override;
    /// Projected: what the tensions of flat cloth resist in all directions, which is positive if they are in balance, and
    /// of the rest of each spring the part that is positive.
    void add_hessian(const Points& x, HessianKind kind, BlockMatrix& h) const override;
    void add_damping(const Points& x, const Points& v, Eigen::VectorXd& force) const override;
    void add_damping_matrix(const Points& x, double factor, BlockMatrix& h) const override;

private:
    std::vector<Spring> springs_;
};

/// Index of the spring between two nodes, smaller first.
using SpringBetween = std::map<std::array<int, 2>, int>;

/// A place of flat cloth in an affine dependency: sum of weight = 0, sum of weight times place = 0.
struct BraceNode {
    int node = 0;
    Vec2 place{0, 0};  ///< m
    double weight = 0; ///< 1/m
};

/// Lets the springs between all pairs of `nodes` bear the tensions -c w_i w_j |x_i - x_j|, which are in balance in flat cloth.
/// For small motions z out of its plane their energy is 1/2 c (sum w_i z_i)^2 (c in N m): the way springs resist bending.
/// A spring that is missing is added, with the stiffness that puts its rest at twice its length.
void brace(std::vector<Spring>& springs, SpringBetween& between, const std::vector<BraceNode>& nodes, double c);

/// Damping proportional to stiffness: k_d is `time` (s) times k_s.
void damp(std::vector<Spring>& springs, double time);

} // namespace toile

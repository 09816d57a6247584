// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Cloth on edge midpoints that keeps its lengths, as an energy for settle(): rest with contact, without motion.

#include "draping/energy/energy.h"
#include "draping/nonconforming/cloth.h"

namespace toile {

/// Over the nodes of a garment, followed by its midpoints (numbered as Garment::edges): nodes are the ghost nodes of cloth on
/// midpoints, and what acts on nodes, contact above all, acts on them. Two kinds of conditions are kept by the method of multipliers
/// (Hestenes 1969; see Tension): every bar its length, and every node its place, y = P m. With bending
///     E = bend(m) + sum_bars (T c + 1/2 k c^2) + sum_nodes (f . (y - P m) + 1/2 k |y - P m|^2).
/// At rest T are the tensions, and f what contact and loads do on nodes. With y eliminated all pairs of midpoints around two nodes
/// that touch would be coupled; with nodes of its own, contact couples these alone.
class MidpointCloth final : public Energy {
public:
    /// `fabrics` has one entry per panel. Throws as make_nonconforming_cloth().
    MidpointCloth(const Garment& garment, const std::vector<Fabric>& fabrics);

    const NonconformingCloth& cloth() const { return cloth_; }
    Points midpoints(const Points& x) const { return {x.begin() + nodes_, x.end()}; }
    /// Largest distance of a node from P m, over the mean length of bars.
    double largest_gap(const Points& x) const;

    /// Half of the mass is that of nodes, half that of midpoints: the weight is the same (see Midpoints::ghost).
    std::vector<double> masses(std::vector<double> of_nodes) const override;
    void carry(Points& x, const Points& nodes) const override;
    int node_near(int point) const override { return point < nodes_ ? point : ends_[point - nodes_][0]; }
    std::optional<double> kept_strain(const Points& x) const override;

    double value(const Points& x) const override;
    void add_gradient(const Points& x, Eigen::VectorXd& g) const override;
    void couplings(std::vector<std::pair<int, int>>& pairs) const override;
    /// Projected: of the stress of every triangle, what pushes is left out of what turns it.
    void add_hessian(const Points& x, HessianKind kind, BlockMatrix& h) const override;
    void find_blocks(const BlockMatrix& h) override;
    void add_left_out(const Points& x, const Eigen::VectorXd& v, Eigen::VectorXd& product) const override;
    bool take_up(const Points& x) override;

    static constexpr double kept = 1e-6; ///< strain of triangles

private:
    struct Constant {
        int row = 0, column = 0, slot = 0;
        double value = 0; ///< N/m
    };

    Points gaps(const Points& x) const;
    std::vector<Constant> constants() const;
    double pull(int bar, const Points& x) const;

    const Garment& garment_;
    int nodes_ = 0;
    std::vector<std::array<int, 2>> ends_;
    NonconformingCloth cloth_;
    std::vector<Mat3> to_stress_;        ///< of a triangle: its stress (xx, yy, 2 xy) by the weights of its bars
    std::vector<Mat3> to_weights_;       ///< and back
    Eigen::VectorXd tension_;            ///< N per bar
    Points held_;                        ///< N per node
    Eigen::VectorXd stiffness_;          ///< N/m per bar
    Eigen::VectorXd tie_;                ///< N/m per node
    Eigen::VectorXd last_misfit_;        ///< m per bar, when forces were last taken up
    Eigen::VectorXd last_gap_;           ///< m per node, likewise
    Eigen::SparseMatrix<double, Eigen::RowMajor> beyond_compact_;
    std::vector<Constant> constant_;     ///< lower triangle of compact bending and ties
    std::vector<int> bar_slot_;
    double mean_length_ = 0;             ///< m, of bars
};

} // namespace toile

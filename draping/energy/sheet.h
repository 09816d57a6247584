// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What the cloth itself resists: stretch, bending and the strain limits of its fabrics, put together.

#include "draping/algebra/block_matrix.h"
#include "draping/energy/bend.h"
#include "draping/energy/energy.h"
#include "draping/energy/hinge.h"
#include "draping/energy/rest_curvature.h"
#include "draping/energy/strain_limit.h"
#include "draping/energy/stretch.h"

namespace toile {

struct Sheet {
    std::vector<StretchElement> stretch;
    Bending bending;
    std::vector<HingeBend> creases;
    std::vector<RestCurvature> curved; ///< empty: flat at rest
    Eigen::SparseMatrix<double> beyond_compact; ///< bending.stiffness less its compact form
    std::vector<StrainLimit> limits;            ///< empty: none
    double softness = 1; ///< factor on the membrane; below 1 on the way to a drape, whose steps it lengthens

    /// Clusters of triangles by colour: those of one colour share no node, so that they can be added at once and
    /// the sum at every block has one order whatever the number of threads.
    std::vector<int> clusters;
    std::vector<int> colours; ///< colour c holds clusters[colours[c] .. colours[c + 1])
    std::vector<std::array<int, Patch::max_nodes>> bend_place; ///< of a patch node in the compact bending, or -1
    std::vector<std::array<int, Patch::max_nodes * Patch::max_nodes>> slots; ///< of blocks a > b in the matrix
};

/// `fabrics` has one entry per panel. Strain limits are made but act only when `limits` is not cleared.
Sheet make_sheet(const Garment& garment, const std::vector<Fabric>& fabrics);

/// Which nodes elements share with those that are marked: with `moving` only these move, and only such elements matter.
std::vector<char> coupled_nodes(const Sheet& sheet, const std::vector<char>& moving);

/// What of a sheet acts on nodes that are `moving` (1 each), over the nodes of a part: `local` has the number there of
/// every node, -1 for those that are not in it; it holds all coupled_nodes(). Its value is that of the sheet but for a
/// constant, and so are the derivatives by what moves; those by others mean nothing.
Sheet part_of(const Sheet& sheet, const std::vector<char>& moving, const std::vector<int>& local, int nodes);

double sheet_value(const Sheet& sheet, const Points& x);
void sheet_gradient(const Sheet& sheet, const Points& x, Points& gradient);

/// Blocks that sheet_hessian fills.
void sheet_couplings(const Sheet& sheet, std::vector<std::pair<int, int>>& pairs);

/// Looks up where the elements' blocks lie; to be called whenever the matrix has a new pattern.
void sheet_slots(Sheet& sheet, const BlockMatrix& matrix);

/// Adds second derivatives, with bending in its compact form and without what rest curvature adds.
void sheet_hessian(const Sheet& sheet, const Points& x, HessianKind kind, BlockMatrix& matrix);

/// Adds to y what sheet_hessian leaves out of the product of the second derivative with v.
void sheet_beyond_compact(const Sheet& sheet, const Points& x, const Eigen::VectorXd& v, Eigen::VectorXd& y);

/// The sheet as any model of cloth.
class SheetEnergy final : public Energy {
public:
    explicit SheetEnergy(Sheet s) : sheet(std::move(s)) {}

    Sheet sheet;

    double value(const Points& x) const override { return sheet_value(sheet, x); }
    void add_gradient(const Points& x, Eigen::VectorXd& g) const override;
    void couplings(std::vector<std::pair<int, int>>& pairs) const override { sheet_couplings(sheet, pairs); }
    void add_hessian(const Points& x, HessianKind kind, BlockMatrix& h) const override { sheet_hessian(sheet, x, kind, h); }
    void find_blocks(const BlockMatrix& h) override { sheet_slots(sheet, h); }
    void add_left_out(const Points& x, const Eigen::VectorXd& v, Eigen::VectorXd& product) const override {
        sheet_beyond_compact(sheet, x, v, product);
    }
};

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A drape that goes along while its pattern is altered: the same nodes, another rest shape, and the equilibrium near the
// last one. Friction is frozen meanwhile, so that all forces are those of one energy and rest is a smooth function of the
// amounts.

#include "draping/drape_run.h"
#include "draping/fit/moving_flat.h"

#include <memory>

namespace toile {

struct AlteredOptions {
    double tolerance = 1e-9;  ///< residual of an equilibrium; see DrapeResult::residual
    int max_iterations = 400; ///< Newton iterations of one
};

class AlteredDrape {
public:
    /// `drape` is one of the finest level of moved_flat() at `amounts`, its seams closed, on the body, with these options.
    AlteredDrape(const MovingFlat& moving, const Eigen::VectorXd& amounts, const DrapeResult& drape, const TriMesh& body,
                 const PanelFabrics& fabrics, const DrapeOptions& options, const AlteredOptions& how = {});

    /// The garment with these amounts, not yet at rest. Throws std::invalid_argument when they turn a triangle over.
    Garment garment_at(const Eigen::VectorXd& amounts) const { return garment_of(pattern_at(amounts)); }

    /// Brings the garment of these amounts to rest near `x`, friction frozen as it is.
    SettleResult rest(const Eigen::VectorXd& amounts, Points& x);

    /// Friction holds the garment of these amounts, at rest at `x`, where it is; what is lagged is brought up to date, and x
    /// to rest with that. Frozen afterwards.
    SettleResult anchor(const Eigen::VectorXd& amounts, Points& x);

    /// Pulls the garment of these amounts, without friction, to the nearest points of a surface: as near as its rest shape lets it without crossing
    /// anything. Not at rest afterwards.
    void draw_to(const TriMesh& surface, const Eigen::VectorXd& amounts, Points& x);

    /// At rest at `x` with these amounts: the solution of K lambda = r, K the exact second derivative of all that acts. False
    /// when K is not positive definite, as of a state that is no minimum.
    bool solve(const Eigen::VectorXd& amounts, const Points& x, const Eigen::VectorXd& r, Eigen::VectorXd& lambda);

    /// dg/dp at x: a column for every alteration, how the forces on the nodes change with its amount while they stay, N/m or N per share; 0
    /// at pinned ones.
    Eigen::MatrixXd force_slopes(const Eigen::VectorXd& amounts, const Points& x) const;

    const ClothProblem& problem() const { return *problem_; }
    const PanelFabrics& fabrics() const { return fabrics_; }
    const MovingFlat& moving() const { return moving_; }

private:
    Pattern pattern_at(const Eigen::VectorXd& amounts) const;
    Garment garment_of(const Pattern& pattern) const;
    void take(const Eigen::VectorXd& amounts);

    const MovingFlat& moving_;
    Staging staging_;
    TriMesh body_;
    PanelFabrics fabrics_;
    DrapeOptions options_;
    AlteredOptions how_;
    FrictionCoefficients friction_;
    Garment garment_; ///< as it was draped
    Eigen::VectorXd amounts_; ///< that the problem rests on
    std::unique_ptr<ClothProblem> problem_;
    Cholesky factor_;
};

} // namespace toile

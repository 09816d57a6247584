// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The membrane: orthotropic, slack under compression, not locked by bending.

#include "draping/energy/energy.h"
#include "draping/energy/patch.h"
#include "draping/fabric/fabric.h"

#include <memory>

namespace toile {

struct StretchOptions {
    /// Take edges for arcs: 1/2 (|e|^2 - l^2) + |q|^2 / 24 with q the edge's turning times its length (see
    /// Patch) is the mean Green strain of an arc times l^2, and zero to fourth order on every bend that keeps
    /// lengths. With plain chords such a bend costs membrane energy k kappa^4 l^4, which locks meshes coarser
    /// than 2.6 sqrt(R sqrt(12 D / k)).
    bool arc_edges = true;
};

/// The measured curves of a fabric, by Green's strain; the other direction may have none.
struct MembraneCurves {
    StretchCurve weft, warp;
};

/// One triangle: constant Green strain (weft, warp, twice shear) from the lengths of its three edges;
/// W per area = (1 - compression) W_slack + compression W_full, with W_full = 1/2 e C e and W_slack its
/// minimum when warp and weft may each be shortened at will: a yarn that would be compressed carries nothing
/// and the other answers as in a uniaxial test. Convex in strain, once continuously differentiable.
///
/// With measured curves of energy P (strain) and first slopes k, C is that of the slopes and
///   W_full = 1/2 e C e + [P_weft(e_weft) - 1/2 k_weft e_weft^2] + [P_warp(e_warp) - 1/2 k_warp e_warp^2]:
/// the Poisson coupling stays that of the first slopes. A strip pulled along either direction then answers with exactly its
/// curve and contracts by the constant ratios of C, since what is contracted is on the straight part of its own curve; a
/// straight curve leaves W as it is. W_slack has P in place of 1/2 k e^2. It is convex where the product of the
/// curves' slopes stays above about poisson^2 k_weft / k_warp of that of the first; others are refused.
struct StretchElement {
    Patch patch;
    Mat3 to_strain;            ///< strain = to_strain g, g_k = 1/2 (|e_k|^2 - l_k^2) + |q_k|^2 / 24, m^2
    Vec3 length_squared;       ///< of the rest edges, m^2
    double area = 0;           ///< m^2
    Mat3 full;                 ///< C, N/m
    double weft = 0, warp = 0; ///< uniaxial stiffness, N/m
    double compression = 0;
    std::shared_ptr<const MembraneCurves> curves; ///< null: constant stiffness
};

/// Block of 3 patch.count rows and columns.
using StretchHessian =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3 * Patch::max_nodes, 3 * Patch::max_nodes>;

/// Throws std::invalid_argument for a fabric whose stiffness is not positive definite, anywhere on its curves.
void check_membrane(const Fabric& fabric);

/// `fabrics` has one entry per panel. Throws as check_membrane().
std::vector<StretchElement> make_stretch(const Garment& garment, const std::vector<Fabric>& fabrics,
                                         const StretchOptions& options = {});

/// Green strain (weft, warp, twice shear) of one triangle.
Vec3 stretch_strain(const StretchElement& element, const Points& x);

/// Energy per area and its derivatives by strain: stress (N/m) and tangent (N/m, positive semidefinite).
struct StretchResponse {
    double energy = 0;
    Vec3 stress;
    Mat3 tangent;
};
StretchResponse stretch_response(const StretchElement& element, const Vec3& strain);

double stretch_value(const StretchElement& element, const Points& x);
/// Gradient of one element by node of its patch.
void stretch_gradient(const StretchElement& element, const Points& x,
                      std::array<Vec3, Patch::max_nodes>& gradient);
/// The same with this stress (N/m) whatever the strain.
void stretch_gradient(const StretchElement& element, const Vec3& stress, const Points& x,
                      std::array<Vec3, Patch::max_nodes>& gradient);

/// The second derivative of one element, block by block as they are asked for.
struct StretchCurvature {
    int count = 0; ///< nodes of the patch
    std::array<Mat3, Patch::max_nodes> length, pull; ///< column k: of edge k; the sum of pull_k length_k^T
    Eigen::Matrix<double, Patch::max_nodes, Patch::max_nodes> identity; ///< lower half: what multiplies I3
    std::array<Vec3, 3> turning; ///< of edge k
    Vec3 bend;                   ///< what multiplies turning_k turning_k^T curve(k, a) curve(k, b)
    const Patch* patch = nullptr;

    /// Block of patch nodes a >= b.
    Mat3 block(int a, int b) const {
        const Mat3 &p = pull[a], &l = length[b];
        Mat3 m;
        for (int c = 0; c < 3; ++c)
            for (int r = 0; r < 3; ++r) m(r, c) = p(r, 0) * l(c, 0) + p(r, 1) * l(c, 1) + p(r, 2) * l(c, 2);
        for (int r = 0; r < 3; ++r) m(r, r) += identity(a, b);
        for (int k = 0; k < 3; ++k) {
            if (bend[k] == 0) continue;
            const double factor = bend[k] * patch->curve(k, a) * patch->curve(k, b);
            const Vec3& t = turning[k];
            for (int c = 0; c < 3; ++c)
                for (int r = 0; r < 3; ++r) m(r, c) += factor * t[r] * t[c];
        }
        return m;
    }
};

/// Exact, or positive semidefinite: the tangent part as it is, compressive stresses left out of the geometric
/// part. The result refers to the element.
StretchCurvature stretch_curvature(const StretchElement& element, const Points& x, HessianKind kind);
/// The same as one matrix.
void stretch_hessian(const StretchElement& element, const Points& x, HessianKind kind,
                     StretchHessian& hessian);

double stretch_value(const std::vector<StretchElement>& elements, const Points& x);
/// Adds the gradient to `gradient`.
void stretch_gradient(const std::vector<StretchElement>& elements, const Points& x, Points& gradient);

} // namespace toile

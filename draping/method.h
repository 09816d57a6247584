// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The methods of the literature by which cloth is modelled and its motion solved, by name: which model goes with which
// stepper. docs/methods.md has the formulas and says what each cannot do.

#include "draping/fabric/fabric.h"
#include "draping/solve/sweep_order.h"
#include "sewing/garment.h"

#include <memory>
#include <string>
#include <vector>

namespace toile {

class Energy;
class Stepper;
class Response;
struct StepOptions;

enum class Method { equilibrium, springs_explicit, springs_implicit, springs_biphasic, springs_limited,
                    triangles, projective, xpbd, inextensible, nonconforming };

const std::vector<Method>& all_methods();
const char* to_string(Method method); ///< as above, with hyphens: "springs-explicit"
/// Throws std::invalid_argument with the names when there is no such method.
Method method_called(const std::string& name);

/// Whether rest is found by Newton's steps on its energy when contact is a barrier, which is part of that energy then
/// (settle.h). With other responses, and the methods without such a solver, cloth moves in time.
bool settles(Method method);
/// Whether it needs panels whose edges lie along warp and weft (TriangulateOptions::grain_lattice).
inline bool needs_grain_lattice(Method method) { return method == Method::inextensible; }

/// Whether stretch follows the measured curves of a fabric; the others go by the numbers that stand for them.
bool has_curves(Method method);

/// Whether it has internal friction of its own, by MethodOptions::damping_time.
bool has_damping(Method method);

struct MethodOptions {
    double time_step = 0;         ///< s, of explicit methods that of substeps; 0: that of the StepOptions, of inextensible 0.5 ms, of
                                  ///< explicit ones what is stable
    double damping_time = 2e-5;   ///< s, damping of springs and triangles as a share of their stiffness
    double beyond = 20;           ///< springs-biphasic: stiffness beyond the fabric's limits, times that before
    LimitOptions limits;          ///< springs-limited
    bool projected = true;        ///< triangles: a positive semidefinite stand-in for the Hessian
};

/// What cloth is made of by a method that settles. `fabrics` has one entry per panel.
std::unique_ptr<Energy> make_energy(Method method, const Garment& garment, const std::vector<Fabric>& fabrics,
                                    const MethodOptions& options);

/// The cloth of a garment as one method that moves has it, with `pinned` (per node), without loads. Keeps references
/// to the garment and the response. `fabrics` has one entry per panel. Throws std::invalid_argument for a method that does not move.
std::unique_ptr<Stepper> make_stepper(Method method, const Garment& garment, const std::vector<Fabric>& fabrics,
                                      const std::vector<char>& pinned, Response& response, const StepOptions& step,
                                      const MethodOptions& options);

} // namespace toile

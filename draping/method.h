// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The methods of the literature by which cloth is modelled and its motion solved, by name: which model goes with which
// stepper. docs/methods.md has the formulas and says what each cannot do.

#include "draping/contact/response_kind.h"
#include "draping/fabric/fabric.h"
#include "draping/solve/sweep_order.h"
#include "sewing/garment.h"

#include <memory>
#include <string>
#include <vector>

namespace toile {

class Stepper;
class Response;
struct StepOptions;

enum class Method { equilibrium, springs_explicit, springs_implicit, springs_biphasic, springs_limited,
                    triangles, projective, xpbd, inextensible, nonconforming };

const std::vector<Method>& all_methods();
const char* to_string(Method method); ///< as above, with hyphens: "springs-explicit"
/// Throws std::invalid_argument with the names when there is no such method.
Method method_called(const std::string& name);

/// Whether it finds rest by motion in time, which needs a response to contact. Equilibrium may have one, the others must.
inline bool moves(Method method) { return method != Method::equilibrium; }
/// Whether it needs panels whose edges lie along warp and weft (TriangulateOptions::grain_lattice).
inline bool needs_grain_lattice(Method method) { return method == Method::inextensible; }
inline ContactResponse usual_response(Method method) {
    return moves(method) ? ContactResponse::impulse : ContactResponse::barrier;
}

struct MethodOptions {
    double time_step = 0;         ///< s, of explicit methods that of substeps; 0: 2 ms, of inextensible 0.5, of explicit ones what is
                                  ///< stable
    double spring_damping = 2e-5; ///< s, damping of springs as a share of their stiffness
    double beyond = 20;           ///< springs-biphasic: stiffness beyond the fabric's limits, times that before
    LimitOptions limits;          ///< springs-limited
    bool projected = true;        ///< triangles: a positive semidefinite stand-in for the Hessian
};

/// The cloth of a garment as one method that moves has it, with `pinned` (per node), without loads. Keeps references to the
/// garment and the response. `fabrics` has one entry per panel. Throws std::invalid_argument for a method that does not move.
std::unique_ptr<Stepper> make_stepper(Method method, const Garment& garment, const std::vector<Fabric>& fabrics,
                                      const std::vector<char>& pinned, Response& response, const StepOptions& step,
                                      const MethodOptions& options);

} // namespace toile

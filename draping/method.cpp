// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/method.h"

#include "draping/cloth.h"
#include "draping/energy/spring_mesh.h"
#include "draping/energy/triangles.h"
#include "draping/energy/yarns.h"
#include "draping/solve/free_cloth.h"
#include "draping/solve/implicit.h"
#include "draping/solve/inextensible.h"
#include "draping/solve/limited.h"
#include "draping/solve/nonconforming.h"
#include "draping/solve/projective.h"
#include "draping/solve/xpbd.h"

#include <algorithm>
#include <stdexcept>

namespace toile {

namespace {

constexpr double inextensible_step = 5e-4; // s: lines that the body stretches pull with a hundred times what hangs from them

std::unique_ptr<NodeProblem> free_cloth(std::unique_ptr<Energy> energy, std::vector<double> mass,
                                        const std::vector<char>& pinned, bool projected = true) {
    auto problem = std::make_unique<FreeCloth>(std::move(energy), std::move(mass), projected);
    for (std::size_t i = 0; i < pinned.size(); ++i)
        if (pinned[i]) problem->pin(int(i));
    return problem;
}

std::unique_ptr<Stepper> spring_stepper(Method method, const Garment& garment, const std::vector<Fabric>& fabrics,
                                        const std::vector<char>& pinned, Response& response, StepOptions step,
                                        const MethodOptions& options) {
    const SpringMeshOptions how{options.spring_damping, method == Method::springs_biphasic ? options.beyond : 1};
    const std::vector<Spring> springs = mesh_springs(garment, fabrics, how);
    auto problem = free_cloth(std::make_unique<Springs>(springs), node_masses(garment, fabrics), pinned);
    if (method == Method::springs_implicit || method == Method::springs_biphasic) {
        if (options.time_step > 0) step.time_step = options.time_step;
        return std::make_unique<ImplicitStepper>(std::move(problem), response, step);
    }
    step.time_step = std::max(step.time_step, options.time_step);
    std::unique_ptr<ExplicitStepper> stepper;
    if (method == Method::springs_limited)
        stepper = std::make_unique<LimitedStepper>(std::move(problem), springs, response, step, options.limits);
    else
        stepper = std::make_unique<ExplicitStepper>(std::move(problem), response, step);
    stepper->substep = options.time_step;
    return stepper;
}

std::unique_ptr<Stepper> triangle_stepper(Method method, const Garment& garment, const std::vector<Fabric>& fabrics,
                                          const std::vector<char>& pinned, Response& response, StepOptions step,
                                          const MethodOptions& options) {
    if (options.time_step > 0) step.time_step = options.time_step;
    auto model = std::make_unique<TriangleCloth>(garment, fabrics);
    const TriangleCloth& energy = *model;
    auto problem = free_cloth(std::move(model), node_masses(garment, fabrics), pinned, options.projected);
    if (method == Method::xpbd) return std::make_unique<XpbdStepper>(std::move(problem), energy, response, step);
    return std::make_unique<ImplicitStepper>(std::move(problem), response, step);
}

std::unique_ptr<Stepper> projective_stepper(const Garment& garment, const std::vector<Fabric>& fabrics,
                                            const std::vector<char>& pinned, Response& response, StepOptions step,
                                            const MethodOptions& options) {
    if (options.time_step > 0) step.time_step = options.time_step;
    auto model = std::make_unique<ProjectiveCloth>(garment, fabrics);
    const ProjectiveCloth& energy = *model;
    auto problem = free_cloth(std::move(model), node_masses(garment, fabrics), pinned);
    return std::make_unique<ProjectiveStepper>(std::move(problem), energy, response, step);
}

std::unique_ptr<Stepper> inextensible_stepper(const Garment& garment, const std::vector<Fabric>& fabrics,
                                              const std::vector<char>& pinned, Response& response, StepOptions step,
                                              const MethodOptions& options) {
    step.time_step = options.time_step > 0 ? options.time_step : inextensible_step;
    auto cloth = std::make_unique<YarnCloth>(garment, fabrics, yarn_edges(garment));
    Tension& tension = cloth->tension;
    auto problem = free_cloth(std::move(cloth), node_masses(garment, fabrics), pinned);
    return std::make_unique<InextensibleStepper>(std::move(problem), tension, response, step);
}

std::unique_ptr<Stepper> nonconforming_stepper(const Garment& garment, const std::vector<Fabric>& fabrics,
                                               const std::vector<char>& pinned, Response& response, StepOptions step,
                                               const MethodOptions& options) {
    if (options.time_step > 0) step.time_step = options.time_step;
    return std::make_unique<NonconformingStepper>(garment, fabrics, node_masses(garment, fabrics), pinned, response, step);
}

} // namespace

const std::vector<Method>& all_methods() {
    static const std::vector<Method> all{Method::equilibrium, Method::springs_explicit, Method::springs_implicit,
                                         Method::springs_biphasic, Method::springs_limited, Method::triangles,
                                         Method::projective, Method::xpbd, Method::inextensible, Method::nonconforming};
    return all;
}

const char* to_string(Method m) {
    switch (m) {
    case Method::equilibrium: return "equilibrium";
    case Method::springs_explicit: return "springs-explicit";
    case Method::springs_implicit: return "springs-implicit";
    case Method::springs_biphasic: return "springs-biphasic";
    case Method::springs_limited: return "springs-limited";
    case Method::triangles: return "triangles";
    case Method::projective: return "projective";
    case Method::xpbd: return "xpbd";
    case Method::inextensible: return "inextensible";
    case Method::nonconforming: return "nonconforming";
    }
    return "equilibrium";
}

Method method_called(const std::string& name) {
    std::string names;
    for (const Method m : all_methods()) {
        if (name == to_string(m)) return m;
        names += (names.empty() ? "" : ", ") + std::string(to_string(m));
    }
    throw std::invalid_argument("there is no method '" + name + "', the methods are " + names);
}

std::unique_ptr<Stepper> make_stepper(Method method, const Garment& garment, const std::vector<Fabric>& fabrics,
                                      const std::vector<char>& pinned, Response& response, const StepOptions& step,
                                      const MethodOptions& options) {
    switch (method) {
    case Method::springs_explicit:
    case Method::springs_implicit:
    case Method::springs_biphasic:
    case Method::springs_limited:
        return spring_stepper(method, garment, fabrics, pinned, response, step, options);
    case Method::triangles:
    case Method::xpbd: return triangle_stepper(method, garment, fabrics, pinned, response, step, options);
    case Method::projective: return projective_stepper(garment, fabrics, pinned, response, step, options);
    case Method::inextensible: return inextensible_stepper(garment, fabrics, pinned, response, step, options);
    case Method::nonconforming: return nonconforming_stepper(garment, fabrics, pinned, response, step, options);
    case Method::equilibrium: break;
    }
    throw std::invalid_argument(std::string("the method ") + to_string(method) + " has no steps in time");
}

} // namespace toile

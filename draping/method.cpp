// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/method.h"

#include "draping/cloth.h"
#include "draping/energy/spring_mesh.h"
#include "draping/energy/triangles.h"
#include "draping/energy/yarns.h"
#include "draping/nonconforming/midpoint_cloth.h"
#include "draping/solve/free_cloth.h"
#include "draping/solve/implicit.h"
#include "draping/solve/inextensible.h"
#include "draping/solve/limited.h"
#include "draping/solve/nonconforming.h"
#include "draping/solve/projective.h"
#include "draping/solve/xpbd.h"
#include "geometry/named.h"

#include <algorithm>
#include <stdexcept>

namespace toile {

namespace {

constexpr double line_stiffness = 1e4; // N/m, of yarns before their tension has taken it up
constexpr double inextensible_step = 5e-4; // s: lines that the body stretches pull with a hundred times what hangs from them

std::vector<Spring> springs_of(Method method, const Garment& garment, const std::vector<Fabric>& fabrics,
                               const MethodOptions& options) {
    return mesh_springs(garment, fabrics,
                        {options.damping_time, method == Method::springs_biphasic ? options.beyond : 1});
}

/// What a stepper is made of beside the model.
struct Steps {
    Method method;
    const Garment& garment;
    const std::vector<Fabric>& fabrics;
    const std::vector<char>& pinned;
    Response& response;
    StepOptions step;
    const MethodOptions& options;

    template <class Model> std::unique_ptr<NodeProblem> problem(std::unique_ptr<Model> model) const {
        const bool projected = method != Method::triangles || options.projected;
        auto cloth = std::make_unique<FreeCloth>(std::move(model), node_masses(garment, fabrics), projected);
        for (std::size_t i = 0; i < pinned.size(); ++i)
            if (pinned[i]) cloth->pin(int(i));
        return cloth;
    }

    std::unique_ptr<Stepper> implicit() const {
        return std::make_unique<ImplicitStepper>(problem(make_energy(method, garment, fabrics, options)), response, step);
    }

    std::unique_ptr<Stepper> explicit_steps(StepOptions whole) const {
        const std::vector<Spring> springs = springs_of(method, garment, fabrics, options);
        auto cloth = problem(std::make_unique<Springs>(springs));
        std::unique_ptr<ExplicitStepper> stepper;
        if (method == Method::springs_limited)
            stepper = std::make_unique<LimitedStepper>(std::move(cloth), springs, response, whole, options.limits);
        else
            stepper = std::make_unique<ExplicitStepper>(std::move(cloth), response, whole);
        stepper->substep = options.time_step;
        return stepper;
    }

    std::unique_ptr<Stepper> xpbd() const {
        auto model = std::make_unique<TriangleCloth>(garment, fabrics);
        const TriangleCloth& energy = *model;
        return std::make_unique<XpbdStepper>(problem(std::move(model)), energy, response, step);
    }

    std::unique_ptr<Stepper> projective() const {
        auto model = std::make_unique<ProjectiveCloth>(garment, fabrics);
        const ProjectiveCloth& energy = *model;
        return std::make_unique<ProjectiveStepper>(problem(std::move(model)), energy, response, step);
    }

    std::unique_ptr<Stepper> inextensible() const {
        auto model = std::make_unique<YarnCloth>(garment, fabrics, yarn_edges(garment));
        Tension& tension = model->tension;
        return std::make_unique<InextensibleStepper>(problem(std::move(model)), tension, response, step);
    }

    std::unique_ptr<Stepper> nonconforming() const {
        return std::make_unique<NonconformingStepper>(garment, fabrics, node_masses(garment, fabrics), pinned, response, step);
    }
};

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
    return named(name, all_methods(), "method", "methods");
}

bool settles(Method m) {
    switch (m) {
    case Method::equilibrium:
    case Method::springs_implicit:
    case Method::springs_biphasic:
    case Method::triangles:
    case Method::projective:
    case Method::inextensible:
    case Method::nonconforming: return true;
    case Method::springs_explicit:
    case Method::springs_limited:
    case Method::xpbd: break;
    }
    return false;
}

bool has_curves(Method m) {
    return m == Method::equilibrium || m == Method::triangles || m == Method::xpbd;
}

bool has_damping(Method m) {
    return m == Method::springs_explicit || m == Method::springs_implicit || m == Method::springs_biphasic ||
           m == Method::springs_limited || m == Method::triangles;
}

std::unique_ptr<Energy> make_energy(Method method, const Garment& garment, const std::vector<Fabric>& fabrics,
                                    const MethodOptions& options) {
    switch (method) {
    case Method::equilibrium: return std::make_unique<SheetEnergy>(make_sheet(garment, fabrics));
    case Method::springs_implicit:
    case Method::springs_biphasic: return std::make_unique<Springs>(springs_of(method, garment, fabrics, options));
    case Method::triangles: return std::make_unique<TriangleCloth>(garment, fabrics, options.damping_time);
    case Method::projective: return std::make_unique<ProjectiveCloth>(garment, fabrics);
    case Method::inextensible: {
        auto yarns = std::make_unique<YarnCloth>(garment, fabrics, yarn_edges(garment));
        yarns->tension.stiffness.assign(yarns->tension.lines().size(), line_stiffness);
        return yarns;
    }
    case Method::nonconforming: return std::make_unique<MidpointCloth>(garment, fabrics);
    case Method::springs_explicit:
    case Method::springs_limited:
    case Method::xpbd: break;
    }
    throw std::invalid_argument(std::string("the method ") + to_string(method) + " finds no rest by its energy");
}

std::unique_ptr<Stepper> make_stepper(Method method, const Garment& garment, const std::vector<Fabric>& fabrics,
                                      const std::vector<char>& pinned, Response& response, const StepOptions& step,
                                      const MethodOptions& options) {
    Steps steps{method, garment, fabrics, pinned, response, step, options};
    if (options.time_step > 0) steps.step.time_step = options.time_step;
    StepOptions whole = step; // of explicit methods, in substeps as they are given
    whole.time_step = std::max(step.time_step, options.time_step);
    if (method == Method::inextensible && !(options.time_step > 0)) steps.step.time_step = inextensible_step;
    switch (method) {
    case Method::springs_implicit:
    case Method::springs_biphasic:
    case Method::triangles: return steps.implicit();
    case Method::springs_explicit:
    case Method::springs_limited: return steps.explicit_steps(whole);
    case Method::xpbd: return steps.xpbd();
    case Method::projective: return steps.projective();
    case Method::inextensible: return steps.inextensible();
    case Method::nonconforming: return steps.nonconforming();
    case Method::equilibrium: break;
    }
    throw std::invalid_argument(std::string("the method ") + to_string(method) + " has no steps in time");
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "draping/chart/scene.h"
#include "draping/contact/response.h"
#include "draping/method.h"

namespace toile {

struct SceneRestOptions {
    Method method = Method::equilibrium;
    double time_step = 0;    ///< s, of a method that moves; 0: its own
    double tolerance = 1e-3; ///< residual at rest, as NodeProblem::residual() measures it
    double max_seconds = 20; ///< of processor time
    int max_iterations = 3000; ///< of Newton's steps
};

struct SceneRest {
    Points x;
    double residual = 0;
    std::string failure; ///< why it is not at rest, a few words; empty: it is
    bool out_of_time = false; ///< that is why
};

/// Brings a scene to rest as `toile drape` would with this method and the barrier: by Newton's steps, or by a motion that air slows.
SceneRest rest_of(const SceneCloth& cloth, const SceneRestOptions& options);

/// That the process has used so far, on all threads.
double processor_seconds();

/// Of cloth with the body of its scene and not with itself, as hard as in a drape.
ContactOptions scene_contact(const SceneCloth& cloth);

/// Of cloth that meets nothing, itself included.
std::unique_ptr<Response> no_response(const Garment& garment);

/// The method whose Newton's steps find the rest that this one's motion tends to; itself for one that settles.
Method newton_twin(Method method);

} // namespace toile

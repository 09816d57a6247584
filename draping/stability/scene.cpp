// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/stability/scene.h"

#include "draping/stability/strip.h"

namespace toile {

std::vector<StabilityScene> stability_scenes() {
    return {close_scene(),
            swing_scene(Method::springs_explicit),
            swing_scene(Method::springs_implicit),
            compressed_scene(Method::springs_implicit),
            swing_scene(Method::springs_biphasic),
            swing_scene(Method::springs_limited),
            overstretched_scene(ChainOrder::from_held_end),
            overstretched_scene(ChainOrder::from_free_end),
            swing_scene(Method::triangles),
            compressed_scene(Method::triangles),
            drawn_scene(),
            dropped_scene(),
            plucked_scene(Method::inextensible),
            plucked_scene(Method::nonconforming)};
}

} // namespace toile

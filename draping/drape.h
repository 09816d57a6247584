// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "draping/accuracy.h"
#include "draping/contact/friction.h"
#include "draping/contact/response_kind.h"
#include "draping/landmarks.h"
#include "draping/measure.h"
#include "draping/method.h"
#include "draping/staging.h"
#include "draping/state.h"

#include <functional>
#include <optional>

namespace toile {

enum class DrapeStatus { converged, animated, stalled, limit, too_small, slid_off };

/// The word of the report: "converged", "animated", "stalled", "limit", "too_small", "slid_off".
const char* to_string(DrapeStatus status);

struct DrapeProgress {
    std::string stage;          ///< "place", "sew", "grow", "settle", ...
    int level = 0, levels = 1;
    double residual = 0;        ///< as in DrapeResult; infinity while unknown
    double done = 0;            ///< share of the whole, [0, 1], never decreasing
    double seconds_left = 0;    ///< estimate; infinity while unknown
};

/// Instead of coming to rest, the sewn garment is let go and moves in real time, from rest without weight on. Times of frames
/// are exact: steps are equal, a whole number of them to a frame.
struct AnimateOptions {
    double duration = 0;    ///< s; 0: the garment comes to rest instead
    double rate = 24;       ///< frames per second
    double air_damping = 1; ///< 1/s, share of the momentum that air takes
};
int frame_count(const AnimateOptions& options); ///< with the first, at time 0

struct DrapeOptions {
    double tolerance = 1e-3;        ///< residual to reach; see DrapeResult::residual
    double still = 0;               ///< m; a residual of 1 is enough when the last full step moved no node farther than this
    double clearance = 0.5e-3;      ///< m, distance from the body below which contact acts
    double friction = -1;           ///< Coulomb coefficient on the body; negative: the largest of the fabrics'
    double cloth_friction = -1;     ///< of cloth on cloth; the same
    double gravity = 9.81;          ///< m/s2, along -y
    /// What levels come to rest by, and with. Placing and sewing always have equilibrium and the barrier, so that they start
    /// without crossings. No response: the barrier.
    Method method = Method::equilibrium;
    MethodOptions method_options;
    std::optional<ContactResponse> contact;
    bool self_contact = true;       ///< of the cloth with itself once it is sewn; without it, cloth may cross itself
    AnimateOptions animation;
    int max_iterations = 5000;      ///< Newton iterations, or eight steps of a motion each, on all levels together
    double max_seconds = 1e9;       ///< wall time after which the state reached is returned with status limit
    double max_memory = 1e18;       ///< bytes of the process; the same happens when they or the next level come near
    std::vector<std::string> hold;  ///< edges whose hooks stay on to the end: words of labels_called()
    Points from;                    ///< when not empty: node positions of the closed garment to start from
    /// Called often (at least every two seconds); returns false to stop with the state reached.
    std::function<bool(const DrapeProgress&)> progress;
};

inline bool is_animated(const DrapeOptions& options) { return options.animation.duration > 0; }

struct LevelReport {
    double edge_length = 0;
    int vertices = 0;
    int iterations = 0;      ///< Newton iterations, or steps of a motion
    int part_iterations = 0; ///< of parts that still moved, between those of all the cloth
    int factorisations = 0;
    double seconds = 0;
};

struct StageSeconds {
    std::string stage;
    double seconds = 0;
};

struct BarrierReport {
    double distance = 0;  ///< m, below which contact acts
    double stiffness = 0; ///< Pa/m: pressure per depth below `distance` near it
    double cloth_stiffness = 0; ///< Pa/m, the same between cloth and cloth
};

/// What met what, and what was promised of it.
struct ContactReport {
    ContactResponse response = ContactResponse::barrier;
    Guarantee guarantee = Guarantee::none; ///< that held to the end: none when the start of a level crossed something,
    int unresolved = 0;                    ///< or a pair touched in a step, as in so many
    double seconds = 0;                    ///< wall time of contact, part of that of the stages
};

/// How the frames of a motion came about.
struct MotionReport {
    double rate = 0;        ///< frames per second
    double air_damping = 0; ///< 1/s
    double most_speed = 0;  ///< m/s; nothing may move faster
    double time_step = 0;   ///< s
    int steps_per_frame = 0;
    int frames = 0;         ///< recorded, with the first
    int steps = 0;          ///< made
    int slowed = 0;         ///< of them in which something would have moved faster
    double speed = 0;       ///< m/s, of the fastest node at the end
};

/// The response that acts: the barrier, of an animation impulses, unless another is named. Throws std::invalid_argument when
/// the barrier is asked for with an animation.
ContactResponse response_of(const DrapeOptions& options);
/// Whether the cloth moves in time.
bool moves(const DrapeOptions& options);

/// A drape and by how much it met each promise.
struct DrapeResult {
    Garment garment;   ///< finest level, seams closed
    State state;       ///< its node positions
    DrapeStatus status = DrapeStatus::stalled;
    std::string where; ///< what blocked, slid or was too small, and its place on the garment; empty when converged
    /// Largest over nodes of the distance between the non-contact force and what contact can answer, over
    /// max(node's weight, a tenth of the mean node's weight).
    double residual = 0; ///< infinity when nothing was settled
    double tolerance = 0; ///< of the residual; 1 where DrapeOptions::still ended it
    double last_step = 0; ///< m, of the node that the last step to rest moved farthest; infinity when there was none
    double drawn_in = 0; ///< m, by which the body, drawn in where the cloth started in it, has not grown back
    FrictionCoefficients friction;
    Method method = Method::equilibrium;
    BarrierReport barrier;
    ContactReport contact;
    std::optional<MotionReport> motion;
    std::vector<Points> frames; ///< of an animation: the nodes at equal times, the last as in `state`
    std::vector<LevelReport> levels;
    std::vector<StageSeconds> seconds;
    std::vector<Landmark> landmarks; ///< of every labelled edge, by label
    std::optional<AccuracyReport> accuracy; ///< of a drape that was asked for to one
    std::vector<std::string> decisions; ///< what was modelled or left out, with the measure that justified it
    std::vector<std::string> warnings;
};

/// The triangles of the garment where it lies.
TriMesh surface(const DrapeResult& result);

/// Sews and drapes: sew, weld, grow, settle and refine on every level from coarse to fine, prove. A seam that
/// cannot be closed ends it: status stalled, and the garment is the coarsest, open where it would not close. `fabrics` has one
/// entry per panel. Throws std::runtime_error only for input that check() would have refused.
DrapeResult drape(const Staging& staging, const Avatar& avatar, const PanelFabrics& fabrics,
                  const DrapeOptions& options);
/// The same for stage(pattern, flat).
DrapeResult drape(const Pattern& pattern, const FlatPattern& flat, const Avatar& avatar, const PanelFabrics& fabrics,
                  const DrapeOptions& options);

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What a cloth that moves does where it meets the body or itself: the answers of the literature, as named
// alternatives to the barrier. Each takes the velocities that the cloth would have without contact and corrects
// them; it knows nothing of what the cloth is made of or how its steps are solved. docs/responses.md has the formulas
// and says what each cannot do.

#include "draping/contact/contact.h"
#include "draping/contact/response_kind.h"

#include <memory>

namespace toile {

struct ResponseOptions {
    double thickness = 0.5e-3;  ///< m, kept between the cloth and what it touches
    double body_friction = 0.3; ///< Coulomb coefficient of cloth on body
    double cloth_friction = 0.3; ///< of cloth on cloth
    bool self = true;           ///< contact of the cloth with itself

    double stiffness = 1;         ///< N/m, of a penalty spring and of the springs of repulsions
    double separation_share = 0.5; ///< of a penalty spring's force while what it holds apart separates, [0, 1]
    double normal_damping = 0;    ///< N s/m of a penalty contact along its normal
    double tangential_damping = 1e-2; ///< and along the surface, up to the Coulomb limit
    double depth = 0.01;          ///< m in the body to which a penalty contact still finds its way out

    int repulsion_sweeps = 8;  ///< at most, over the pairs nearer than the thickness
    int impulse_sweeps = 20;   ///< at most, over impacts, before rigid zones take over
    int zone_rounds = 100;     ///< at most
};

/// One step as a response sees it. The cloth moves on straight lines, from `x` by dt times the velocities in question.
struct ResponseStep {
    double dt = 0;                            ///< s
    const Points& x;                          ///< at the start of the step
    const Points& start_velocity;             ///< m/s, then
    const std::vector<double>& inverse_mass;  ///< 1/kg per node; 0: nothing moves it from the candidate's velocity
    const Points& body_end;                   ///< where the body's points are at the end; they move there on lines
};

/// Cloth on the body: a pair of which one side is cloth. What touches is the place of the barycentric weights on
/// either side; forces on it are shared out by the same weights.
struct Touch {
    std::array<int, 4> point{};     ///< nodes, and points of the body from the node count on
    std::array<double, 4> weight{}; ///< the vector between the places is the sum of weight x
    Vec3 normal = Vec3::Zero();     ///< unit, along which the force pushes
    Vec3 force = Vec3::Zero();      ///< N, mean of the step; `weight` times it acts on each node
    bool edge_edge = false;
    bool welded = false;            ///< held in every direction, whatever friction can bear, while the force pushes
};

struct ResponseDone {
    /// Pairs near the body that hold the cloth up, while they do not pull; one may be without force. Sorted by points.
    std::vector<Touch> touches;
    Points other_force;   ///< N per node, mean of the step, of all other contact
    int held = 0;         ///< nodes that constraints hold
    int repulsions = 0;   ///< pairs pushed apart before they met
    int repulsion_sweeps = 0; ///< over them
    int impulses = 0;     ///< given to pairs that would have met
    int sweeps = 0;       ///< over them
    int zones = 0, zone_nodes = 0; ///< moved as rigid bodies
    int unresolved = 0;   ///< pairs that touch for all that, by exact arithmetic; above 0 a guarantee is gone
};

/// Order of touches; of one pair are those of which neither comes first.
bool before(const Touch& a, const Touch& b);

class Response {
public:
    virtual ~Response() = default;

    /// Corrects the candidate velocities `v` (per node, m/s) of the step; the body is then where the step ends.
    virtual ResponseDone respond(const ResponseStep& step, Points& v) = 0;

    virtual Guarantee guarantee() const = 0;
    /// Its forces depend on the start of the step alone: a solver may have them before it finds the candidates.
    virtual bool known_at_start() const { return false; }
    /// Its forces, all in other_force, are those of a balance at the end of the step: a stepper should hold them in the next
    /// one, and take them back before the response acts anew.
    virtual bool lasts() const { return false; }
    virtual const Points& body() const = 0; ///< where its points are
    virtual const ResponseOptions& options() const = 0;
};

/// Anything but the barrier, which has to be solved for (std::invalid_argument; see solve/barrier_response.h). A start that crosses the
/// body or itself voids the guarantee.
std::unique_ptr<Response> make_response(ContactResponse response, ContactCloth cloth, const TriMesh& body,
                                        const ResponseOptions& options);

} // namespace toile

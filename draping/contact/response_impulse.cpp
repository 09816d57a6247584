// SPDX-License-Identifier: GPL-3.0-or-later
// Impulses: Bridson, Fedkiw, Anderson: Robust Treatment of Collisions, Contact and Friction for Cloth Animation, 2002.
#include "draping/contact/response_impulse.h"

#include "draping/contact/rigid_zones.h"

#include <algorithm>
#include <limits>

namespace toile {

namespace {

constexpr double reach_share = 1.25; // of the thickness, within which a node counts as on the body
constexpr double part = 0.1;         // of what is missing to the thickness, that springs give back in a step
constexpr double still = 1e-6;       // m/s, below which pairs do not approach

class Impulses final : public Response {
public:
    Impulses(ContactCloth cloth, const TriMesh& body, const ResponseOptions& options, bool zones_only)
        : options_(options), zones_only_(zones_only),
          contact_(pair_finder(std::move(cloth), body, reach_share * options.thickness,
                               reach_share * options.thickness, options.self)) {
        if (zones_only) options_.body_friction = std::numeric_limits<double>::infinity(); // it welds
    }

    ResponseDone respond(const ResponseStep& step, Points& v) override {
        StepPairs pairs(contact_, step, options_, v);
        ResponseDone done;
        if (!zones_only_) {
            repel(pairs, step.dt, done);
            stop_impacts(pairs, done);
        }
        resolve_by_zones(pairs, step, v, options_.zone_rounds, done);
        pairs.finish(done, true);
        return done;
    }

    Guarantee guarantee() const override { return Guarantee::no_crossing; }
    const Points& body() const override { return contact_.body(); }
    const ResponseOptions& options() const override { return options_; }

private:
    /// Pairs nearer than the thickness do not approach, and are pushed a tenth of the way out of it.
    void repel(StepPairs& pairs, double dt, ResponseDone& done) const {
        const std::vector<ActivePair> near = pairs.near();
        for (int sweep = 0; sweep < options_.repulsion_sweeps; ++sweep) {
            bool moved = false;
            ++done.repulsion_sweeps;
            for (const ActivePair& a : near) {
                const double missing = pairs.pair(a.pair).distance / reach_share - a.geometry.d;
                const double mobility = pairs.mobility(a.pair, a.geometry);
                if (!(missing > 0 && mobility > 0 && a.geometry.d > 0)) continue;
                const double approach = -pairs.closing(a.pair, a.geometry).dot(a.geometry.normal);
                if (approach > 0) pairs.push_with_friction(a.pair, a.geometry, approach / mobility);
                moved = moved || approach > still;
                if (sweep > 0) continue;
                const double spring = std::clamp((part * missing / dt + std::min(approach, 0.0)) / mobility, 0.0,
                                                 dt * options_.stiffness * missing);
                const Vec3 friction = pairs.friction(a.pair, a.geometry, spring);
                pairs.push(a.pair, a.geometry, spring * a.geometry.normal + friction, false);
                done.repulsions += approach > 0 || spring > 0;
            }
            if (!moved) break;
        }
    }

    /// What would meet does not approach at the time when it would.
    void stop_impacts(StepPairs& pairs, ResponseDone& done) const {
        while (done.sweeps < options_.impulse_sweeps) {
            const std::vector<Impact> impacts = pairs.impacts();
            if (impacts.empty()) break;
            ++done.sweeps;
            for (const Impact& found : impacts) {
                const auto impact = pairs.impact(found.pair); // by what the impulses before it have left
                if (!impact) continue;
                const double mobility = pairs.mobility(impact->pair, impact->at);
                const double approach = -pairs.closing(impact->pair, impact->at).dot(impact->at.normal);
                if (!(approach > 0 && mobility > 0)) continue;
                pairs.push_with_friction(impact->pair, impact->at, approach / mobility);
                ++done.impulses;
            }
        }
    }

    ResponseOptions options_;
    bool zones_only_ = false;
    Contact contact_;
};

} // namespace

std::unique_ptr<Response> impulse_response(ContactCloth cloth, const TriMesh& body, const ResponseOptions& options) {
    return std::make_unique<Impulses>(std::move(cloth), body, options, false);
}

std::unique_ptr<Response> rigid_response(ContactCloth cloth, const TriMesh& body, const ResponseOptions& options) {
    return std::make_unique<Impulses>(std::move(cloth), body, options, true);
}

} // namespace toile

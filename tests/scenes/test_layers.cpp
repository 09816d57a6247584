// SPDX-License-Identifier: GPL-3.0-or-later
// Cloth over cloth: the layered garments of examples/, on the built-in form.
#include "draping/energy/hinge.h"
#include "geometry/bvh.h"
#include "geometry/distance.h"
#include "src/pipeline.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace toile;

namespace {

DrapeOutcome draped(const std::string& name) {
    DrapeJob job;
    job.pattern = TOILE_SOURCE_DIR "/examples/" + name + ".json";
    job.edge_length = 0.04;
    DrapeOutcome outcome = run_job(job);
    INFO(outcome.result.where);
    CHECK(outcome.result.status == DrapeStatus::converged);
    const Garment& g = outcome.result.garment;
    const IntersectionCount crossings =
        count_intersections(node_triangles(g), outcome.result.state.positions, outcome.body, g.stitches);
    CHECK(crossings.cloth_avatar == 0);
    CHECK(crossings.cloth_cloth == 0);
    return outcome;
}

/// The surface nearest to a point.
struct Foot {
    double distance = 0; ///< m
    Vec3 at;
};

class Surface {
public:
    explicit Surface(TriMesh mesh) : mesh_(std::move(mesh)), tree_(triangle_boxes(mesh_.points, mesh_.triangles, 0)) {}

    Foot nearest(const Vec3& p) const {
        const auto of = [&](int t) {
            const Triangle& k = mesh_.triangles[t];
            return nearest_point_triangle(p, mesh_.points[k[0]], mesh_.points[k[1]], mesh_.points[k[2]]);
        };
        double squared = std::numeric_limits<double>::infinity();
        const int t = tree_.nearest(p, squared, [&](int k) { return of(k).squared; });
        const Triangle& k = mesh_.triangles[t];
        const auto w = of(t).weight;
        return {std::sqrt(squared), w[1] * mesh_.points[k[0]] + w[2] * mesh_.points[k[1]] + w[3] * mesh_.points[k[2]]};
    }

private:
    TriMesh mesh_;
    Bvh tree_;
};

/// Of the nodes of layer 0 that lie under cloth of layer 1, at most a finger away, the share that are nearer to the
/// body than that cloth.
double share_in_order(const DrapeOutcome& outcome, int& under) {
    const Garment& g = outcome.result.garment;
    const Points& x = outcome.result.state.positions;
    TriMesh outer{x, {}};
    std::vector<char> inner(x.size(), 0);
    for (int t = 0; t < int(g.triangles.size()); ++t) {
        const bool outside = g.panel_layers[g.panel_of_triangle[t]] > 0;
        if (outside) outer.triangles.push_back(g.nodes(t));
        for (const int i : g.nodes(t)) inner[i] = inner[i] || !outside;
    }
    const Surface over(outer), body(outcome.body);
    int right = 0;
    under = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (!inner[i]) continue;
        const Foot cloth = over.nearest(x[i]);
        if (cloth.distance > 0.015) continue;
        ++under;
        right += body.nearest(x[i]).distance < body.nearest(cloth.at).distance + 1e-3;
    }
    return double(right) / under;
}

} // namespace

TEST_CASE("a hood lies over the head") {
    const DrapeOutcome outcome = draped("hooded_top");
    const Garment& g = outcome.result.garment;
    double highest = 0, head = 0;
    for (int t = 0; t < int(g.triangles.size()); ++t)
        if (g.panel_names[g.panel_of_triangle[t]] == "left_hood")
            for (const int i : g.nodes(t)) highest = std::max(highest, outcome.result.state.positions[i].y());
    for (const Vec3& p : outcome.body.points) head = std::max(head, p.y());
    CHECK(highest > head);
}

TEST_CASE("the outer layer lies over the inner one") {
    for (const std::string name : {"two_layer_skirt", "shirt_and_jacket"}) {
        INFO(name);
        int under = 0;
        CHECK(share_in_order(draped(name), under) > 0.98);
        CHECK(under > 100);
    }
}

TEST_CASE("a skirt falls in the pleats that were pressed into it") {
    const DrapeOutcome outcome = draped("pleated_skirt");
    const Garment& g = outcome.result.garment;
    const Points& x = outcome.result.state.positions;
    int creases = 0, folded = 0;
    for (const Hinge& h : hinges_of(g)) {
        if (!is_crease(g, h.edge)) continue;
        const auto& n = h.nodes;
        const double share = hinge_angle(n, x).value / g.rest.angles[h.edge];
        ++creases;
        folded += share > 0.5;
    }
    CHECK(creases > 300);
    CHECK(folded > 0.9 * creases);
}

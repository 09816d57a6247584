// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A square sheet of cotton that moves under gravity and meets a body.

#include "draping/cloth.h"
#include "draping/solve/implicit.h"
#include "tests/support/flat_mesh.h"
#include "tests/support/plain_fabric.h"

namespace toile::test {

inline Fabric cotton() { return plain_fabric(1000, 1e-5); }

/// Cloth without contact of its own, and a response.
struct DroppedSheet {
    Garment garment;
    Moving cloth;
    ClothProblem problem;
    std::unique_ptr<Response> response;
    ImplicitStepper stepper;
    StepOptions& options = stepper.options();

    /// Horizontal, its middle at `middle`.
    DroppedSheet(double side, double edge, const Vec3& middle, const TriMesh& body, ContactResponse kind,
                 const ResponseOptions& how = {})
        : DroppedSheet(jittered_rectangle(side, side, edge, 0.25, 7), side, middle, body, kind, how) {}

    DroppedSheet(const DroppedSheet&) = delete; // the stepper refers to the rest

    ResponseDone step_on(const Points& body_end) {
        return stepper.step(cloth, body_end);
    }
    ResponseDone step_on() { return step_on(Points(response->body())); }

    IntersectionCount crossings(const std::vector<Triangle>& body_triangles) const {
        return count_intersections(node_triangles(garment), cloth.x, {response->body(), body_triangles});
    }

private:
    DroppedSheet(const FlatMesh& mesh, double side, const Vec3& middle, const TriMesh& body, ContactResponse kind,
                 const ResponseOptions& how)
        : garment(garment_of(mesh)), problem(garment, {cotton()}, {}, {{1, 0, 0}, {1, 0, 0}, false}),
          response(make_response(kind, contact_cloth(garment), body, how)), stepper(problem, *response) {
        for (const Vec2& p : mesh.points) cloth.x.push_back(middle + Vec3(p.x() - side / 2, 0, side / 2 - p.y()));
        problem.gravity = 9.81;
    }
};

} // namespace toile::test

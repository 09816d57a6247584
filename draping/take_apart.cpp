// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/take_apart.h"

#include "draping/grow.h"
#include "geometry/solid.h"

namespace toile {

bool take_apart_or_leave_out(DrapeRun& run, Contact& contact) {
    const std::vector<Triangle> cloth = node_triangles(run.garment);
    const auto in_body = [&](const Points& x) { return count_intersections(cloth, x, run.body).cloth_avatar; };
    const Points before = run.x;
    const TangledCloth tangled = tangled_cloth(run.garment, run.edge_length());
    // A few crossings in a tight place need small motions, folds that lie in each other large ones. A level
    // starts with some of the cloth in the body, where fine triangles cut the curves of coarse ones.
    for (const UntangleOptions& how : {UntangleOptions{0.4, 8}, UntangleOptions{0.1, 2}}) {
        contact.leave_out({});
        const bool apart = take_apart(tangled, contact, run.x, how, run.facts.untangled);
        if (apart && (run.x == before || in_body(run.x) <= 2 * in_body(before))) return true;
        run.x = before;
    }
    contact.leave_out(tangle_of(tangled, contact, run.x));
    return false;
}

void clear_of_body(DrapeRun& run, ClothProblem& problem, Cholesky& factor) {
    const ContactOptions final = problem.contact().options();
    problem.contact().set_options(while_growing(final));
    const std::vector<Triangle> cloth = node_triangles(run.garment);
    const Points normals = vertex_normals(run.body);
    TriMesh drawn = run.body;
    double depth = 0;
    for (const double d : {0.0, 0.002, 0.005, 0.01, 0.02, 0.04}) {
        depth = d;
        for (std::size_t v = 0; v < drawn.points.size(); ++v) drawn.points[v] = run.body.points[v] - d * normals[v];
        problem.contact().set_body(drawn.points);
        if (problem.contact().violations(run.x).empty() &&
            count_intersections(cloth, run.x, drawn).cloth_avatar == 0)
            break;
    }
    double& deepest = run.facts.drawn_in[run.edge_length()];
    deepest = std::max(deepest, depth);
    run.begin("grow", 0);
    run.result.drawn_in = 0;
    if (depth > 0)
        run.result.drawn_in = grow_body(problem, run.body.points, run.x, grow_patience, [&](const SettleOptions& o) {
            run.settle_some(problem, run.x, factor, o);
            return !run.stopped;
        });
    problem.contact().set_options(final);
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/take_apart.h"

#include <algorithm>

namespace toile {

namespace {

constexpr double grow_distance = 2e-3; // m, contact distance while the body grows back
constexpr double grow_share = 0.5;     // of the way to the cloth that the body takes at once, lest it get stuck there

Points vertex_normals(const TriMesh& mesh) {
    Points n(mesh.points.size(), Vec3::Zero());
    for (const Triangle& t : mesh.triangles) {
        const Vec3 a = (mesh.points[t[1]] - mesh.points[t[0]]).cross(mesh.points[t[2]] - mesh.points[t[0]]);
        for (int i : t) n[i] += a;
    }
    for (Vec3& v : n) v.normalize();
    return n;
}

/// Lets the body grow on straight lines from where it is to its full size, pushing the cloth ahead of it.
/// Returns whether it got there.
bool grow(DrapeRun& run, ClothProblem& problem, Points& x, Cholesky& factor) {
    Contact& contact = problem.contact();
    SettleOptions o;
    o.tolerance = 1;
    o.max_iterations = 3;
    o.exact_below = 0;
    const Eigen::VectorXd still = Eigen::VectorXd::Zero(3 * problem.points());
    bool grown = false;
    for (int k = 0; k < 200 && !run.stopped && !grown; ++k) {
        Points motion(run.body.points.size());
        double longest = 0;
        for (std::size_t v = 0; v < motion.size(); ++v) {
            motion[v] = run.body.points[v] - contact.body()[v];
            longest = std::max(longest, motion[v].norm());
        }
        const double part = std::min(1.0, 2 * contact.options().body.distance / longest);
        for (Vec3& m : motion) m *= part;
        contact.prepare(x, still, &motion);
        double t = contact.feasible_step(x, still, &motion);
        if (t < 1) t *= grow_share;
        grown = part * t == 1;
        Points next = contact.body();
        for (std::size_t v = 0; v < motion.size(); ++v)
            next[v] = grown ? run.body.points[v] : Vec3(next[v] + t * motion[v]);
        contact.set_body(next);
        run.settle_some(problem, x, factor, o);
    }
    return grown;
}

/// Cloth that crosses itself after sewing, or only on the finer mesh, is taken apart before contact takes
/// over. Returns whether nothing crosses and nothing is too near.
bool take_apart(DrapeRun& run, Contact& contact, const UntangleOptions& how) {
    const TangledCloth tangled = tangled_cloth(run);
    for (int round = 0; round < 10; ++round) {
        const Untangled u = untangle(tangled, run.x, how);
        run.facts.untangled = std::max(run.facts.untangled, u.before);
        if (u.after > 0) return false;
        if (contact.widen(run.x) == 0 && find_crossings(tangled, run.x).empty()) return true;
    }
    return false;
}

/// What crosses or is too near is left out of contact with other cloth.
void leave_out_tangle(const DrapeRun& run, Contact& contact) {
    std::vector<char> tangle(run.garment.node_count, 0);
    const std::vector<Triangle> triangles = node_triangles(run.garment);
    for (const ClothCrossing& c : find_crossings(tangled_cloth(run), run.x)) {
        for (const int i : run.garment.edges.ends[c.edge]) tangle[i] = 1;
        for (const int i : triangles[c.triangle]) tangle[i] = 1;
    }
    contact.leave_out({});
    for (const ContactPair& p : contact.violations(run.x))
        if (!p.with_body)
            for (const int i : p.p) tangle[i] = 1;
    contact.leave_out(tangle);
}

} // namespace

TangledCloth tangled_cloth(const DrapeRun& run) {
    ContactCloth cloth = contact_cloth(run.garment);
    return {std::move(cloth.triangles), run.garment.edges, run.edge_length(), std::move(cloth.sewn_to_edge)};
}

bool take_apart_or_leave_out(DrapeRun& run, Contact& contact) {
    const std::vector<Triangle> cloth = node_triangles(run.garment);
    const auto in_body = [&](const Points& x) { return count_intersections(cloth, x, run.body).cloth_avatar; };
    const Points before = run.x;
    // A few crossings in a tight place need small motions, folds that lie in each other large ones. A level
    // starts with some of the cloth in the body, where fine triangles cut the curves of coarse ones.
    for (const UntangleOptions& how : {UntangleOptions{0.4, 8}, UntangleOptions{0.1, 2}}) {
        contact.leave_out({});
        if (take_apart(run, contact, how) && (run.x == before || in_body(run.x) <= 2 * in_body(before))) return true;
        run.x = before;
    }
    leave_out_tangle(run, contact);
    return false;
}

void clear_of_body(DrapeRun& run, ClothProblem& problem, Cholesky& factor) {
    const ContactOptions final = problem.contact().options();
    ContactOptions wide = final; // a body that grows pushes cloth along, the farther per step the wider
    wide.body.distance = std::max(final.body.distance, grow_distance);
    wide.body.stiffness *= final.body.distance / wide.body.distance;
    problem.contact().set_options(wide);
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
    run.grown = depth == 0;
    run.facts.drawn_in.push_back(depth);
    run.begin("grow", 0);
    run.grown = run.grown || grow(run, problem, run.x, factor);
    problem.contact().set_options(final);
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
// What cloth on edge midpoints costs and how well it bends, behind docs/nonconforming.md.
// bench_nonconforming [test ...] with tests out of: cantilever rest step drape. Default: all.

#include "bench/asked.h"
#include "draping/cloth.h"
#include "draping/method.h"
#include "draping/nonconforming/motion.h"
#include "draping/solve/stepper.h"

#include "tests/support/hanging_sheet.h"
#include "tests/support/midpoint_strip.h"

#include <cstdio>
#include <ctime>

using namespace toile;
using namespace toile::test;

namespace {

/// Of all threads together: other work on the machine does not count.
double cpu_seconds() {
    return double(std::clock()) / CLOCKS_PER_SEC;
}
double seconds_since(double start) {
    return cpu_seconds() - start;
}

/// Rivals: energies of jumps of the gradient, with clamps that are jumps to the mirror image.
enum class Jumps {
    across, ///< the Laplacian of the element with lumped mass: derivatives across the edge, 3 |e|^2 / (A1 +
            ///< A2)
    whole   ///< the whole jump, |e|^2 / (A1 + A2)
};

MidpointBending jump_bending(const Garment& garment, Jumps jumps) {
    std::vector<Eigen::Triplet<double>> entries;
    std::vector<Eigen::RowVector3d> offsets;
    for (int e = 0; e < garment.edges.size(); ++e) {
        const int first = garment.edges.first[e], count = garment.edges.triangles_at(e);
        const auto& [a, b] = garment.edges.ends[e];
        const bool wall = garment.uv[a].x() < 1e-12 && garment.uv[b].x() < 1e-12;
        if (count < 2 && !wall) continue;
        const Vec2 along = (garment.uv[b] - garment.uv[a]).normalized();
        const double length = (garment.uv[b] - garment.uv[a]).norm();
        double areas = 0;
        for (int i = 0; i < count; ++i)
            areas += rest_area(garment.rest.edges[garment.edges.incident[first + i]]);
        // A jump to the mirror image is twice that to the clamp, of two areas, and one of its halves is ours.
        const double factor = length * std::sqrt((jumps == Jumps::across ? 3.0 : 1.0) / areas);
        for (int component = 0; component < (jumps == Jumps::across ? 1 : 2); ++component) {
            const Vec2 direction = component == 0 ? Vec2(along.y(), -along.x()) : along;
            for (int i = 0; i < count; ++i) {
                const int t = garment.edges.incident[first + i];
                const Mat2 inverse = garment.rest.edges[t].inverse();
                const Vec2 one = inverse.row(0), two = inverse.row(1);
                const std::array<Vec2, 3> gradient{Vec2(-one - two), one, two};
                for (int k = 0; k < 3; ++k)
                    entries.emplace_back(int(offsets.size()), garment.edges.of_triangle[t][k],
                                         (i == 0 ? -2 : 2) * factor * gradient[k].dot(direction));
            }
            offsets.push_back(wall ? Eigen::RowVector3d(-factor * direction.x(), -factor * direction.y(), 0)
                                   : Eigen::RowVector3d::Zero());
        }
    }
    MidpointBending bending;
    bending.rows.resize(offsets.size(), garment.edges.size());
    bending.rows.setFromTriplets(entries.begin(), entries.end());
    bending.offset.resize(offsets.size(), 3);
    for (std::size_t i = 0; i < offsets.size(); ++i)
        bending.offset.row(i) = offsets[i];
    bending.stiffness = bending.rows.transpose() * bending.rows;
    return bending;
}

void cantilever() {
    for (const char* name : {"shared slopes", "Laplacian", "whole jumps"})
        for (MeshKind kind : {MeshKind::aligned, MeshKind::alternating, MeshKind::unstructured}) {
            const char* of_kind[] = {"aligned", "alternating", "unstructured"};
            std::printf("%s, %s:", name, of_kind[int(kind)]);
            for (const auto& [gamma, slope] :
                 {std::pair{1.0, 0.12456176644}, {10.0, 1.06680232}, {100.0, 5.8881046}})
                for (int along : {14, 28, 56}) {
                    const FlatMesh mesh = strip_mesh(kind, 1, 0.25, along);
                    const Garment garment = garment_of(mesh);
                    NonconformingCloth cloth = make_nonconforming_cloth(
                        garment, {sheet_fabric(1, 1)}, level_clamps(edges_at_wall(mesh, garment)));
                    if (name[0] != 's')
                        cloth.bending = jump_bending(garment, name[0] == 'L' ? Jumps::across : Jumps::whole);
                    const Cantilever c = hang(mesh, gamma, cloth);
                    std::printf(" %+.2f%s", 100 * (c.drop_over_reach / slope - 1),
                                c.result.end == IsometricEnd::settled ? "" : "?");
                    std::fflush(stdout);
                }
            std::printf(" %% (gamma 1, 10, 100; n 14, 28, 56 each)\n");
        }
}

/// The sheet of hang_sheet(), which hangs by two corners.
struct HungCloth {
    FlatMesh mesh;
    Garment garment;
    Points start;
    std::vector<GhostSpring> pins;
};

HungCloth sheet(double edge) {
    const double side = 0.5, apart = 0.8;
    HungCloth s;
    s.mesh = jittered_rectangle(side, side, edge, 0.25, 1);
    s.garment = garment_of(s.mesh);
    Random random(1);
    for (const Vec2& p : s.mesh.points) {
        const double across = p.x() - side / 2;
        s.start.push_back(
            Vec3(apart * across, p.y() - side, std::sqrt(1 - apart * apart) * (side / 2 - std::abs(across))) +
            random.vec3(1e-4));
    }
    for (int i = 0; i < s.garment.node_count; ++i)
        if (s.mesh.points[i].y() == side && std::abs(s.mesh.points[i].x() - side / 2) == side / 2)
            s.pins.push_back({i, {apart * (s.mesh.points[i].x() - side / 2), 0, 0}, 1e4});
    return s;
}

const Vec3 gravity(0, -9.81, 0);

void rest() {
    // To rest on the coarse mesh alone: of the others the cost of an iteration.
    for (const auto& [edge, most] : {std::pair{0.025, 1000}, {0.0162, 30}, {0.0080, 8}}) {
        const HungCloth s = sheet(edge);
        double start = cpu_seconds();
        const NonconformingCloth cloth = make_nonconforming_cloth(s.garment, {sheet_fabric(0.15, 1e-5)});
        const IsometricProblem problem = problem_of(cloth, gravity, {}, s.pins);
        Saddle saddle(problem.stiffness, problem.bars, problem.held);
        const double made = seconds_since(start);
        Points x = midpoints_of(s.garment, s.start);
        start = cpu_seconds();
        const bool isometric = make_isometric(saddle, problem, x);
        const double projected = seconds_since(start);
        IsometricOptions options;
        options.tolerance = 1e-4 * 0.15 * 0.25 * 9.81 / x.size();
        options.max_iterations = most;
        start = cpu_seconds();
        const IsometricResult r = settle_isometric(saddle, problem, x, options);
        const double settled = seconds_since(start);
        double drop = 0;
        for (const Vec3& p : ghost_nodes(cloth.midpoints, x))
            drop = std::max(drop, -p.y());
        std::printf("%d nodes, %zu midpoints: made in %.2f s, %s in %.2f s, end %d after %d iterations, %d "
                    "factorisations, "
                    "%.2f s (%.0f ms per iteration); drop %.1f mm, strain %.1e\n",
                    s.garment.node_count, x.size(), made, isometric ? "isometric" : "NOT ISOMETRIC",
                    projected, int(r.end), r.iterations, r.factorisations, settled,
                    1e3 * settled / std::max(1, r.iterations), 1e3 * drop,
                    largest_triangle_strain(s.garment, x));
        std::fflush(stdout);
        for (double stiffness : {1e3, 1e5}) {
            start = cpu_seconds();
            const HungSheet h = hang_sheet(edge, 1, {stiffness})[0];
            const double seconds = seconds_since(start);
            std::printf("  default equilibrium, %.0e N/m: %s after %d iterations, %.2f s (%.0f ms per "
                        "iteration); drop %.1f mm\n",
                        stiffness, h.settled ? "settled" : "NOT SETTLED", h.iterations, seconds,
                        1e3 * seconds / h.iterations, 1e3 * h.drop);
            std::fflush(stdout);
        }
    }
}

/// Steps to the last digits, and steps of one iteration as the method has them.
void step() {
    for (double edge : {0.025, 0.0162, 0.0080})
        for (const bool whole : {true, false}) {
            const HungCloth s = sheet(edge);
            MotionHolds holds;
            for (const GhostSpring& pin : s.pins) holds.nodes.push_back(pin.node);
            const NonconformingCloth cloth = make_nonconforming_cloth(s.garment, {sheet_fabric(0.15, 1e-5)});
            Motion motion = whole && edge > 0.01 ? start_motion(cloth, s.garment, s.start, holds)
                                                 : place_motion(cloth, s.garment, s.start, holds);
            MotionOptions options;
            options.time_step = whole ? 5e-3 : 2e-3;
            if (!whole) {
                options.max_iterations = 1;
                options.drawn_in = 1e-3;
                options.damping = 10;
            }
            int iterations = 0, factorisations = 0, failed = 0;
            const double start = cpu_seconds();
            const int steps = whole ? 5 : 20;
            for (int i = 0; i < steps; ++i) {
                const MotionStep done = try_step(motion, gravity, {}, options);
                iterations += done.iterations;
                factorisations += done.factorisations;
                failed += done.end != IsometricEnd::settled;
                finish_step(motion, options);
            }
            std::printf("%d nodes: %.1f ms per step of %.0f ms, %.1f iterations, %.1f of conjugate gradients in each%s\n",
                        s.garment.node_count, 1e3 * seconds_since(start) / steps, 1e3 * options.time_step,
                        double(iterations) / steps, double(motion.solver->linear_iterations()) / std::max(1, factorisations),
                        whole && failed ? ", NOT ALL SETTLED" : "");
            std::fflush(stdout);
        }
}

/// The hung sheet from its rough start to rest by the method.
void drape() {
    for (double edge : {0.025, 0.0162}) {
        const HungCloth s = sheet(edge);
        std::vector<char> pinned(s.garment.node_count, 0);
        for (const GhostSpring& pin : s.pins) pinned[pin.node] = 1;
        const auto response = make_response(ContactResponse::impulse, contact_cloth(s.garment), {}, {});
        const std::vector<Fabric> fabrics{sheet_fabric(0.15, 1e-5)};
        const auto stepper = make_stepper(Method::nonconforming, s.garment, fabrics, pinned, *response, {2e-3, 10, 5e-3}, {});
        stepper->loads().gravity = 9.81;
        Moving cloth{s.start};
        RestOptions rest;
        rest.max_steps = 3000;
        const double start = cpu_seconds();
        const RestResult r = come_to_rest(*stepper, cloth, {}, rest);
        double drop = 0;
        for (const Vec3& p : cloth.x) drop = std::max(drop, -p.y());
        std::printf("%d nodes: %s after %d steps, %.2f s, contact with itself %.2f s of it by the clock; drop %.1f mm, strain %.1e\n",
                    s.garment.node_count, r.rested ? "at rest" : "NOT AT REST", r.steps, seconds_since(start),
                    cloth.contact.seconds(), 1e3 * drop, *stepper->kept_strain());
        std::fflush(stdout);
    }
}

} // namespace

int main(int count, char** words) {
    if (asked(count, words, "cantilever")) cantilever();
    if (asked(count, words, "rest")) rest();
    if (asked(count, words, "step")) step();
    if (asked(count, words, "drape")) drape();
}

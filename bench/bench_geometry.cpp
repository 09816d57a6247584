// SPDX-License-Identifier: GPL-3.0-or-later
// Speed of the geometry that contact, proof and measures stand on: best of five runs.
#include "draping/compare.h"
#include "draping/measure.h"
#include "geometry/bvh.h"
#include "geometry/distance.h"
#include "geometry/edges.h"
#include "geometry/intersections.h"
#include "geometry/parallel.h"
#include "geometry/toi.h"
#include "tests/support/random.h"
#include "tests/support/surfaces.h"

#include <algorithm>
#include <chrono>
#include <cstdio>

using namespace toile;

namespace {

double checksum = 0; ///< keeps the compiler from leaving the work out

void print(const char* what, double value, const char* unit) {
    std::printf("  %-52s %10.3f %s\n", what, value, unit);
}

/// Seconds times `scale`, of work() that returns a number.
template <class Work> void timed(const char* what, double scale, const char* unit, Work&& work) {
    double best = 1e30;
    for (int k = 0; k < 5; ++k) {
        const auto start = std::chrono::steady_clock::now();
        checksum += work();
        const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
        best = std::min(best, elapsed.count());
    }
    print(what, scale * best, unit);
}

void bench_tree(const TriMesh& cloth, const TriMesh& body) {
    const auto boxes = triangle_boxes(body.points, body.triangles, 0.002);
    std::printf("%zu boxes of a body, %zu of a cloth, margin 2 mm\n", boxes.size(), cloth.triangles.size());
    Bvh tree, cloth_tree(triangle_boxes(cloth.points, cloth.triangles, 0.002));
    timed("build", 1e3, "ms", [&] {
        tree = Bvh(boxes);
        return tree.size();
    });
    timed("refit", 1e3, "ms", [&] {
        tree.refit(boxes);
        return tree.size();
    });
    int pairs = 0, own_pairs = 0;
    timed("tree against tree", 1e3, "ms", [&] {
        pairs = 0;
        cloth_tree.overlapping(tree, [&](int, int) { ++pairs; });
        return pairs;
    });
    print("  pairs", pairs, "");
    timed("a tree with itself", 1e3, "ms", [&] {
        own_pairs = 0;
        cloth_tree.overlapping_pairs([&](int, int) { ++own_pairs; });
        return own_pairs;
    });
    print("  pairs", own_pairs, "");
    timed("nearest triangle, per point", 1e9 / double(cloth.points.size()), "ns", [&] {
        double sum = 0;
        for (const Vec3& p : cloth.points) {
            double limit = 1;
            tree.nearest(p, limit, [&](int t) {
                const auto& [a, b, c] = body.triangles[t];
                return nearest_point_triangle(p, body.points[a], body.points[b], body.points[c]).squared;
            });
            sum += limit;
        }
        return sum;
    });
    timed("edge table", 1e3, "ms",
          [&] { return make_edges(body.triangles, int(body.points.size())).size(); });
}

void bench_proof(const TriMesh& cloth, const TriMesh& body) {
    std::puts("proof and measures of the same cloth and body");
    timed("intersections of cloth and body, exact", 1e3, "ms",
          [&] { return intersecting_pairs(cloth, body).size(); });
    timed("intersections of the cloth with itself, exact", 1e3, "ms",
          [&] { return self_intersecting_pairs(cloth).size(); });
    timed("clearance, proof included", 1e3, "ms",
          [&] { return clearance_min(cloth.triangles, cloth.points, body); });
    timed("comparison of the two surfaces", 1e3, "ms", [&] { return compare(cloth, body).rms; });
}

std::vector<Motion> random_motions(int n, double speed) {
    test::Random random(1);
    std::vector<Motion> motions(n);
    for (Motion& m : motions)
        for (int k = 0; k < 4; ++k) {
            m.x[k] = Vec3(1.2, 1.4, 0.1) + random.vec3(0.01);
            m.dx[k] = random.vec3(speed);
        }
    return motions;
}

void bench_pairs(double speed) {
    const std::vector<Motion> motions = random_motions(100000, speed);
    std::printf("random pairs within 1 cm that move by %g mm\n", 1e3 * speed);
    const auto per_pair = [&](const char* what, auto&& f) {
        timed(what, 1e9 / double(motions.size()), "ns", [&] {
            double sum = 0;
            for (const Motion& m : motions)
                sum += f(m);
            return sum;
        });
    };
    per_pair("point-triangle distance",
             [](const Motion& m) { return nearest_point_triangle(m.x[0], m.x[1], m.x[2], m.x[3]).squared; });
    per_pair("edge-edge distance",
             [](const Motion& m) { return nearest_edge_edge(m.x[0], m.x[1], m.x[2], m.x[3]).squared; });
    per_pair("point-triangle time of impact",
             [](const Motion& m) { return time_of_impact_point_triangle(m, {}); });
    per_pair("edge-edge time of impact", [](const Motion& m) { return time_of_impact_edge_edge(m, {}); });
}

void bench_parallel() {
    std::printf("parallel loop on %d threads\n", threads());
    timed("64 empty chunks", 1e6, "us", [] {
        parallel_for(64, 1, [](int, int) {});
        return 0;
    });
}

} // namespace

int main() {
    // A trunk of 51,000 triangles and a cloth of 20,000 a millimetre off it: everything is near.
    const TriMesh body = test::tube(0.2, 0.8, 300, 85);
    TriMesh cloth = test::tube(0.2011, 0.8, 126, 80);
    test::Random random(2);
    for (Vec3& p : cloth.points)
        p += random.vec3(2e-4); // not exactly flat anywhere, as cloth is not
    bench_tree(cloth, body);
    bench_proof(cloth, body);
    bench_pairs(0.001);
    bench_pairs(0.02);
    bench_parallel();
    return checksum == 0;
}

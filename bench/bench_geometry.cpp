// SPDX-License-Identifier: GPL-3.0-or-later
// Speed of the geometry that contact, proof and measures stand on.
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

#include <chrono>
#include <cstdio>

using namespace toile;

namespace {

template <class Work> double seconds(Work&& work) {
    double best = 1e30;
    for (int k = 0; k < 5; ++k) {
        const auto start = std::chrono::steady_clock::now();
        work();
        const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        if (s < best) best = s;
    }
    return best;
}

void line(const char* what, double value, const char* unit) { std::printf("%-58s %10.3f %s\n", what, value, unit); }

void bench_tree(const TriMesh& cloth, const TriMesh& body) {
    const auto boxes = triangle_boxes(body.points, body.triangles, 0.002);
    std::printf("%zu boxes of a body, %zu of a cloth, margin 2 mm\n", boxes.size(), cloth.triangles.size());
    Bvh tree, cloth_tree(triangle_boxes(cloth.points, cloth.triangles, 0.002));
    line("  build", 1e3 * seconds([&] { tree = Bvh(boxes); }), "ms");
    line("  refit", 1e3 * seconds([&] { tree.refit(boxes); }), "ms");
    long pairs = 0;
    line("  tree against tree", 1e3 * seconds([&] {
             pairs = 0;
             cloth_tree.overlapping(tree, [&](int, int) { ++pairs; });
         }), "ms");
    line("    pairs", double(pairs), "");
    line("  a tree with itself", 1e3 * seconds([&] {
             pairs = 0;
             cloth_tree.overlapping_pairs([&](int, int) { ++pairs; });
         }), "ms");
    line("    pairs", double(pairs), "");
    const int n = int(cloth.points.size());
    double sum = 0;
    line("  nearest triangle, per point", 1e9 / n * seconds([&] {
             for (const Vec3& p : cloth.points) {
                 double limit = 1;
                 tree.nearest(p, limit, [&](int t) {
                     const Triangle& k = body.triangles[t];
                     return nearest_point_triangle(p, body.points[k[0]], body.points[k[1]], body.points[k[2]])
                         .squared;
                 });
                 sum += limit;
             }
         }), "ns");
    line("  edge table of the body", 1e3 * seconds([&] {
             sum += make_edges(body.triangles, int(body.points.size())).size();
         }), "ms");
    if (sum == 0) std::puts("");
}

void bench_proof(const TriMesh& cloth, const TriMesh& body) {
    std::size_t found = 0;
    line("  intersections of cloth and body, exact", 1e3 * seconds([&] {
             found = intersecting_pairs(cloth, body).size();
         }), "ms");
    line("  intersections of the cloth with itself, exact", 1e3 * seconds([&] {
             found += self_intersecting_pairs(cloth).size();
         }), "ms");
    line("    pairs", double(found), "");
    double clearance = 0;
    line("  clearance of cloth and body, proof included", 1e3 * seconds([&] {
             clearance = clearance_min(cloth.triangles, cloth.points, body);
         }), "ms");
    line("    clearance", 1e3 * clearance, "mm");
    line("  comparison of the two surfaces", 1e3 * seconds([&] { clearance = compare(cloth, body).rms; }), "ms");
}

void bench_pairs() {
    test::Random random(1);
    constexpr int n = 100000;
    std::vector<Motion> motions(n);
    for (Motion& m : motions)
        for (int k = 0; k < 4; ++k) {
            m.x[k] = Vec3(1.2, 1.4, 0.1) + random.vec3(0.01);
            m.dx[k] = random.vec3(0.001);
        }
    double sum = 0;
    std::puts("random pairs within 1 cm that move by 1 mm");
    line("  point-triangle distance", 1e9 / n * seconds([&] {
             for (const Motion& m : motions) sum += nearest_point_triangle(m.x[0], m.x[1], m.x[2], m.x[3]).squared;
         }), "ns");
    line("  edge-edge distance", 1e9 / n * seconds([&] {
             for (const Motion& m : motions) sum += nearest_edge_edge(m.x[0], m.x[1], m.x[2], m.x[3]).squared;
         }), "ns");
    line("  point-triangle time of impact", 1e9 / n * seconds([&] {
             for (const Motion& m : motions) sum += time_of_impact_point_triangle(m, {});
         }), "ns");
    line("  edge-edge time of impact", 1e9 / n * seconds([&] {
             for (const Motion& m : motions) sum += time_of_impact_edge_edge(m, {});
         }), "ns");
    for (Motion& m : motions)
        for (Vec3& d : m.dx) d *= 20;
    line("  point-triangle time of impact, moving by 2 cm", 1e9 / n * seconds([&] {
             for (const Motion& m : motions) sum += time_of_impact_point_triangle(m, {});
         }), "ns");
    line("  edge-edge time of impact, moving by 2 cm", 1e9 / n * seconds([&] {
             for (const Motion& m : motions) sum += time_of_impact_edge_edge(m, {});
         }), "ns");
    if (sum == 0) std::puts("");
}

} // namespace

int main() {
    // A trunk of 51,000 triangles and a cloth of 20,000 a millimetre off it: everything is near.
    const TriMesh body = test::tube(0.2, 0.8, 300, 85);
    TriMesh cloth = test::tube(0.2011, 0.8, 126, 80);
    test::Random random(2);
    for (Vec3& p : cloth.points) p += random.vec3(2e-4); // not exactly flat anywhere, as cloth is not
    bench_tree(cloth, body);
    bench_proof(cloth, body);
    bench_pairs();
    set_threads(2);
    line("an empty parallel loop of 64 chunks", 1e6 * seconds([] { parallel_for(64, 1, [](int, int) {}); }), "us");
}

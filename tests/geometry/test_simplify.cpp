// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/isosurface.h"
#include "geometry/simplify.h"
#include "geometry/solid.h"
#include "tests/support/shapes.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace toile;
using namespace toile::test;

TEST_CASE("a simplified surface has the triangles it may have and stays where it was", "[simplify]") {
    const TriMesh fine = sphere(0.2, 6); // edges of 5 mm
    const TriMesh coarse = simplified(fine, 0.02, 1e-3);
    const double wanted = 4 * EIGEN_PI * 0.04 / (std::sqrt(3.0) / 4 * 4e-4);
    CHECK(double(coarse.triangles.size()) == Approx(wanted).epsilon(0.02));
    CHECK(border_loops(coarse).empty());
    CHECK(crowded_edges(coarse) == 0);
    for (const Vec3& p : coarse.points) CHECK(p.norm() == Approx(0.2).margin(2e-4));
    CHECK(volume(coarse) == Approx(volume(fine)).epsilon(5e-3));
}

TEST_CASE("triangles are saved where the surface is flat", "[simplify]") {
    const auto slab = [](const Vec3& p) { return std::max({std::abs(p.x()) - 0.3, std::abs(p.y()) - 0.2, std::abs(p.z()) - 0.02}); };
    const TriMesh fine = isosurface(slab, {Vec3(-0.35, -0.25, -0.1), Vec3(0.35, 0.25, 0.1)}, {.cell = 0.008});
    const TriMesh coarse = simplified(fine, 0.05, 0.01);
    CHECK(coarse.triangles.size() < fine.triangles.size() / 20);
    CHECK(volume(coarse) == Approx(volume(fine)).epsilon(0.02));
}

TEST_CASE("what is coarse already, or cannot be coarser within the error, stays as it is", "[simplify]") {
    const TriMesh cube = box({0, 0, 0}, {1, 1, 1});
    CHECK(simplified(cube, 0.9, 1).triangles == cube.triangles);
    const TriMesh ball = simplified(sphere(0.2, 4), 0.2, 1e-3);
    CHECK(ball.triangles.size() > 100);
    for (const Triangle& t : ball.triangles) {
        const Vec3 middle = (ball.points[t[0]] + ball.points[t[1]] + ball.points[t[2]]) / 3;
        CHECK(middle.norm() > 0.2 - 4e-3); // the error is a mean over what was collapsed
    }
}

TEST_CASE("an open border stays where it is", "[simplify]") {
    TriMesh open = sphere(0.2, 5);
    std::erase_if(open.triangles, [&](const Triangle& t) { return open.points[t[0]].y() > 0.1; });
    const auto border = [](const TriMesh& mesh) {
        double length = 0;
        for (const std::vector<int>& loop : border_loops(mesh))
            for (std::size_t k = 0; k < loop.size(); ++k)
                length += (mesh.points[loop[k]] - mesh.points[loop[(k + 1) % loop.size()]]).norm();
        return length;
    };
    CHECK(border(simplified(open, 0.05, 0.01)) == Approx(border(open)));
}

TEST_CASE("the same surface is simplified the same way every time", "[simplify]") {
    const TriMesh fine = sphere(0.2, 5);
    const TriMesh a = simplified(fine, 0.03, 1e-3), b = simplified(fine, 0.03, 1e-3);
    CHECK(a.points == b.points);
    CHECK(a.triangles == b.triangles);
}

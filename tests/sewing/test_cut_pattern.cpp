// SPDX-License-Identifier: GPL-3.0-or-later
#include "sewing/cut_pattern.h"

#include "geometry/edges.h"
#include "patterns/check.h"
#include "sewing/check_cut.h"
#include "tests/support/surfaces.h"

#include <catch2/catch.hpp>

using namespace toile;
using namespace toile::test;
using Catch::Matchers::Contains;

namespace {

double most_strain(const CutPiece& piece) {
    double most = 0;
    for (int t = 0; t < int(piece.mesh.triangles.size()); ++t)
        most = std::max(most, laid_strain(piece.mesh, piece.flat.points, t).cwiseAbs().maxCoeff());
    return most;
}

double area(const TriMesh& mesh) {
    double sum = 0;
    for (const auto& [a, b, c] : mesh.triangles) sum += (mesh.points[b] - mesh.points[a]).cross(mesh.points[c] - mesh.points[a]).norm() / 2;
    return sum;
}

void check_no_slivers(const TriMesh& mesh) {
    for (const auto& [p, q, r] : mesh.triangles) {
        const Vec3 a = mesh.points[q] - mesh.points[p], b = mesh.points[r] - mesh.points[p];
        CHECK(a.cross(b).norm() > 1e-3 * std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()}));
    }
}

} // namespace

TEST_CASE("a cylinder and a cone cut along a line lie flat without strain, and are sewn to themselves where they were cut") {
    for (const double narrower : {0.0, 0.4}) { // at the top
        TriMesh mesh = tube(0.1, 0.3, 24, 9);
        for (Vec3& p : mesh.points) p.x() *= 1 - narrower * p.y() / 0.3, p.z() *= 1 - narrower * p.y() / 0.3;
        LinedMesh surface(mesh);
        REQUIRE(surface.join(0, 24 * 9, 0));
        const std::vector<CutPiece> pieces = cut_out(surface, {{"all", Vec3(0, 0.15, 0)}});
        REQUIRE(pieces.size() == 1);
        CHECK(pieces[0].flat.settled);
        CHECK(most_strain(pieces[0]) < 1e-6);
        const Pattern pattern = pattern_of(surface, pieces, {"back"});
        CHECK_FALSE(has_error(check(pattern)));
        REQUIRE(pattern.seams.size() == 1);
        const SeamLengths l = seam_lengths(pattern, pattern.seams[0]);
        CHECK(l.a == Approx(std::hypot(0.3, 0.1 * narrower)).epsilon(1e-9));
        CHECK(l.b == Approx(l.a).epsilon(1e-9));
    }
}

TEST_CASE("a cap of a sphere keeps the strain of the shallow shell that is pressed flat") {
    const double angle = 0.3; // rad; classical: in the middle angle^2 / 16 both ways, round the rim -angle^2 / 8
    const TriMesh sphere = ellipsoid(Vec3(1, 1, 1), 120, 84);
    LinedMesh surface(sphere);
    REQUIRE(surface.cut_by_plane(Vec3(0, std::cos(angle), 0), Vec3::UnitY(), {Vec3::Constant(-2), Vec3::Constant(2)}, 0));
    const std::vector<CutPiece> pieces = cut_out(surface, {{"cap", Vec3(0, 1, 0)}});
    const CutPiece& cap = pieces[0];
    CHECK(area(cap.mesh) == Approx(2 * EIGEN_PI * (1 - std::cos(angle))).epsilon(2e-3));
    double middle = 0, rim = 0;
    for (int t = 0; t < int(cap.mesh.triangles.size()); ++t) {
        Vec3 at = Vec3::Zero();
        for (const int p : cap.mesh.triangles[t]) at += cap.mesh.points[p] / 3;
        const Vec2 strain = laid_strain(cap.mesh, cap.flat.points, t);
        if (std::hypot(at.x(), at.z()) < 0.05) middle = std::max(middle, strain[0]);
        rim = std::min(rim, strain[1]);
    }
    CHECK(middle == Approx(angle * angle / 16).epsilon(0.1));
    CHECK(rim == Approx(-angle * angle / 8).epsilon(0.1));
}

TEST_CASE("lines drawn on a surface part it, keep it closed and leave no slivers") {
    const TriMesh sphere = ellipsoid(Vec3(1, 1, 1), 40, 25);
    LinedMesh surface(sphere);
    REQUIRE(surface.cut_by_plane(Vec3(0, 0.3, 0), Vec3(0.2, 1, 0.1).normalized(), {Vec3::Constant(-2), Vec3::Constant(2)}, 0));
    const int a = surface.point_near(Vec3(1, 0.3, 0), 0.15), b = surface.point_near(Vec3(0.6, -0.7, 0.2));
    CHECK(surface.lines().size() > 30);
    REQUIRE(surface.join(a, b, 1));
    const TriMesh& mesh = surface.mesh();
    const EdgeTable edges = make_edges(mesh.triangles, int(mesh.points.size()));
    for (int e = 0; e < edges.size(); ++e) CHECK(edges.triangles_at(e) == 2);
    CHECK(int(mesh.points.size()) - edges.size() + int(mesh.triangles.size()) == 2);
    CHECK(area(mesh) == Approx(area(sphere)).epsilon(5e-3));
    for (const auto& [ends, line] : surface.lines())
        if (line == 0)
            for (const int p : ends) CHECK(std::abs(Vec3(0.2, 1, 0.1).normalized().dot(mesh.points[p] - Vec3(0, 0.3, 0))) < 1e-9);
    for (const auto& [p, q, r] : mesh.triangles) {
        const double height = (mesh.points[q] - mesh.points[p]).cross(mesh.points[r] - mesh.points[p]).norm();
        const double longest = std::max({(mesh.points[q] - mesh.points[p]).norm(), (mesh.points[r] - mesh.points[q]).norm(), (mesh.points[p] - mesh.points[r]).norm()});
        CHECK(height > 0.02 * longest * longest);
    }
    CHECK_FALSE(surface.cut_by_plane(Vec3(0, 3, 0), Vec3::UnitY(), {Vec3::Constant(-2), Vec3::Constant(2)}, 2));
}

TEST_CASE("pieces that cannot be panels are refused by name") {
    const LinedMesh whole(ellipsoid(Vec3(1, 1, 1), 12, 8));
    CHECK_THROWS_WITH(cut_out(whole, {{"one", Vec3(1, 0, 0)}, {"two", Vec3(-1, 0, 0)}}),
                      Contains("\"one\" cannot be flattened: it is closed"));
    const LinedMesh open(tube(0.1, 0.3, 12, 4));
    CHECK_THROWS_WITH(cut_out(open, {{"sleeve", Vec3(0, 0, 0)}}), Contains("\"sleeve\" cannot be flattened: it has a hole"));
}

TEST_CASE("a sphere but for a small hole lies flat without a triangle turned over") {
    LinedMesh surface(ellipsoid(Vec3(1, 1, 1), 60, 42));
    REQUIRE(surface.cut_by_plane(Vec3(0, -0.9, 0), Vec3::UnitY(), {Vec3::Constant(-2), Vec3::Constant(2)}, 0));
    const std::vector<CutPiece> pieces = cut_out(surface, {{"most", Vec3(0, 1, 0)}});
    CHECK(pieces[0].flat.settled);
    for (const auto& [a, b, c] : pieces[0].mesh.triangles) {
        const auto& at = pieces[0].flat.points;
        const Vec2 p = at[b] - at[a], q = at[c] - at[a];
        CHECK(p.x() * q.y() - p.y() * q.x() > 0);
    }
}

TEST_CASE("sides of a seam come out alike where one piece is domed and the other is not") {
    LinedMesh surface(ellipsoid(Vec3(1, 0.4, 1), 60, 41)); // lens of a flat and a steep part
    REQUIRE(surface.cut_by_plane(Vec3(0.5, 0, 0), Vec3(1, 0.3, 0).normalized(), {Vec3::Constant(-2), Vec3::Constant(2)}, 0));
    const std::vector<std::string> lines{"seam"};
    const auto differ = [&](double weight) {
        FlattenOptions options;
        options.seam_weight = weight;
        const std::vector<CutPiece> pieces = cut_out(surface, {{"small", Vec3(1, 0, 0)}, {"large", Vec3(-1, 0, 0)}}, options);
        double sum = 0;
        const Pattern pattern = pattern_of(surface, pieces, lines);
        for (const Seam& seam : pattern.seams) {
            const SeamLengths l = seam_lengths(pattern, seam);
            sum += std::abs(l.a - l.b);
        }
        return sum;
    };
    CHECK(differ(0) > 0.1);
    CHECK(differ(FlattenOptions{}.seam_weight) < 0.01); // of a length of about 4 m
}

TEST_CASE("a piece that covers itself in the plane is refused by panel and line") {
    TriMesh saddle{{Vec3::Zero()}, {}}; // developable but for its middle, where angles sum to more than a turn
    const int around = 96, rings = 6;
    for (int r = 1; r <= rings; ++r)
        for (int k = 0; k < around; ++k) {
            const double a = 2 * EIGEN_PI * k / around, h = 0.5 * std::sin(6 * a);
            saddle.points.push_back(0.05 * r * Vec3(std::cos(a), h, -std::sin(a)));
        }
    for (int r = 0; r < rings; ++r)
        for (int k = 0; k < around; ++k) {
            const auto at = [&](int ring, int i) { return ring == 0 ? 0 : 1 + (ring - 1) * around + i % around; };
            saddle.triangles.push_back({at(r, k), at(r + 1, k), at(r + 1, k + 1)});
            if (r > 0) saddle.triangles.push_back({at(r, k), at(r + 1, k + 1), at(r, k + 1)});
        }
    LinedMesh surface(saddle);
    REQUIRE(surface.join(0, 1 + (rings - 1) * around, 0));
    const std::vector<CutPiece> pieces = cut_out(surface, {{"ruff", Vec3(-0.2, 0, 0)}});
    CHECK(most_strain(pieces[0]) < 0.01); // the plane can hold it, twice over
    CHECK_THROWS_WITH(expect_sound(pattern_of(surface, pieces, {"slit"})), Contains("panel \"ruff\" overlaps itself") && Contains("the border of the surface"));
}

TEST_CASE("patterns that cannot be sewn are refused by panels and lines") {
    const std::vector<Vec2> at{{0, 0}, {0.3, 0}, {0.3, 0.2}, {0, 0.2}};
    const auto pattern = [&](const std::vector<int>& order) {
        Pattern out;
        for (const char* name : {"one", "two"}) {
            out.panels.emplace_back().name = name;
            for (std::size_t k = 0; k < 4; ++k) out.panels.back().outline.push_back({at[order[k]], at[order[(k + 1) % 4]], Straight{}, k == 0 ? "hem" : ""});
        }
        out.panels[1].placement.translation.z() = 0.1;
        return out;
    };
    const auto sewn = [](Pattern p, int edge) {
        p.seams.push_back({{{0, 2, 0, 1}}, {{1, edge, 1, 0}}, {}, "side"});
        return p;
    };
    CHECK_NOTHROW(expect_sound(sewn(pattern({0, 1, 2, 3}), 2)));
    CHECK_THROWS_WITH(expect_sound(sewn(pattern({0, 2, 1, 3}), 2)),
                      Contains("panel \"one\" overlaps itself") && Contains("line \"hem\" meets that along line \"side\" at (15.0, 10.0) cm"));
    CHECK_THROWS_WITH(expect_sound(sewn(pattern({0, 1, 2, 3}), 1)), Contains("line \"side\" joins 300.0 mm of panel \"one\" to 200.0 mm of panel \"two\""));
}

TEST_CASE("ends of lines meet a line near their place on the surface and none of its triangles is left without area") {
    for (int k = 0; k < 60; ++k) {
        LinedMesh surface(ellipsoid(Vec3(1, 1, 1), 24, 15));
        const double tilt = 0.01 * k;
        REQUIRE(surface.cut_by_plane(Vec3::Zero(), Vec3(tilt, 1, 0.3 * tilt).normalized(), {Vec3::Constant(-2), Vec3::Constant(2)}, 0));
        const int on = surface.point_near(1.5 * Vec3(std::cos(tilt), -tilt * std::cos(tilt), 0.3 * std::sin(tilt)), 0.1);
        CHECK(std::any_of(surface.lines().begin(), surface.lines().end(), [&](const auto& l) { return l.first[0] == on || l.first[1] == on; }));
        CHECK(surface.join(on, surface.point_near(Vec3(0.7, 0.6, 0.1 + 0.01 * k)), 1));
        check_no_slivers(surface.mesh());
    }
}

TEST_CASE("triangles that a line drawn along them would leave without area are turned") {
    for (const int k : {27, 86, 99}) { // of many lines these did so
        LinedMesh surface(ellipsoid(Vec3(1, 0.7, 1), 16, 11));
        const double a = 0.37 * k, b = a + 1.1 + 0.3 * std::sin(k * 0.77);
        const int from = surface.point_near(Vec3(std::cos(a), 0.4 * std::sin(1.3 * k), std::sin(a)));
        REQUIRE(surface.join(from, surface.point_near(Vec3(std::cos(b), 0.5 * std::cos(2.1 * k), std::sin(b))), 0));
        check_no_slivers(surface.mesh());
    }
}

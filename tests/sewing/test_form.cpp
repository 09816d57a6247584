// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/isosurface.h"
#include "geometry/solid.h"
#include "sewing/avatar.h"
#include "sewing/form.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace toile;

namespace {

/// Closed, one piece, without handles, standing on the floor, as tall as asked, with the girths asked for.
void check_form(const FormMeasures& m) {
    INFO("height " << m.height << " bust " << m.bust << " waist " << m.waist << " hip " << m.hip);
    const TriMesh form = make_form(m);
    CHECK(border_loops(form).empty());
    CHECK(crowded_edges(form) == 0);
    CHECK(int(form.points.size()) - int(form.triangles.size()) / 2 == 2);
    CHECK((form.points.size() > 9000 && form.points.size() < 30000));
    double low = 1e9, high = -1e9;
    for (const Vec3& p : form.points) {
        low = std::min(low, p.y());
        high = std::max(high, p.y());
    }
    CHECK(std::abs(low) < 1e-3);
    CHECK(high == Approx(m.height).margin(2e-3));
    const FormLevels level = form_levels(m);
    CHECK(torso_girth(form, level.bust_y) == Approx(m.bust).epsilon(0.005));
    CHECK(torso_girth(form, level.waist_y) == Approx(m.waist).epsilon(0.005));
    CHECK(torso_girth(form, level.hip_y) == Approx(m.hip).epsilon(0.005));
}

} // namespace

TEST_CASE("the default form is a person's shape", "[form]") {
    const FormMeasures m;
    check_form(m);
    const TriMesh form = make_form(m);
    const BodyMeasures found = measure_body(form);
    CHECK(found.height == Approx(1.68).margin(2e-3));
    CHECK(found.bust == Approx(m.bust).epsilon(0.005));
    CHECK(found.waist == Approx(m.waist).epsilon(0.005));
    CHECK(found.hip == Approx(m.hip).epsilon(0.005));
    CHECK(found.bust_y == Approx(form_levels(m).bust_y).margin(0.01));
    CHECK(found.waist_y == Approx(form_levels(m).waist_y).margin(0.01));
    CHECK(found.hip_y == Approx(form_levels(m).hip_y).margin(0.01));
    CHECK((found.crotch_y > 0.70 && found.crotch_y < 0.80));
    CHECK((found.armpit_y > 1.20 && found.armpit_y < 1.30));
    CHECK((found.neck > 0.32 && found.neck < 0.42));
    CHECK((volume(form) > 0.055 && volume(form) < 0.070)); // about a litre per kilogramme
    // Arms reach out and down, about as far as the arms of a person in A pose.
    double reach = 0, y = 0;
    for (const Vec3& p : form.points)
        if (p.x() > reach) {
            reach = p.x();
            y = p.y();
        }
    CHECK((reach > 0.55 && reach < 0.75));
    CHECK((y > 0.75 && y < 1.0));
}

TEST_CASE("its triangles are good enough for contact", "[form]") {
    const TriMesh form = make_form({});
    double shortest = 1, longest = 0;
    int thin = 0;
    for (const Triangle& t : form.triangles)
        for (int k = 0; k < 3; ++k) {
            const Vec3 a = form.points[t[(k + 1) % 3]] - form.points[t[k]], b = form.points[t[(k + 2) % 3]] - form.points[t[k]];
            shortest = std::min(shortest, a.norm());
            longest = std::max(longest, a.norm());
            thin += std::acos(a.normalized().dot(b.normalized())) < 20 * EIGEN_PI / 180;
        }
    CHECK(shortest > 0.0025);
    CHECK(longest < 0.035);
    CHECK(thin < 5);
}

TEST_CASE("the form is smooth: neighbouring triangles meet at small angles", "[form]") {
    const TriMesh form = make_form({});
    std::vector<Vec3> normal(form.points.size(), Vec3::Zero());
    for (const Triangle& t : form.triangles) {
        const Vec3 n = (form.points[t[1]] - form.points[t[0]]).cross(form.points[t[2]] - form.points[t[0]]);
        for (int corner : t) normal[corner] += n;
    }
    int sharp = 0;
    for (const Triangle& t : form.triangles) {
        const Vec3 n = (form.points[t[1]] - form.points[t[0]]).cross(form.points[t[2]] - form.points[t[0]]).normalized();
        for (int corner : t) sharp += n.dot(normal[corner].normalized()) < std::cos(35 * EIGEN_PI / 180);
    }
    CHECK(sharp < 30);
}

TEST_CASE("girths are met over the whole range", "[form]") {
    const FormMeasures m = GENERATE(FormMeasures{1.2, 0.6, 0.5, 0.6}, FormMeasures{1.2, 1.5, 1.5, 1.6},
                                    FormMeasures{2.1, 0.6, 0.5, 0.6}, FormMeasures{2.1, 1.5, 1.5, 1.6},
                                    FormMeasures{1.68, 1.5, 0.5, 1.6}, FormMeasures{1.68, 0.9, 1.5, 0.6},
                                    FormMeasures{1.68, 0.9, 0.5, 1.6}, FormMeasures{1.2, 0.6, 1.5, 0.6},
                                    FormMeasures{1.60, 0.84, 0.66, 0.90}, FormMeasures{1.75, 1.10, 0.95, 1.15});
    check_form(m);
}

TEST_CASE("the same measures give the same form", "[form]") {
    const TriMesh a = make_form({}), b = make_form({});
    CHECK(a.points == b.points);
    CHECK(a.triangles == b.triangles);
}

TEST_CASE("measures that no form can have are refused", "[form]") {
    CHECK_THROWS_WITH(make_form({.height = 168}), "the form's height is 168.000000 m; expected 1.2 to 2.1 m");
    CHECK_THROWS_AS(make_form({.bust = 0.5}), std::invalid_argument);
    CHECK_THROWS_AS(make_form({.waist = 1.6}), std::invalid_argument);
    CHECK_THROWS_AS(make_form({.hip = std::numeric_limits<double>::quiet_NaN()}), std::invalid_argument);
}

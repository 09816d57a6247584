// SPDX-License-Identifier: GPL-3.0-or-later
// The chart of docs/chart.md in its quick form: its answers, and how fast each method comes nearer to them with the mesh.

#include "draping/chart/chart.h"
#include "draping/chart/scene_rest.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace toile;

namespace {

Scene scene(const std::string& name) {
    for (const Scene& s : chart_scenes())
        if (s.name == name) return s;
    throw std::runtime_error("no scene " + name);
}

ChartOptions quick(const std::vector<std::string>& scenes, const std::vector<Method>& methods) {
    ChartOptions o;
    for (const std::string& name : scenes) o.scenes.push_back(scene(name));
    o.methods = methods;
    o.meshes = 3;
    o.steps = o.repeats = 1;
    return o;
}

void check_second_order(const Chart& chart, const std::string& name, Method method) {
    INFO(name << ", " << to_string(method));
    const std::optional<double> order = order_of(chart, name, method);
    REQUIRE(order);
    CHECK(*order == Approx(2).margin(0.3));
}

} // namespace

TEST_CASE("chart: a heavy strip that hardly stretches has the slope of the elastica") {
    CHECK(*scene("cantilever, aligned, 1e06").answer == Approx(1.06680232).epsilon(1e-5));
    CHECK(*scene("cantilever, aligned, 1e04").answer > *scene("cantilever, aligned, 1e06").answer);
}

TEST_CASE("chart: methods whose bending is right are of second order on squares") {
    const std::vector<Method> methods{Method::equilibrium, Method::projective, Method::inextensible};
    const std::vector<std::string> scenes{"cantilever, aligned, 1e04", "cantilever, alternating, 1e04"};
    const Chart chart = make_chart(quick(scenes, methods));
    for (const std::string& name : scenes)
        for (const Method method : methods)
            if (method == Method::inextensible)
                REQUIRE(order_of(chart, name, method)); // it does not stretch as the answer does
            else
                check_second_order(chart, name, method);
}

TEST_CASE("chart: hinges on squares stay off however fine they are") {
    const Chart chart = make_chart(quick({"cantilever, aligned, 1e04"}, {Method::triangles, Method::springs_implicit}));
    for (const ChartPoint& p : chart.points) {
        INFO(to_string(p.method) << ", " << p.edge_length);
        CHECK(p.failure == "");
        CHECK(p.error > 0.1);
        CHECK(p.error < 0.2);
    }
}

TEST_CASE("chart: a chain of springs is of second order and its motion ends at the rest of its energy") {
    const Chart chart = make_chart(quick({"catenary"}, {Method::springs_implicit, Method::springs_biphasic}));
    for (const Method method : {Method::springs_implicit, Method::springs_biphasic})
        check_second_order(chart, "catenary", method);
    const Scene s = scene("cantilever, aligned, 1e04");
    const SceneCloth cloth = s.make(s.edges[0]);
    const auto value = [&](Method method) {
        SceneRestOptions o{method};
        const SceneRest rest = rest_of(cloth, o);
        CHECK(rest.failure == "");
        return s.measure(cloth, rest.x);
    };
    CHECK(value(Method::springs_explicit) == Approx(value(Method::springs_implicit)).epsilon(2e-3));
    CHECK(value(Method::xpbd) == Approx(value(Method::triangles)).epsilon(2e-3));
}

TEST_CASE("chart: sewn sectors of discs are cones to second order") {
    const Chart chart = make_chart(quick({"cone"}, {Method::projective, Method::triangles}));
    for (const Method method : {Method::projective, Method::triangles})
        check_second_order(chart, "cone", method);
}

TEST_CASE("chart: a solver is asked how far it is from the end") {
    const Chart chart = make_chart(quick({"catenary"}, {Method::triangles}));
    for (const ChartPoint& p : chart.points) {
        REQUIRE(p.error_solver);
        CHECK(*p.error_solver < 1e-4 * std::max(p.error, 1e-2));
    }
}

TEST_CASE("chart: models with a shear stiffness of their own have it in a picture frame") {
    ChartOptions o = quick({"picture frame"}, {Method::equilibrium, Method::triangles, Method::projective, Method::inextensible, Method::nonconforming});
    o.meshes = 2;
    const Chart chart = make_chart(o);
    CHECK(chart.scenes[0].answer == Approx(0.5 * 3.14159265358979 / 180));
    for (const ChartPoint& p : chart.points) {
        INFO(to_string(p.method) << ", " << p.edge_length);
        CHECK(p.failure == "");
        if (p.method == Method::nonconforming)
            CHECK(p.error > 0.9); // keeps all lengths
        else
            CHECK(p.error < 1e-3);
    }
}

TEST_CASE("chart: a strip over a cylinder slides until its tensions are in the ratio of the capstan") {
    ChartOptions o = quick({"capstan"}, {Method::equilibrium, Method::springs_implicit, Method::triangles});
    o.meshes = 2;
    for (const ChartPoint& p : make_chart(o).points) {
        INFO(to_string(p.method) << ", " << p.edge_length);
        CHECK(p.failure == "");
        CHECK(p.error < 0.02);
    }
    const Scene s = scene("capstan");
    SceneCloth smooth = s.make(s.edges[0]);
    CHECK(s.measure(smooth, smooth.x) == Approx(1.1 * std::exp(0.3 * 3.14159265358979)).epsilon(1e-6));
    smooth.friction = 0;
    CHECK(s.measure(smooth, rest_of(smooth, {}).x) == Approx(1).epsilon(5e-3));
}

TEST_CASE("chart: Cusick's disc drapes as much as measured cloth, and less when it is stiff") {
    const Scene s = scene("cusick disc");
    REQUIRE(s.band);
    CHECK(s.band->low == Approx(0.270).margin(1e-3)); // the fit by hand, of bending lengths of 1.87 and 1.64 cm
    CHECK(s.band->high == Approx(0.521).margin(1e-3));
    SceneCloth cloth = s.make(s.edges[0]);
    CHECK(s.measure(cloth, cloth.x) == Approx(1));
    Points narrow = cloth.x; // what hangs straight down from the plate has no shadow of its own
    for (Vec3& p : narrow)
        if (const double r = std::hypot(p.x(), p.z()); r > 0.09) p *= 0.09 / r;
    CHECK(s.measure(cloth, narrow) == Approx(0).margin(2e-3));
    const SceneRest rest = rest_of(cloth, {});
    CHECK(rest.failure == "");
    const double coefficient = s.measure(cloth, rest.x);
    CHECK(coefficient > s.band->low - 0.05);
    CHECK(coefficient < s.band->high + 0.05);
    for (double* bend : {&cloth.fabrics[0].bend_warp, &cloth.fabrics[0].bend_weft, &cloth.fabrics[0].bend_twist}) *bend *= 100;
    CHECK(s.measure(cloth, rest_of(cloth, {}).x) > 0.9);
}

TEST_CASE("chart: all that lies in a band is as near as can be told") {
    ChartOptions o = quick({"cusick disc"}, {Method::springs_implicit, Method::projective});
    o.meshes = 1;
    for (const ChartPoint& p : make_chart(o).points) {
        REQUIRE(p.failure == "");
        const Band band = *o.scenes[0].band;
        CHECK(p.error == Approx(std::max({0.0, band.low - p.value, p.value - band.high})));
    }
}

TEST_CASE("chart: what is out of time on a mesh is not run on finer ones") {
    ChartOptions o = quick({"catenary"}, {Method::springs_explicit, Method::springs_implicit});
    o.max_seconds = 0.02;
    int slow = 0, fast = 0;
    for (const ChartPoint& p : make_chart(o).points) ++(p.method == Method::springs_explicit ? slow : fast);
    CHECK(slow == 1);
    CHECK(fast > 1);
}

TEST_CASE("chart: what takes too long has failed and is on no front") {
    ChartOptions o = quick({"cantilever, aligned, 1e04"}, {Method::springs_explicit, Method::projective});
    o.max_seconds = 0.05;
    const Chart chart = make_chart(o);
    const ChartPoint* best = fastest_within(chart, o.scenes[0].name, 1);
    REQUIRE(best);
    CHECK(best->method == Method::projective);
    bool failed = false;
    for (const ChartPoint& p : chart.points) {
        CHECK(!(p.front && !p.failure.empty()));
        failed = failed || p.failure == "out of time";
        for (const ChartPoint& q : chart.points)
            if (p.front && q.failure.empty()) CHECK(!(q.error < p.error && q.seconds_cpu < p.seconds_cpu));
    }
    CHECK(failed);
}

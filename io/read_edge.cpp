// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_edge.h"

#include <cmath>

namespace toile {
namespace {

constexpr double max_metres = 1e6; ///< beyond this no number is a length; check() has a finer opinion

Vec2 read_control(const JsonView& v, const Edge& edge, const EdgeConventions& as) {
    if (as.absolute_control) return read_point(v, as.metres);
    const Vec2 uv = read_point(v, 1), along = edge.end - edge.start;
    return edge.start + uv.x() * along + uv.y() * Vec2(-along.y(), along.x());
}

Curve read_arc(const JsonView& params, const EdgeConventions& as) {
    params.expect_array(3, 3);
    const JsonView radius = params.at(0, "parameter");
    const double r = read_length(radius, as.metres);
    if (!(r > 0)) radius.fail("a radius above 0");
    return Arc{r, params.at(1, "parameter").boolean(), params.at(2, "parameter").boolean()};
}

Curve read_curve(const JsonView& v, const Edge& edge, const EdgeConventions& as) {
    if (v.value().is_array()) return Quadratic{read_control(v, edge, as)}; // the form of 2021
    const JsonView type = v.at("type"), params = v.at("params");
    const std::string kind = type.string();
    if (kind == "circle") return read_arc(params, as);
    const std::size_t controls = kind == "quadratic" ? 1 : kind == "cubic" ? 2 : 0;
    if (controls == 0) type.fail("\"quadratic\", \"cubic\" or \"circle\"");
    params.expect_array(controls, controls);
    const Vec2 first = read_control(params.at(0, "control point"), edge, as);
    if (controls == 1) return Quadratic{first};
    return Cubic{first, read_control(params.at(1, "control point"), edge, as)};
}

} // namespace

double read_unit(const JsonView& properties) {
    return 1 / properties.at("units_in_meter").number(1e-3, 1e6);
}

double read_length(const JsonView& v, double metres) {
    const double x = v.number() * metres;
    if (std::abs(x) > max_metres) v.fail("a length");
    return x;
}

Vec2 read_point(const JsonView& v, double metres) {
    v.expect_array(2, 2);
    return {read_length(v.at(0, "coordinate"), metres), read_length(v.at(1, "coordinate"), metres)};
}

std::vector<Vec2> read_vertices(const JsonView& v, double metres) {
    v.expect_array(2);
    std::vector<Vec2> vertices;
    for (std::size_t i = 0; i < v.value().size(); ++i)
        vertices.push_back(read_point(v.at(i, "vertex"), metres));
    return vertices;
}

Edge read_edge(const JsonView& v, const std::vector<Vec2>& vertices, const EdgeConventions& as) {
    const JsonView ends = v.at("endpoints");
    ends.expect_array(2, 2);
    const auto vertex = [&](int k) {
        const JsonView number = ends.at(k, "number");
        const double i = number.value().is_number_integer() ? number.number() : -1;
        if (i < 0 || i >= double(vertices.size()))
            number.fail("the number of a vertex, 0 to " + std::to_string(int(vertices.size()) - 1));
        return vertices[std::size_t(i)];
    };
    Edge edge{vertex(0), vertex(1), Straight{}, {}};
    if (v.has("curvature")) edge.curve = read_curve(v.at("curvature"), edge, as);
    if (v.has("label")) edge.label = v.at("label").string();
    return edge;
}

} // namespace toile

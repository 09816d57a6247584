// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_cut_lines.h"

#include "geometry/text.h"
#include "io/json.h"
#include "io/read_edge.h"
#include "io/read_placement.h"
#include "io/write_file.h"

#include <set>

namespace toile {
namespace {

constexpr std::size_t most_lines = 1000, most_points = 10'000;
constexpr double meets = 0.005; // m
constexpr double everywhere = 1e6; // m

Points read_points(const JsonView& v, double metres, std::size_t least) {
    v.expect_array(least, most_points);
    Points points;
    for (std::size_t i = 0; i < v.value().size(); ++i) points.push_back(read_vector(v.at(i, "point"), metres));
    return points;
}

CutPlane read_plane(const JsonView& line, double metres) {
    const JsonView v = line.at("plane");
    v.expect_object();
    v.expect_keys({"point", "normal"});
    CutPlane plane{read_vector(v.at("point"), metres), read_vector(v.at("normal"), 1),
                   {Vec3::Constant(-everywhere), Vec3::Constant(everywhere)}};
    if (!(plane.normal.norm() > 0)) v.at("normal").fail("a direction");
    plane.normal.normalize();
    if (!line.has("box")) return plane;
    const Points box = read_points(line.at("box"), metres, 2);
    plane.box = {box[0].cwiseMin(box[1]), box[0].cwiseMax(box[1])};
    return plane;
}

CutLine read_line(const JsonView& v, double metres) {
    v.expect_object();
    v.expect_keys({"name", "points", "closed", "plane", "box"});
    CutLine line;
    line.name = v.at("name").string();
    if (v.has("points") == v.has("plane")) v.fail("an object with either \"points\" or \"plane\"");
    if (v.has("plane")) {
        if (v.has("closed")) v.at("closed").fail("left out: a plane closes its line itself");
        line.plane = read_plane(v, metres);
        return line;
    }
    if (v.has("box")) v.at("box").fail("left out: it bounds the line of a plane");
    line.closed = v.has("closed") && v.at("closed").boolean();
    line.points = read_points(v.at("points"), metres, line.closed ? 3 : 2);
    return line;
}

void draw(LinedMesh& surface, const CutLine& line, int number, const std::string& called) {
    if (line.plane) {
        if (!surface.cut_by_plane(line.plane->on, line.plane->normal, line.plane->box, number))
            throw InputError(called + " does not meet the surface; expected its plane, inside its box, to cross it");
        return;
    }
    std::vector<int> points;
    for (std::size_t k = 0; k < line.points.size(); ++k) {
        const bool end = !line.closed && (k == 0 || k + 1 == line.points.size());
        points.push_back(surface.point_near(line.points[k], end ? meets : 0));
    }
    if (line.closed) points.push_back(points.front());
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
        if (points[k] == points[k + 1])
            throw InputError(called + text(": its points %zu and %zu come to one point of the surface", k, (k + 1) % line.points.size()));
        if (!surface.join(points[k], points[k + 1], number))
            throw InputError(called + text(": no way along the surface leads from its point %zu straight to point %zu; expected points nearer to "
                                           "each other, on one side of the surface",
                                           k, (k + 1) % line.points.size()));
    }
}

} // namespace

CutLines read_cut_lines(const std::string& path) {
    const Json json = parse_json(read_file(path, JsonLimits{}.max_bytes), path);
    const JsonView root(json, path);
    root.expect_object();
    root.expect_keys({"toile_cut", "units_in_meter", "lines", "panels"});
    root.at("toile_cut").integer(1, 1);
    const double metres = root.has("units_in_meter") ? read_unit(root) : EdgeConventions{}.metres;
    CutLines out;
    const JsonView lines = root.at("lines"), panels = root.at("panels");
    lines.expect_array(1, most_lines);
    panels.expect_array(1, most_lines);
    for (std::size_t i = 0; i < lines.value().size(); ++i) out.lines.push_back(read_line(lines.at(i, "line"), metres));
    std::set<std::string> names;
    for (std::size_t i = 0; i < panels.value().size(); ++i) {
        const JsonView panel = panels.at(i, "panel");
        panel.expect_object();
        panel.expect_keys({"name", "inside"});
        out.panels.push_back({panel.at("name").string(), read_vector(panel.at("inside"), metres)});
        if (!names.insert(out.panels.back().name).second) panel.at("name").fail("a name that no other panel has");
    }
    return out;
}

LinedMesh draw_lines(TriMesh surface, const CutLines& lines, const std::string& path) {
    LinedMesh drawn(std::move(surface));
    for (std::size_t i = 0; i < lines.lines.size(); ++i)
        draw(drawn, lines.lines[i], int(i), path + ": line " + in_quotes(lines.lines[i].name));
    return drawn;
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/prescribed_json.h"

#include "geometry/text.h"
#include "io/json.h"
#include "io/write_file.h"

#include <cmath>

namespace toile {

namespace {

constexpr double degree = M_PI / 180;
constexpr std::uintmax_t most_bytes = 256u << 20;

/// The edges of "along": "all", "borders", or points one after the other.
std::vector<int> edges_along(const JsonView& view, const std::vector<int>& point_of_file, const Prescribed& data) {
    std::vector<int> edges;
    if (view.value().is_string()) {
        const std::string what = view.string();
        if (what != "all" && what != "borders") view.fail("\"all\", \"borders\" or a list of points");
        for (int e = 0; e < data.edges.size(); ++e)
            if (what == "all" || data.edges.triangles_at(e) == 1) edges.push_back(e);
        return edges;
    }
    view.expect_array(2);
    int last = -1, last_number = 0;
    for (std::size_t k = 0; k < view.value().size(); ++k) {
        const JsonView point = view.at(k, "point");
        const int number = point.integer(1, int(point_of_file.size()));
        const int p = point_of_file[std::size_t(number - 1)];
        if (p < 0) point.fail("a point of a triangle");
        if (k > 0) {
            const int e = edge_between(data.edges, last, p);
            if (e < 0) point.fail(text("joined to point %d by an edge of the mesh", last_number));
            edges.push_back(e);
        }
        last = p;
        last_number = number;
    }
    return edges;
}

void read_lengths(const JsonView& list, const std::vector<int>& point_of_file, Prescribed& data) {
    list.expect_array();
    for (std::size_t k = 0; k < list.value().size(); ++k) {
        const JsonView entry = list.at(k, "length");
        entry.expect_object();
        entry.expect_keys({"along", "length", "scale"});
        if (entry.has("length") == entry.has("scale")) entry.fail("an object with either \"length\" (m, of each edge) or \"scale\"");
        for (const int e : edges_along(entry.at("along"), point_of_file, data))
            if (entry.has("length"))
                data.length[e] = entry.at("length").number(1e-9, 1e3);
            else
                data.length[e] *= entry.at("scale").number(0.01, 100);
    }
}

void read_angles(const JsonView& list, const std::vector<int>& point_of_file, Prescribed& data) {
    list.expect_array();
    for (std::size_t k = 0; k < list.value().size(); ++k) {
        const JsonView entry = list.at(k, "angle");
        entry.expect_object();
        entry.expect_keys({"along", "angle"});
        const double angle = degree * entry.at("angle").number(-180, 180);
        for (const int e : edges_along(entry.at("along"), point_of_file, data)) data.angle[e] = angle;
    }
}

} // namespace

void read_prescribed(const std::string& path, const std::vector<int>& point_of_file, Prescribed& data) {
    JsonLimits limits;
    limits.max_bytes = most_bytes;
    const Json json = parse_json(read_file(path, most_bytes), path, limits);
    const JsonView view(json, path);
    view.expect_object();
    view.expect_keys({"lengths", "angles"});
    if (view.has("lengths")) read_lengths(view.at("lengths"), point_of_file, data);
    if (view.has("angles")) read_angles(view.at("angles"), point_of_file, data);
}

std::string prescribed_text(const Prescribed& data, const std::vector<int>& file_point) {
    Json lengths = Json::array(), angles = Json::array();
    for (int e = 0; e < data.edges.size(); ++e) {
        const Json along{file_point[data.edges.ends[e][0]] + 1, file_point[data.edges.ends[e][1]] + 1};
        lengths.push_back({{"along", along}, {"length", data.length[e]}});
        if (data.edges.triangles_at(e) == 2) angles.push_back({{"along", along}, {"angle", data.angle[e] / degree}});
    }
    return Json{{"lengths", lengths}, {"angles", angles}}.dump(1) + '\n';
}

} // namespace toile

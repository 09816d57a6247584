// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/sag_free_job.h"

#include "draping/drape.h"
#include "geometry/text.h"
#include "io/prescribed_json.h"
#include "io/preview.h"
#include "io/read_fabric.h"
#include "io/write_file.h"
#include "src/pipeline.h"
#include "src/rest_job.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>

namespace toile {
namespace {

using Json = nlohmann::ordered_json;

constexpr double degree = M_PI / 180;
constexpr std::uintmax_t most_bytes = 64u << 20;

bool is_list(const std::string& text) { return text.find_first_not_of("0123456789,") == std::string::npos; }

/// Numbers between commas, blanks and line ends.
std::vector<int> numbers_in(const std::string& text, const std::string& where) {
    constexpr const char* between = ", \t\r\n";
    std::vector<int> numbers;
    for (std::size_t at = text.find_first_not_of(between); at != std::string::npos;) {
        const std::size_t end = std::min(text.find_first_of(between, at), text.size());
        int& number = numbers.emplace_back();
        const auto [rest, error] = std::from_chars(text.data() + at, text.data() + end, number);
        if (error != std::errc() || rest != text.data() + end)
            throw InputError(toile::text("%s: expected numbers of points, found \"%.40s\"", where.c_str(),
                                         text.substr(at, end - at).c_str()));
        at = text.find_first_not_of(between, end);
    }
    return numbers;
}

std::vector<char> held_points(const SagFreeJob& job, const ReadGarment& read, const EdgeTable& edges) {
    std::vector<char> held(read.x.size(), 0);
    if (job.hold == "borders") {
        for (int e = 0; e < edges.size(); ++e)
            if (edges.triangles_at(e) == 1)
                for (const int i : edges.ends[e]) held[i] = 1;
    } else {
        const bool list = is_list(job.hold);
        const std::string where = list ? "--hold" : job.hold;
        const std::vector<int> point_of_file = points_of_file(read);
        for (const int number : numbers_in(list ? job.hold : read_file(job.hold, most_bytes), where)) {
            if (number < 1 || number > int(point_of_file.size()) || point_of_file[number - 1] < 0)
                throw InputError(text("%s: expected points of triangles of %s, found %d", where.c_str(), job.shape.c_str(), number));
            held[point_of_file[number - 1]] = 1;
        }
    }
    if (std::find(held.begin(), held.end(), 1) == held.end())
        throw InputError(job.hold == "borders" ? job.shape + ": it has no border that could be held"
                                               : (is_list(job.hold) ? "--hold" : job.hold) + ": expected points to hold, found none");
    return held;
}

Json edge_json(const Prescribed& data, const ReadGarment& read, int e) {
    return {read.file_node[data.edges.ends[e][0]] + 1, read.file_node[data.edges.ends[e][1]] + 1};
}

Json edges_json(const Prescribed& data, const ReadGarment& read, const std::vector<int>& edges) {
    Json all = Json::array();
    for (const int e : edges) all.push_back(edge_json(data, read, e));
    return all;
}

/// The largest of the changes, and the edge that has it.
Json largest_json(const Prescribed& data, const ReadGarment& read, const std::vector<double>& changes) {
    const auto most = std::max_element(changes.begin(), changes.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    return {{"max", *most}, {"along", *most == 0 ? Json() : edge_json(data, read, int(most - changes.begin()))}};
}

Json residual_json(const SagFree& found, const ReadGarment& read, double tolerance) {
    Json points = Json::array();
    for (std::size_t i = 0; i < found.missing.size(); ++i)
        if (found.missing[i].norm() > tolerance)
            points.push_back({{"point", read.file_node[i] + 1},
                              {"newtons", {found.missing[i].x(), found.missing[i].y(), found.missing[i].z()}}});
    const bool any = found.worst >= 0;
    return {{"max", any ? found.missing[found.worst].norm() : 0},
            {"at", any ? Json(read.file_node[found.worst] + 1) : Json()},
            {"points", points}};
}

const char* status_of(BalanceEnd end) {
    return end == BalanceEnd::balanced ? "balanced" : end == BalanceEnd::nearest ? "nearest" : "stalled";
}

double largest(const Points& forces) {
    double most = 0;
    for (const Vec3& f : forces) most = std::max(most, f.norm());
    return most;
}

void refuse_impossible(const SagFreeJob& job, const ReadGarment& read, const Prescribed& rest) {
    const int t = impossible_triangle(rest);
    if (t < 0) return;
    const Triangle& k = rest.triangles[t];
    throw InputError(text("%s: the lengths that would hold the triangle of points %d, %d and %d are those of no triangle; expected a "
                          "smaller --length-change",
                          job.shape.c_str(), read.file_node[k[0]] + 1, read.file_node[k[1]] + 1, read.file_node[k[2]] + 1));
}

Json report_of(const SagFreeJob& job, const ReadGarment& read, const Prescribed& shape, const SagFree& found, const Points& load,
               const std::string& fabric) {
    std::vector<double> lengths, angles;
    for (int e = 0; e < shape.edges.size(); ++e) {
        lengths.push_back(found.rest.length[e] / shape.length[e] - 1);
        angles.push_back((found.rest.angle[e] - shape.angle[e]) / degree);
    }
    double weight = 0;
    for (const Vec3& f : load) weight += f.norm();
    Json report{{"toile", TOILE_VERSION}, {"status", status_of(found.end)}, {"fabric", fabric}, {"weight", weight}};
    report["residual"] = residual_json(found, read, job.options.tolerance * largest(load));
    report["stable"] = found.end == BalanceEnd::balanced ? Json(found.stable) : Json();
    report["length_change"] = largest_json(shape, read, lengths);
    report["angle_change"] = largest_json(shape, read, angles);
    report["bounds"] = {{"length_change", job.options.length_change},
                        {"angle_change", job.options.angle_change / degree},
                        {"lengths", edges_json(shape, read, found.length_bounds)},
                        {"angles", edges_json(shape, read, found.angle_bounds)}};
    report["factorisations"] = found.factorisations;
    return report;
}

} // namespace

SagFreeOutcome run_sag_free(const SagFreeJob& job) {
    SagFreeOutcome outcome;
    for (const std::string& file : {job.rest, job.preview, job.report})
        if (!file.empty()) outcome.written.push_back(file);
    const bool hold_is_file = job.hold != "borders" && !is_list(job.hold);
    refuse_targets({job.shape, hold_is_file ? job.hold : "", fabric_file(job.fabric)}, outcome.written);
    const ReadGarment read = read_garment(job.shape);
    const Prescribed shape = measured_in(job.shape, read);
    const std::vector<char> held = held_points(job, read, shape.edges);
    const Fabric fabric = fabric_called(job.fabric);
    const Points load = weight_of(shape.triangles, read.x, fabric.density, DrapeOptions().gravity);
    const SagFree& found = outcome.found = sag_free(shape.triangles, read.x, fabric, load, held, job.options);
    refuse_impossible(job, read, found.rest);

    if (!job.rest.empty()) write_file(job.rest, prescribed_text(found.rest, read.file_node));
    if (!job.preview.empty()) {
        PreviewOptions options;
        const double most = found.end == BalanceEnd::balanced ? 0 : largest(found.missing);
        for (const Vec3& f : found.missing) options.heat.push_back(most > 0 ? f.norm() / most : 0);
        write_preview(job.preview, read.garment, read.x, {}, options);
    }
    outcome.report = report_of(job, read, shape, found, load, fabric.name).dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
    if (!job.report.empty()) write_file(job.report, outcome.report);
    return outcome;
}

} // namespace toile

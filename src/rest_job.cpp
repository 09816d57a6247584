// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/rest_job.h"

#include "draping/rest/consistency.h"
#include "geometry/text.h"
#include "io/prescribed_json.h"
#include "io/preview.h"
#include "io/read_fabric.h"
#include "io/write_file.h"
#include "io/write_garment.h"
#include "src/pipeline.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <numeric>

namespace fs = std::filesystem;

namespace toile {
namespace {

using Json = nlohmann::ordered_json;

constexpr double degree = M_PI / 180;
constexpr int most_second_opinions = 2000; // points; L-BFGS takes hundreds of evaluations

Prescribed measured_like(const std::string& path, const Prescribed& data) {
    const ReadGarment read = read_garment(path);
    Prescribed other = measured_in(path, read);
    if (other.triangles != data.triangles) throw InputError(path + ": expected the triangles of the shape, in its order");
    return other;
}

Prescribed read_data(const RestJob& job, const ReadGarment& read, const Fabric& fabric) {
    Prescribed data = measured_in(job.shape, read);
    if (!job.lengths_of.empty()) data.length = measured_like(job.lengths_of, data).length;
    if (!job.angles_of.empty()) data.angle = measured_like(job.angles_of, data).angle;
    if (!job.data.empty()) {
        read_prescribed(job.data, points_of_file(read), data);
    }
    if (const int t = impossible_triangle(data); t >= 0) {
        const Triangle& k = data.triangles[t];
        throw InputError(text("%s: no triangle has the lengths prescribed for points %d, %d and %d",
                              (job.data.empty() ? job.shape : job.data).c_str(), read.file_node[k[0]] + 1,
                              read.file_node[k[1]] + 1, read.file_node[k[2]] + 1));
    }
    if (job.length_weight > 0)
        data.length_weight.assign(data.length.size(), job.length_weight);
    else
        weigh(data, fabric);
    return data;
}

/// name.obj, name-2.obj, name-3.obj ...
std::string numbered(const std::string& path, int k) {
    if (k == 0) return path;
    const fs::path p(path);
    return (p.parent_path() / p.stem()).string() + text("-%d", k + 1) + p.extension().string();
}

/// By how much x is off the lengths told at most, as a share, and off the angles, in degrees.
double largest_stretch(const Prescribed& data, const Points& x) {
    double most = 0;
    for (int e = 0; e < data.edges.size(); ++e) {
        const auto& [a, b] = data.edges.ends[e];
        most = std::max(most, std::abs((x[b] - x[a]).norm() / data.length[e] - 1));
    }
    return most;
}

double largest_turn(const Prescribed& data, const Points& x) {
    double most = 0;
    const std::vector<double> angles = angles_of(data, x);
    for (int e = 0; e < data.edges.size(); ++e)
        if (data.edges.triangles_at(e) == 2) most = std::max(most, std::abs(angles[e] - data.angle[e]));
    return most / degree;
}

Json misfit_json(const std::vector<double>& off, const ReadGarment& read) {
    const auto most = std::max_element(off.begin(), off.end());
    Json points = Json::array();
    for (std::size_t i = 0; i < off.size(); ++i)
        if (off[i] > 1e-6) points.push_back({{"point", read.file_node[i] + 1}, {"degrees", off[i] / degree}});
    return {{"max", off.empty() ? 0 : *most / degree},
            {"at", off.empty() || *most == 0 ? Json() : Json(read.file_node[most - off.begin()] + 1)},
            {"points", points}};
}

/// From near the state, or it would have nothing to find; far away it might find another one.
Json second_opinion(const Prescribed& data, const FoundShape& first) {
    if (data.point_count > most_second_opinions) return {};
    const NearestShape other = nearest_shape_lbfgs(data, shaken(data, first.shape.x, 0.02, 1));
    const double scale = std::max(std::abs(first.shape.energy), 1e-300);
    return {{"by", "L-BFGS of NLopt"},
            {"energy", other.energy},
            {"difference", std::abs(other.energy - first.shape.energy) / scale},
            {"gradient", other.gradient},
            {"evaluations", other.iterations}};
}

std::vector<std::string> targets(const RestJob& job) {
    std::vector<std::string> all;
    if (!job.output.empty()) all = moved_files(job.output, job.shape);
    for (const std::string& file : {job.rest, job.preview, job.report})
        if (!file.empty()) all.push_back(file);
    return all;
}

} // namespace

Json states_json(const Prescribed& data, const std::vector<FoundShape>& states, const char* left) {
    Json all = Json::array();
    for (const FoundShape& f : states)
        all.push_back({{"energy", f.shape.energy},
                       {"mirror_of", f.mirror < 0 ? Json() : Json(f.mirror + 1)},
                       {"length_off_max", largest_stretch(data, f.shape.x)},
                       {"angle_off_max", largest_turn(data, f.shape.x)},
                       {left, f.shape.gradient},
                       {"iterations", f.shape.iterations}});
    return all;
}

void write_states(const std::string& path, bool all, const std::string& shape, const ReadGarment& read,
                  const std::vector<FoundShape>& states, std::vector<std::string>& written) {
    const std::size_t wanted = path.empty() ? 0 : all ? states.size() : 1;
    for (std::size_t k = 0; k < std::min(wanted, states.size()); ++k) {
        write_moved(numbered(path, int(k)), shape, read, states[k].shape.x);
        if (k > 0) written.push_back(numbered(path, int(k)));
    }
}

Prescribed measured_in(const std::string& path, const ReadGarment& read) {
    try {
        return measured(node_triangles(read.garment), read.x);
    } catch (const std::invalid_argument& error) {
        throw InputError(path + ": " + error.what());
    }
}

std::vector<int> points_of_file(const ReadGarment& read) {
    std::vector<int> points(1 + *std::max_element(read.file_node.begin(), read.file_node.end()), -1);
    for (std::size_t i = 0; i < read.file_node.size(); ++i) points[read.file_node[i]] = int(i);
    return points;
}

RestOutcome run_rest(const RestJob& job) {
    refuse_targets({job.shape, job.lengths_of, job.angles_of, job.data, fabric_file(job.fabric)}, targets(job));
    const ReadGarment read = read_garment(job.shape);
    const Fabric fabric = fabric_called(job.fabric);
    const Prescribed data = read_data(job, read, fabric);
    RestOutcome outcome;
    outcome.states = nearest_shapes(data, read.x);
    outcome.written = targets(job);

    const std::vector<double> off = misfit(data), defects = angle_defects(data);
    const DataCount count = count_data(data, outcome.states.empty() ? read.x : outcome.states[0].shape.x);
    Json report{{"toile", TOILE_VERSION}, {"status", outcome.states.empty() ? "stalled" : "found"}};
    report["weights"] = job.length_weight > 0 ? Json{{"length", job.length_weight}, {"angle", 1}} : Json{{"fabric", fabric.name}};
    report["data"] = {{"points", data.point_count},
                      {"inner_points", count.inner_points},
                      {"lengths", count.lengths},
                      {"angles", count.angles},
                      {"freedom", count.freedom},
                      {"rank", count.rank < 0 ? Json() : Json(count.rank)}};
    report["misfit"] = misfit_json(off, read);
    report["angle_defect_sum"] = std::accumulate(defects.begin(), defects.end(), 0.0) / degree;
    report["rest"] = job.relax ? "relaxed" : "kept";
    report["frozen_energy"] = outcome.states.empty() ? Json() : Json(job.relax ? 0 : outcome.states[0].shape.energy);
    report["states"] = states_json(data, outcome.states, "gradient");
    report["second_opinion"] = outcome.states.empty() ? Json() : second_opinion(data, outcome.states[0]);

    write_states(job.output, job.all_states, job.shape, read, outcome.states, outcome.written);
    if (!job.rest.empty() && !outcome.states.empty()) {
        Prescribed rest = data;
        if (job.relax) rest = measured(data.triangles, outcome.states[0].shape.x);
        write_file(job.rest, prescribed_text(rest, read.file_node));
    }
    if (!job.preview.empty()) {
        PreviewOptions options;
        const double most = *std::max_element(off.begin(), off.end());
        for (const double v : off) options.heat.push_back(most > 0 ? v / most : 0);
        write_preview(job.preview, read.garment, outcome.states.empty() ? read.x : outcome.states[0].shape.x, {}, options);
    }
    outcome.report = report.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
    if (!job.report.empty()) write_file(job.report, outcome.report);
    return outcome;
}

} // namespace toile

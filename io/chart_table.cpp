// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/chart_table.h"

#include "geometry/text.h"
#include "io/markup.h"

#include <nlohmann/json.hpp>

namespace toile {

namespace {

std::string status(const ChartPoint& p) { return p.failure.empty() ? "converged" : p.failure; }

} // namespace

std::string chart_csv(const Chart& chart) {
    std::string csv = "scene,method,edge_length,step,error,error_solver,seconds_cpu,seconds_wall,status\n";
    for (const ChartPoint& p : chart.points)
        csv += csv_field(p.scene) + ',' + to_string(p.method) + text(",%.6g,%.6g,%.6g,", p.edge_length, p.step, p.error) +
               (p.error_solver ? text("%.6g", *p.error_solver) : "") + text(",%.6g,%.6g,", p.seconds_cpu, p.seconds_wall) +
               csv_field(status(p)) + '\n';
    return csv;
}

std::string chart_json(const Chart& chart, const ChartMachine& machine) {
    nlohmann::ordered_json json;
    json["toile_chart"] = 1;
    json["machine"] = {{"processor", machine.processor}, {"threads", machine.threads}, {"version", machine.version}, {"blas", machine.blas}};
    json["scenes"] = nlohmann::ordered_json::array();
    for (const ChartScene& s : chart.scenes) {
        nlohmann::ordered_json scene{{"name", s.scene.name}, {"quantity", s.scene.quantity}, {"answer", s.answer}, {"answer_from", s.answer_from}};
        if (s.scene.band) scene["band"] = {s.scene.band->low, s.scene.band->high};
        json["scenes"].push_back(std::move(scene));
    }
    json["points"] = nlohmann::ordered_json::array();
    for (const ChartPoint& p : chart.points) {
        nlohmann::ordered_json point{{"scene", p.scene},   {"method", to_string(p.method)}, {"edge_length", p.edge_length},
                                     {"step", p.step},     {"value", p.value},              {"error", p.error},
                                     {"error_solver", nullptr}, {"seconds_cpu", p.seconds_cpu}, {"seconds_wall", p.seconds_wall},
                                     {"status", status(p)}, {"front", p.front}};
        if (p.error_solver) point["error_solver"] = *p.error_solver;
        json["points"].push_back(std::move(point));
    }
    return json.dump(1) + '\n';
}

} // namespace toile

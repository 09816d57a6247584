// SPDX-License-Identifier: GPL-3.0-or-later
// The figures of docs/cut.md: a garment cut from a body at a distance, and how far from the surface that it was cut from it drapes;
// bodice_cuts.json has the lines of a bodice.

#include "geometry/inside.h"
#include "src/cut_job.h"
#include "src/pipeline.h"
#include "src/quantity.h"
#include "tests/support/temp_folder.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>

using namespace toile;

namespace {

double root_mean_square(const std::vector<double>& values) {
    double sum = 0;
    for (const double v : values) sum += v * v / double(values.size());
    return std::sqrt(sum);
}

TriMesh joined(const std::vector<CutPiece>& pieces) {
    TriMesh all;
    for (const CutPiece& piece : pieces) {
        const int first = int(all.points.size());
        all.points.insert(all.points.end(), piece.mesh.points.begin(), piece.mesh.points.end());
        for (const auto& [a, b, c] : piece.mesh.triangles) all.triangles.push_back({a + first, b + first, c + first});
    }
    return all;
}

void measure(const std::string& body, const std::string& lines, double offset, double edge) {
    const test::TempFolder folder;
    CutJob job;
    job.body = body, job.lines = lines, job.output = folder / "bodice.json";
    job.offset = offset, job.edge = edge;
    const CutOutcome cut = run_cut(job);
    const auto report = nlohmann::json::parse(cut.report);
    DrapeJob drape;
    drape.pattern = job.output, drape.avatar = body, drape.fabric = "poplin";
    const DrapeOutcome draped = run_job(drape);
    const std::vector<double> off = surface_distances(joined(cut.pieces), draped.result.state.positions);
    double worst = 0, differ = 0;
    std::printf("offset %.0f mm, edges of %.0f mm:", 1e3 * offset, 1e3 * edge);
    for (const auto& p : report["panels"])
        std::printf(" %s mean %.2f %%, max %.1f %%;", p["name"].get<std::string>().c_str(), 100 * p["strain_mean"].get<double>(),
                    100 * p["strain_max"].get<double>());
    for (const double d : off) worst = std::max(worst, d);
    for (const auto& s : report["seams"]) differ = std::max(differ, std::abs(s["length_a"].get<double>() - s["length_b"].get<double>()));
    std::printf(" seams differ by %.2f mm; %s, off by %.2f mm (root mean square), at most %.1f mm\n", 1e3 * differ,
                draped.result.status == DrapeStatus::converged ? "at rest" : "not at rest", 1e3 * root_mean_square(off), 1e3 * worst);
    std::fflush(stdout);
}

} // namespace

int main(int count, char** arguments) {
    if (count < 5 || count % 2 == 0) {
        std::fputs("usage: bench_cut body.obj bodice_cuts.json OFFSET EDGE [OFFSET EDGE]..., such as 6mm 20mm\n", stderr);
        return 1;
    }
    for (int i = 3; i < count; i += 2) measure(arguments[1], arguments[2], parse_length(arguments[i]), parse_length(arguments[i + 1]));
}

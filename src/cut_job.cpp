// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/cut_job.h"

#include "geometry/disjoint_sets.h"
#include "geometry/edges.h"
#include "geometry/offset_surface.h"
#include "geometry/text.h"
#include "io/preview.h"
#include "io/read_avatar.h"
#include "io/read_cut_lines.h"
#include "io/read_garment.h"
#include "io/write_file.h"
#include "io/write_pattern.h"
#include "patterns/check.h"
#include "sewing/check_cut.h"
#include "src/pipeline.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace toile {
namespace {

using Json = nlohmann::ordered_json;

constexpr double degree = EIGEN_PI / 180;
constexpr double dart_worth = 5 * degree; // below it, cloth takes up what a dart would
constexpr double smoothing = 0.05; // width of the bell by which curvature is smoothed, as a share of the root of the panel's area

TriMesh surface_of(const CutJob& job) {
    if (job.offset > 0) return offset_surface(read_avatar(job.body).body, job.offset, job.edge);
    const ReadGarment read = read_garment(job.body);
    return {read.x, node_triangles(read.garment)};
}

Json place_json(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

/// The larger of the two principal strains by amount, of every triangle.
std::vector<double> strains_of(const CutPiece& piece) {
    std::vector<double> all;
    for (int t = 0; t < int(piece.mesh.triangles.size()); ++t) all.push_back(laid_strain(piece.mesh, piece.flat.points, t).cwiseAbs().maxCoeff());
    return all;
}

/// 2 pi less the corners at a point, rad; 0 on the border.
std::vector<double> angle_defects(const TriMesh& mesh) {
    std::vector<double> defects(mesh.points.size(), 2 * EIGEN_PI);
    for (const Triangle& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) {
            const Vec3 a = mesh.points[t[(k + 1) % 3]] - mesh.points[t[k]], b = mesh.points[t[(k + 2) % 3]] - mesh.points[t[k]];
            defects[t[k]] -= std::atan2(a.cross(b).norm(), a.dot(b));
        }
    for (const int p : border_loop(mesh)) defects[p] = 0;
    return defects;
}

/// By point, the number of its patch: points joined by edges where curvature, smoothed, has one sign.
std::vector<int> patches_of(const TriMesh& mesh, const std::vector<double>& defects) {
    double area = 0;
    for (const Triangle& t : mesh.triangles) area += triangle_area(mesh.points, t);
    const double width = smoothing * std::sqrt(area);
    std::vector<char> domed(mesh.points.size());
    for (std::size_t i = 0; i < domed.size(); ++i) {
        double sum = 0;
        for (std::size_t k = 0; k < domed.size(); ++k)
            sum += defects[k] * std::exp(-0.5 * (mesh.points[k] - mesh.points[i]).squaredNorm() / (width * width));
        domed[i] = sum > 0;
    }
    DisjointSets patches(int(mesh.points.size()));
    for (const auto& [a, b] : make_edges(mesh.triangles, int(mesh.points.size())).ends)
        if (domed[a] == domed[b]) patches.join(a, b);
    std::vector<int> all;
    for (int i = 0; i < int(mesh.points.size()); ++i) all.push_back(patches.find(i));
    return all;
}

/// What would take away the curvature of a patch: a dart of that angle with its point in the middle of it, from the nearest place of the
/// border; where it is negative, a gusset.
Json dart_json(const CutPiece& piece, const std::vector<double>& defects, const std::vector<int>& patch, int number, double all) {
    double weight = 0;
    Vec3 middle = Vec3::Zero();
    std::vector<int> own;
    for (std::size_t i = 0; i < defects.size(); ++i) {
        if (patch[i] != number) continue;
        own.push_back(int(i));
        if (defects[i] * all > 0) weight += std::abs(defects[i]), middle += std::abs(defects[i]) * piece.mesh.points[i];
    }
    middle /= weight;
    const auto nearest = [&](const std::vector<int>& points) {
        return piece.mesh.points[*std::min_element(points.begin(), points.end(), [&](int a, int b) {
            return (piece.mesh.points[a] - middle).norm() < (piece.mesh.points[b] - middle).norm();
        })];
    };
    return {{"kind", all > 0 ? "dart" : "gusset"},
            {"degrees", all / degree},
            {"point", place_json(nearest(own))},
            {"from", place_json(nearest(border_loop(piece.mesh)))}};
}

/// Of every patch whose curvature is worth a dart, the most first.
Json darts_json(const CutPiece& piece) {
    const std::vector<double> defects = angle_defects(piece.mesh);
    const std::vector<int> patch = patches_of(piece.mesh, defects);
    std::vector<double> sum(defects.size(), 0);
    for (std::size_t i = 0; i < defects.size(); ++i) sum[patch[i]] += defects[i];
    std::vector<int> order(sum.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return std::abs(sum[a]) > std::abs(sum[b]); });
    Json all = Json::array();
    for (const int p : order)
        if (std::abs(sum[p]) > dart_worth) all.push_back(dart_json(piece, defects, patch, p, sum[p]));
    return all;
}

Json panel_json(const CutPiece& piece) {
    const std::vector<double> strains = strains_of(piece);
    double mean = 0, area = 0;
    for (std::size_t t = 0; t < strains.size(); ++t) {
        const double own = triangle_area(piece.mesh.points, piece.mesh.triangles[t]);
        mean += strains[t] * own;
        area += own;
    }
    const int worst = int(std::max_element(strains.begin(), strains.end()) - strains.begin());
    Vec3 at = Vec3::Zero();
    for (const int p : piece.mesh.triangles[worst]) at += piece.mesh.points[p] / 3;
    return {{"name", piece.name},           {"area", area},
            {"strain_max", strains[worst]}, {"at", place_json(at)},
            {"strain_mean", mean / area},   {"settled", piece.flat.settled},
            {"would_take", darts_json(piece)}};
}

Json seams_json(const Pattern& pattern) {
    Json all = Json::array();
    for (const Seam& seam : pattern.seams) {
        const SeamLengths l = seam_lengths(pattern, seam);
        all.push_back({{"line", seam.name},
                       {"a", pattern.panels[seam.a[0].panel].name}, {"edge_a", seam.a[0].edge}, {"length_a", l.a},
                       {"b", pattern.panels[seam.b[0].panel].name}, {"edge_b", seam.b[0].edge}, {"length_b", l.b}});
    }
    return all;
}

/// All pieces as one garment that lies where it was cut, for the picture and the file of the surface.
struct AsCut {
    Garment garment;
    Points x;
    std::vector<double> strain; ///< per node, the mean of its triangles
};

AsCut as_cut(const std::vector<CutPiece>& pieces) {
    AsCut all;
    Garment& g = all.garment;
    for (const CutPiece& piece : pieces) {
        const int first = int(all.x.size()), panel = int(g.panel_names.size());
        g.panel_names.push_back(piece.name);
        g.panel_fabrics.emplace_back();
        g.panel_layers.push_back(0);
        const std::vector<double> strains = strains_of(piece);
        std::vector<double> sum(piece.mesh.points.size(), 0), count(sum);
        for (std::size_t t = 0; t < piece.mesh.triangles.size(); ++t) {
            const auto& [a, b, c] = piece.mesh.triangles[t];
            g.triangles.push_back({a + first, b + first, c + first});
            g.panel_of_triangle.push_back(panel);
            for (const int p : piece.mesh.triangles[t]) sum[p] += strains[t], count[p] += 1;
        }
        for (std::size_t i = 0; i < sum.size(); ++i) {
            all.x.push_back(piece.mesh.points[i]);
            g.uv.push_back(piece.flat.points[i]);
            g.panel_of_vertex.push_back(panel);
            g.node_of_vertex.push_back(first + int(i));
            all.strain.push_back(sum[i] / count[i]);
        }
    }
    g.node_count = int(all.x.size());
    g.edges = make_edges(g.triangles, g.node_count);
    g.seam_edge.assign(g.edges.size(), false);
    g.eased_triangle.assign(g.triangles.size(), false);
    g.rest.angles.assign(g.edges.size(), 0.0);
    for (const Triangle& t : g.triangles) {
        Mat2& e = g.rest.edges.emplace_back();
        e << g.uv[t[1]] - g.uv[t[0]], g.uv[t[2]] - g.uv[t[0]];
    }
    return all;
}

std::vector<std::string> targets(const CutJob& job) {
    std::vector<std::string> all;
    for (const std::string& file : {job.output, job.preview, job.report})
        if (!file.empty()) all.push_back(file);
    if (!job.surface.empty())
        for (const std::string& file : garment_files(job.surface)) all.push_back(file);
    return all;
}

} // namespace

CutOutcome run_cut(const CutJob& job) {
    refuse_targets({job.body, job.lines}, targets(job));
    const CutLines lines = read_cut_lines(job.lines);
    const LinedMesh surface = draw_lines(surface_of(job), lines, job.lines);
    std::vector<std::string> names;
    for (const CutLine& line : lines.lines) names.push_back(line.name);
    CutOutcome outcome;
    try {
        outcome.pieces = cut_out(surface, lines.panels);
        outcome.pattern = pattern_of(surface, outcome.pieces, names);
        expect_sound(outcome.pattern);
    } catch (const std::invalid_argument& error) {
        throw InputError(job.lines + ": " + error.what());
    }
    outcome.written = targets(job);

    Json report{{"toile", TOILE_VERSION}, {"offset", job.offset}, {"panels", Json::array()}};
    for (const CutPiece& piece : outcome.pieces) report["panels"].push_back(panel_json(piece));
    report["seams"] = seams_json(outcome.pattern);
    outcome.report = report.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
    write_file(job.output, pattern_text(outcome.pattern));
    const AsCut all = as_cut(outcome.pieces);
    if (!job.surface.empty()) write_garment(job.surface, all.garment, all.x, {});
    if (!job.preview.empty()) {
        PreviewOptions options;
        const double most = *std::max_element(all.strain.begin(), all.strain.end());
        for (const double s : all.strain) options.heat.push_back(most > 0 ? s / most : 0);
        write_preview(job.preview, all.garment, all.x, {}, options);
    }
    if (!job.report.empty()) write_file(job.report, outcome.report);
    return outcome;
}

} // namespace toile

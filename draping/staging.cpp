// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/staging.h"

#include "draping/rest/moulded.h"
#include "sewing/arrange.h"

#include <algorithm>
#include <map>

namespace toile {

namespace {

constexpr double gathered = 0.98; // an elastic of a smaller ratio gathers its cloth

double mean_flat_edge(const Garment& g) {
    double sum = 0;
    for (const Mat2& e : g.rest.edges)
        sum += e.col(0).norm() + e.col(1).norm() + (e.col(1) - e.col(0)).norm();
    return g.rest.edges.empty() ? 0 : sum / (3 * double(g.rest.edges.size()));
}

std::vector<std::string> names_by_panels(const Garment& g) {
    std::vector<int> panel(g.node_count, -1);
    for (int v = int(g.uv.size()) - 1; v >= 0; --v)
        panel[g.node_of_vertex[v]] = g.panel_of_vertex[v];
    std::vector<std::string> names;
    for (const Stitch& s : g.stitches) {
        if (s.seam >= int(names.size())) names.resize(s.seam + 1);
        if (names[s.seam].empty())
            names[s.seam] = "the seam of panels " + g.panel_names[panel[s.a]] + " and " +
                            g.panel_names[panel[s.b[0]]];
    }
    return names;
}

void mark_gathered(Garment& g, const std::vector<Elastic>& elastics) {
    std::vector<bool> on_elastic(g.uv.size(), false);
    for (const Elastic& elastic : elastics)
        if (elastic.ratio < gathered)
            for (int v : vertices_along(g, elastic.span))
                on_elastic[v] = true;
    for (std::size_t t = 0; t < g.triangles.size(); ++t)
        for (int v : g.triangles[t])
            if (on_elastic[v]) g.eased_triangle[t] = true;
}

/// Panels with a rest mesh take its shape; the others stay flat, to the last bit.
void mould(const Pattern& pattern, Garment& g) {
    const auto curved = [&](int p) { return pattern.panels[p].rest.has_value(); };
    Points x;
    std::size_t first = 0; // vertex of the panel
    bool any = false;
    for (std::size_t v = 0; v < g.uv.size(); ++v) {
        const int p = g.panel_of_vertex[v];
        if (p != g.panel_of_vertex[first]) first = v;
        x.push_back(curved(p) ? pattern.panels[p].rest->mesh.points[v - first] : Vec3(g.uv[v].x(), g.uv[v].y(), 0));
        any = any || curved(p);
    }
    if (!any) return;
    const RestShape shape = moulded(g, x);
    g.rest.curvature.assign(g.triangles.size(), Mat3::Zero());
    for (std::size_t t = 0; t < g.triangles.size(); ++t) {
        if (!curved(g.panel_of_triangle[t])) continue;
        g.rest.edges[t] = shape.edges[t];
        g.rest.curvature[t] = shape.curvature[t];
    }
}

} // namespace

Staging stage(const Pattern& pattern, const FlatPattern& flat) {
    Staging s;
    s.pins = pattern.pins;
    s.elastics = pattern.elastics;
    s.prolongation = flat.prolongation;
    for (const Seam& seam : pattern.seams)
        s.seam_names.push_back(seam.name);
    for (const FlatLevel& level : flat.levels) {
        s.levels.push_back({level.edge_length, sew(pattern, level), place(pattern, level)});
        mould(pattern, s.levels.back().garment);
        mark_gathered(s.levels.back().garment, s.elastics);
    }
    return s;
}

Staging stage(Garment garment, Points placed, std::vector<Pin> pins, std::vector<Elastic> elastics) {
    Staging s;
    s.pins = std::move(pins);
    s.elastics = std::move(elastics);
    mark_gathered(garment, s.elastics);
    s.seam_names = names_by_panels(garment);
    const double edge = mean_flat_edge(garment);
    s.levels.push_back({edge, std::move(garment), std::move(placed)});
    return s;
}

Staging without_coarsest(const Staging& staging) {
    Staging finer = staging;
    finer.levels.erase(finer.levels.begin());
    finer.prolongation.erase(finer.prolongation.begin());
    return finer;
}

std::vector<std::pair<int, Vec3>> pinned_places(const Staging& staging, int level, const Garment& garment) {
    const StagedLevel& staged = staging.levels[level];
    std::map<int, std::pair<Vec3, int>> sum;
    for (const Pin& pin : staging.pins)
        for (int v : vertices_along(garment, pin.span)) {
            auto& [place, count] = sum.try_emplace(garment.node_of_vertex[v], Vec3::Zero(), 0).first->second;
            place += staged.placed[staged.garment.node_of_vertex[v]];
            ++count;
        }
    std::vector<std::pair<int, Vec3>> places;
    for (const auto& [node, s] : sum)
        places.emplace_back(node, s.first / s.second);
    return places;
}

std::vector<ElasticSegment> elastic_segments(const std::vector<Elastic>& elastics, const Garment& garment) {
    std::vector<ElasticSegment> segments;
    for (const Elastic& elastic : elastics) {
        const std::vector<int> line = vertices_along(garment, elastic.span);
        for (std::size_t k = 0; k + 1 < line.size(); ++k) {
            const int a = garment.node_of_vertex[line[k]], b = garment.node_of_vertex[line[k + 1]];
            if (a == b) continue;
            segments.push_back({a, b, elastic.ratio * cut_length(garment, line[k], line[k + 1]), elastic.stiffness});
        }
    }
    return segments;
}

} // namespace toile

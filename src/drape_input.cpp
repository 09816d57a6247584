// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/drape_input.h"

#include "geometry/memory.h"
#include "io/companion.h"
#include "io/read_fabric.h"
#include "io/read_pattern.h"
#include "io/read_staged.h"
#include "patterns/curve.h"
#include "src/quantity.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace toile {
namespace {

constexpr double max_triangles = 2e6;

constexpr double bytes_per_triangle = 400; // for all levels while they are made; 310 were seen

double area_of(const Pattern& pattern) {
    double area = 0;
    for (const Panel& panel : pattern.panels)
        area += std::abs(signed_area(panel.outline));
    return area;
}

void refuse_too_fine(const Pattern& pattern, double edge_length, double max_memory) {
    double triangles = area_of(pattern) / (std::sqrt(3.0) / 4 * edge_length * edge_length);
    for (const Panel& panel : pattern.panels)
        if (panel.rest) triangles += double(panel.rest->mesh.triangles.size());
    if (triangles > max_triangles)
        throw InputError("at this edge length the pattern has about " +
                         std::to_string(long(triangles / 1e6)) + " million triangles, more than the " +
                         std::to_string(long(max_triangles / 1e6)) + " million that are draped");
    const double needed = memory_use().now + bytes_per_triangle * triangles;
    if (needed > max_memory)
        throw InputError("at this edge length the pattern has about " + std::to_string(long(triangles)) +
                         " triangles, whose meshes alone take about " + show_size(needed) +
                         " of memory, more than --max-memory allows");
}

/// The panel's own fabric, else the one asked for, else the pattern's, else poplin.
void take_fabrics(const Pattern& pattern, const std::string& common, DrapeInput& input) {
    for (const Panel& panel : pattern.panels) {
        const std::string& name = panel.fabric.empty() ? common : panel.fabric;
        try {
            input.fabrics.push_back(fabric_called(name));
        } catch (const std::invalid_argument& error) {
            throw InputError("panel " + panel.name + ": " + error.what());
        }
        if (is_fabric_file(name)) input.files.push_back(name);
    }
    input.fabric = fabric_called(common).name;
}

std::string common_fabric(const Pattern& pattern, const std::string& asked) {
    return !asked.empty() ? asked : !pattern.fabric.empty() ? pattern.fabric : "poplin";
}

/// Where the vertices of a border loop lie, as fractions of its length.
std::vector<double> fractions(const Garment& g, const std::vector<int>& line) {
    std::vector<double> at{0};
    for (std::size_t k = 1; k < line.size(); ++k)
        at.push_back(at.back() + (g.uv[line[k]] - g.uv[line[k - 1]]).norm());
    const double whole = at.back();
    for (double& a : at)
        a /= whole;
    return at;
}

/// What a companion can speak of: the panels, each with an edge per loop of its border.
Pattern named_panels(const Garment& g) {
    Pattern pattern;
    for (const std::string& name : g.panel_names) {
        pattern.panels.emplace_back();
        pattern.panels.back().name = name;
    }
    for (const BorderLine& line : g.borders)
        pattern.panels[line.panel].outline.push_back(
            {g.uv[line.vertices.front()], g.uv[line.vertices.back()], Straight{}, line.label});
    return pattern;
}

void refuse_shapes(const Pattern& pattern, const std::string& companion) {
    for (const Panel& panel : pattern.panels)
        if (!panel.holes.empty() || !panel.lines.empty() || panel.grain != Panel{}.grain ||
            panel.shrink != Vec2::Zero())
            throw InputError(companion + " gives panel \"" + panel.name +
                             "\" a grain, shrinkage, holes or lines; a staged mesh has its own, and fabric, layer, pins and "
                             "elastics were expected");
    if (!pattern.seams.empty())
        throw InputError(companion + " gives seams; a staged mesh has its stitches in the mesh file");
}

} // namespace

bool is_staged(const std::string& path) {
    return path.ends_with(".obj");
}

Pattern sound_pattern(const std::string& path, std::vector<std::string>& warnings) {
    Pattern pattern = read_pattern(path);
    std::vector<std::string> errors;
    for (const Issue& issue : check(pattern)) {
        if (issue.severity == Severity::error) errors.push_back(issue.text);
        if (issue.severity == Severity::warning) warnings.push_back(issue.text);
    }
    if (errors.empty()) return pattern;
    const std::string more =
        errors.size() == 1 ? ""
                           : " ('toile check' lists this and " + std::to_string(errors.size() - 1) + " more)";
    throw InputError(path + ": " + errors[0] + more);
}

const Panel* moulded_panel(const Pattern& pattern) {
    for (const Panel& panel : pattern.panels)
        if (panel.rest) return &panel;
    return nullptr;
}

double finest_edge(const Pattern& pattern, double max_memory) {
    const double room = (max_memory - memory_use().now) / bytes_per_triangle;
    return std::sqrt(area_of(pattern) / (std::sqrt(3.0) / 4 * std::clamp(room, 1.0, max_triangles)));
}

FlatPattern flat_of(const Pattern& pattern, double edge_length, bool grain_lattice,
                    const std::function<double(int panel, const Vec2& at)>& size) {
    TriangulateOptions options;
    options.edge_length = edge_length;
    options.levels = levels_for(edge_length);
    options.grain_lattice = grain_lattice;
    options.size = size;
    return triangulate(pattern, options);
}

DrapeInput input_of(const Pattern& pattern, const std::string& fabric, double edge_length, double max_memory,
                    bool grain_lattice) {
    refuse_too_fine(pattern, edge_length, max_memory);
    DrapeInput input;
    take_fabrics(pattern, common_fabric(pattern, fabric), input);
    for (const Panel& panel : pattern.panels)
        if (panel.rest) input.files.push_back(panel.rest->file);
    if (const Panel* panel = moulded_panel(pattern); panel && grain_lattice)
        throw InputError("panel " + panel->name + " keeps the triangles of " + panel->rest->file +
                         ", which do not lie along warp and weft as those of inextensible cloth must; another --method was expected");
    try {
        input.staging = stage(pattern, flat_of(pattern, edge_length, grain_lattice));
    } catch (const std::runtime_error& error) {
        if (!moulded_panel(pattern)) throw;
        throw InputError(error.what()); // check() cannot know where seams will ask for points
    }
    return input;
}

DrapeInput read_staged_input(const std::string& path, const std::string& fabric, const TriMesh& body) {
    ReadStagedOptions options;
    options.body = &body;
    StagedMesh staged = read_staged(path, options);
    Garment& g = staged.garment;
    for (BorderLine& line : g.borders)
        line.at = fractions(g, line.vertices);
    Pattern said = named_panels(g);
    const std::string companion = companion_path(path);
    if (std::filesystem::exists(companion)) {
        read_companion(companion, said);
        refuse_shapes(said, companion);
    }
    DrapeInput input;
    input.notes = std::move(staged.notes);
    take_fabrics(said, common_fabric(said, fabric), input);
    for (std::size_t p = 0; p < said.panels.size(); ++p) {
        g.panel_fabrics[p] = said.panels[p].fabric;
        g.panel_layers[p] = said.panels[p].layer;
    }
    input.staging = stage(std::move(g), std::move(staged.positions), std::move(said.pins), std::move(said.elastics));
    return input;
}

int levels_for(double edge_length) {
    int levels = 1;
    for (double coarsest = edge_length; coarsest < 0.04 - 1e-9; coarsest *= 2)
        ++levels;
    return levels;
}

} // namespace toile

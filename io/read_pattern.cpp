// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_pattern.h"

#include "io/companion.h"
#include "io/json.h"
#include "io/read_edge.h"
#include "io/read_placement.h"
#include "io/write_file.h"
#include "patterns/curve.h"

#include <cmath>
#include <filesystem>
#include <map>

namespace toile {
namespace {

constexpr int max_edges = 100'000;

/// How the file is to be understood.
struct Conventions : EdgeConventions {
    bool centre_panels = false;
    bool normalise_loops = false;
};

struct Reader {
    Conventions as;
    Pattern pattern;
    std::map<std::string, int> panel_index;
    int edges = 0;
};

Conventions read_conventions(const JsonView& root) {
    const JsonView properties = root.at("properties");
    Conventions c;
    c.metres = read_unit(properties);
    if (properties.has("curvature_coords")) {
        const JsonView coords = properties.at("curvature_coords");
        const std::string word = coords.string();
        if (word != "relative" && word != "absolute") coords.fail("\"relative\" or \"absolute\"");
        c.absolute_control = word == "absolute";
    }
    if (properties.has("normalize_panel_translation"))
        c.centre_panels = properties.at("normalize_panel_translation").boolean();
    c.normalise_loops =
        !properties.has("normalized_edge_loops") || !properties.at("normalized_edge_loops").boolean();
    return c;
}

/// Moves the panel's origin to the mean of its vertices, as the files' own loader does: the translation takes
/// up the shift before rotation.
void centre(std::vector<Vec2>& vertices, Vec3& translation) {
    Vec2 mean = Vec2::Zero();
    for (const Vec2& v : vertices)
        mean += v / double(vertices.size());
    for (Vec2& v : vertices)
        v -= mean;
    translation.head<2>() += mean;
}

Vec2 mirrored(const Vec2& p) {
    return {-p.x(), p.y()};
}

Curve mirrored(const Curve& curve) {
    if (auto* q = std::get_if<Quadratic>(&curve)) return Quadratic{mirrored(q->control)};
    if (auto* k = std::get_if<Cubic>(&curve)) return Cubic{mirrored(k->control0), mirrored(k->control1)};
    if (auto* a = std::get_if<Arc>(&curve)) return Arc{a->radius, a->large, !a->right};
    return curve;
}

/// Files before 2023 draw some panels clockwise and mean the loader to turn them over: mirrored in the plane
/// and turned by 180 degrees about y, which leaves the cloth where it is, and with the x of the translation
/// negated, which does not (the files count on it). Edge numbers stay those of the file.
void turn_over(Panel& panel) {
    for (Edge& e : panel.outline)
        e = {mirrored(e.start), mirrored(e.end), mirrored(e.curve), e.label};
    panel.placement.translation.x() *= -1;
    panel.placement.rotation = panel.placement.rotation * Vec3(-1, 1, -1).asDiagonal();
}

Panel read_panel(const JsonView& v, const std::string& name, Reader& reader) {
    const Conventions& as = reader.as;
    Panel panel;
    panel.name = name;
    panel.placement.rotation = read_rotation(v.at("rotation"));
    panel.placement.translation = read_vector(v.at("translation"), as.metres);
    if (v.has("label")) panel.label = v.at("label").string();

    std::vector<Vec2> vertices = read_vertices(v.at("vertices"), as.metres);
    if (as.centre_panels) centre(vertices, panel.placement.translation);

    const JsonView edges = v.at("edges");
    edges.expect_array(1);
    reader.edges += int(std::min<std::size_t>(edges.value().size(), max_edges + 1));
    if (reader.edges > max_edges)
        throw InputError(v.place() + ": the pattern has more than " + std::to_string(max_edges) +
                         " edges, the most that is read");
    for (std::size_t i = 0; i < edges.value().size(); ++i)
        panel.outline.push_back(
            read_edge(v.below(edges.value()[i], "edge " + std::to_string(i)), vertices, as));
    if (as.normalise_loops && signed_area(panel.outline) < 0) turn_over(panel);
    return panel;
}

EdgeSpan read_stitch_side(const JsonView& v, const Reader& reader) {
    v.expect_object();
    const JsonView name = v.at("panel");
    const auto found = reader.panel_index.find(name.string());
    if (found == reader.panel_index.end()) name.fail("the name of a panel");
    const int count = int(reader.pattern.panels[found->second].outline.size());
    const JsonView number = v.at("edge");
    const double edge = number.value().is_number_integer() ? number.number() : -1;
    if (edge < 0 || edge >= count)
        number.fail("the number of an edge of panel " + in_quotes(found->first) + ", 0 to " +
                    std::to_string(count - 1));
    return {found->second, int(edge), 0, 1};
}

Seam read_stitch(const JsonView& v, int number, const Reader& reader) {
    v.expect_array(2, 3);
    Seam seam;
    EdgeSpan a = read_stitch_side(v.below(v.value()[0], "side 0"), reader);
    EdgeSpan b = read_stitch_side(v.below(v.value()[1], "side 1"), reader);
    seam.faces = SeamFaces::right_to_right;
    if (v.value().size() == 3) {
        const JsonView word = v.below(v.value()[2], "third member");
        if (word.string() != "right_wrong") word.fail("\"right_wrong\"");
        seam.faces = SeamFaces::right_to_wrong;
    } else {
        std::swap(b.t0, b.t1); // the end of a meets the start of b
    }
    const auto called = [&](const EdgeSpan& s) {
        return reader.pattern.panels[s.panel].name + "." + std::to_string(s.edge);
    };
    seam.name = "seam " + std::to_string(number) + " (" + called(a) + " to " + called(b) + ")";
    seam.a = {a};
    seam.b = {b};
    return seam;
}

void read_panels(const JsonView& pattern, const std::string& file, Reader& reader) {
    const JsonView panels = pattern.at("panels");
    panels.expect_object();
    for (const auto& [name, value] : panels.value().items()) {
        const JsonView panel(value, file + ": panel " + in_quotes(name));
        panel.expect_object();
        reader.panel_index[name] = int(reader.pattern.panels.size());
        reader.pattern.panels.push_back(read_panel(panel, name, reader));
    }
}

void read_stitches(const JsonView& pattern, const std::string& file, Reader& reader) {
    const JsonView stitches = pattern.at("stitches");
    stitches.expect_array(0, max_edges);
    for (std::size_t i = 0; i < stitches.value().size(); ++i) {
        const JsonView stitch(stitches.value()[i], file + ": stitch " + std::to_string(i));
        reader.pattern.seams.push_back(read_stitch(stitch, int(i), reader));
    }
}

Pattern read(const std::string& text, const std::string& name) {
    const Json json = parse_json(text, name);
    const JsonView root(json, name);
    if (!json.is_object())
        root.fail("a GarmentCode specification (an object with \"pattern\" and \"properties\")");
    Reader reader;
    const JsonView pattern = root.at("pattern");
    reader.as = read_conventions(root);
    read_panels(pattern, name, reader);
    read_stitches(pattern, name, reader);
    return std::move(reader.pattern);
}

void refuse_empty(const Pattern& pattern, const std::string& file) {
    if (pattern.panels.empty()) throw InputError(file + " has no panels");
}

constexpr std::uintmax_t max_bytes = JsonLimits{}.max_bytes;

} // namespace

Pattern read_pattern(std::istream& in, const std::string& name) {
    Pattern pattern = read(read_text(in, name, max_bytes), name);
    pattern.name = std::filesystem::path(name).stem().string();
    refuse_empty(pattern, name);
    return pattern;
}

Pattern read_pattern(const std::string& path) {
    Pattern pattern = read(read_file(path, max_bytes), path);
    pattern.name = std::filesystem::path(path).stem().string();
    const std::string companion = companion_path(path);
    if (std::filesystem::exists(companion)) read_companion(companion, pattern);
    refuse_empty(pattern, path);
    return pattern;
}

} // namespace toile

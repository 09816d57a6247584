// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/companion.h"

#include "draping/fabric/fabric.h"
#include "io/json.h"
#include "io/read_edge.h"
#include "io/read_fabric.h"
#include "io/read_placement.h"
#include "io/read_rest_mesh.h"
#include "io/write_file.h"
#include "patterns/shrink.h"

#include <algorithm>
#include <climits>
#include <filesystem>
#include <sstream>

namespace fs = std::filesystem;

namespace toile {
namespace {

constexpr std::size_t max_items = 10'000;  ///< of pins, elastics, seams, holes, lines each
constexpr std::size_t max_named = 100'000; ///< edges that all labels name together
constexpr int max_layer = 100;

class Reader {
public:
    Reader(const JsonView& root, const fs::path& folder, Pattern& pattern)
        : root_(root), folder_(folder), pattern_(pattern) {}

    void read() {
        root_.expect_keys({"toile", "units_in_meter", "fabric", "panels", "pins", "elastics", "seams"});
        root_.at("toile").integer(1, 1);
        if (root_.has("units_in_meter")) edges_.metres = read_unit(root_);
        if (root_.has("fabric")) pattern_.fabric = read_fabric(root_.at("fabric"));
        if (root_.has("panels")) read_panels(root_.at("panels"));
        each("pins", [&](const JsonView& v) { read_pins(v); });
        each("elastics", [&](const JsonView& v) { read_elastics(v); });
        each("seams", [&](const JsonView& v) { pattern_.seams.push_back(read_seam(v)); });
    }

private:
    /// Calls read(member) for every member of an array that may be missing.
    template <class Read> void each(const JsonView& of, const char* key, Read&& read) {
        if (!of.has(key)) return;
        const JsonView list = of.at(key);
        list.expect_array(0, max_items);
        for (std::size_t i = 0; i < list.value().size(); ++i)
            read(list.at(i, "item"));
    }
    template <class Read> void each(const char* key, Read&& read) { each(root_, key, read); }

    /// A file lies where the companion does, and is read to see that it can be.
    std::string read_fabric(const JsonView& v) const {
        const std::string name = v.string();
        if (is_fabric_file(name)) {
            const std::string path = (folder_ / name).string();
            fabric_called(path);
            return path;
        }
        std::string list;
        for (const Fabric& f : fabric_presets()) {
            if (f.name == name) return name;
            list += (list.empty() ? "" : ", ") + f.name;
        }
        v.fail("one of " + list + ", or a file of a fabric (.json)");
    }

    int panel_called(const JsonView& v, const std::string& name) const {
        const auto& panels = pattern_.panels;
        const auto at =
            std::find_if(panels.begin(), panels.end(), [&](const Panel& p) { return p.name == name; });
        if (at == panels.end()) v.fail("the name of a panel of the pattern");
        return int(at - panels.begin());
    }

    void read_panels(const JsonView& panels) {
        panels.expect_object();
        for (const auto& [name, value] : panels.value().items()) {
            const auto& all = pattern_.panels;
            const auto at =
                std::find_if(all.begin(), all.end(), [&n = name](const Panel& p) { return p.name == n; });
            const JsonView panel = panels.below(value, "panel " + in_quotes(name));
            if (value.is_object() && value.contains("rest_mesh")) {
                if (at != all.end())
                    throw InputError(panel.place() + " has an outline in the pattern and a \"rest_mesh\" here; one of them was expected");
                read_moulded_panel(panel, name);
                continue;
            }
            if (at == all.end())
                throw InputError(panels.place() + " names " + in_quotes(name) +
                                 ", which is no panel of the pattern");
            read_panel(panel, pattern_.panels[at - all.begin()]);
        }
    }

    /// A panel that the pattern does not know, since it has no outline.
    void read_moulded_panel(const JsonView& v, const std::string& name) {
        v.expect_keys({"rest_mesh", "edges", "warp", "translation", "rotation", "fabric", "layer"});
        Panel panel;
        panel.name = name;
        const std::string file = v.at("rest_mesh").string();
        RestMeshOptions options;
        if (v.has("warp")) options.warp = read_vector(v.at("warp"), 1);
        each(v, "edges", [&](const JsonView& edge) {
            edge.expect_keys({"from", "to", "label"});
            options.edges.push_back({edge.at("from").integer(1, INT_MAX), edge.at("to").integer(1, INT_MAX)});
            panel.outline.emplace_back();
            if (edge.has("label")) panel.outline.back().label = edge.at("label").string();
        });
        panel.rest = read_rest_mesh((folder_ / file).string(), options);
        double at = 0; // edges without a shape, one after the other
        for (int e = 0; e < int(panel.outline.size()); ++e) {
            panel.outline[e].start = {at, 0};
            at += length_along(*panel.rest, e);
            panel.outline[e].end = {at, 0};
        }
        if (v.has("translation")) panel.placement.translation = read_vector(v.at("translation"), edges_.metres);
        if (v.has("rotation")) panel.placement.rotation = read_rotation(v.at("rotation"));
        if (v.has("fabric")) panel.fabric = read_fabric(v.at("fabric"));
        if (v.has("layer")) panel.layer = v.at("layer").integer(-max_layer, max_layer);
        pattern_.panels.push_back(std::move(panel));
    }

    void read_panel(const JsonView& v, Panel& panel) {
        v.expect_keys({"fabric", "grain", "shrink", "layer", "holes", "lines"});
        if (v.has("fabric")) panel.fabric = read_fabric(v.at("fabric"));
        if (v.has("grain")) panel.grain = v.at("grain").number(-360, 360) * EIGEN_PI / 180;
        if (v.has("shrink")) panel.shrink = read_shrink(v.at("shrink"));
        if (v.has("layer")) panel.layer = v.at("layer").integer(-max_layer, max_layer);
        each(v, "holes", [&](const JsonView& hole) {
            hole.expect_keys({"vertices", "edges"});
            panel.holes.push_back(read_chain(hole, true));
        });
        each(v, "lines", [&](const JsonView& line) { panel.lines.push_back(read_line(line)); });
    }

    Vec2 read_shrink(const JsonView& v) {
        v.expect_object();
        v.expect_keys({"warp", "weft"});
        const auto share = [&](const char* along) { return v.has(along) ? v.at(along).number(-most_shrink, most_shrink) : 0; };
        return {share("weft"), share("warp")};
    }

    /// The edges given, or straight ones from vertex to vertex.
    Loop read_chain(const JsonView& v, bool closed) {
        const std::vector<Vec2> vertices = read_vertices(v.at("vertices"), edges_.metres);
        Loop loop;
        if (v.has("edges")) {
            const JsonView list = v.at("edges");
            list.expect_array(1, max_items);
            for (std::size_t i = 0; i < list.value().size(); ++i)
                loop.push_back(read_edge(list.at(i, "edge"), vertices, edges_));
            return loop;
        }
        for (std::size_t i = 0; i + (closed ? 0 : 1) < vertices.size(); ++i)
            loop.push_back({vertices[i], vertices[(i + 1) % vertices.size()], Straight{}, {}});
        return loop;
    }

    InnerLine read_line(const JsonView& v) {
        v.expect_keys({"vertices", "edges", "closed", "kind", "angle"});
        InnerLine line;
        line.edges = read_chain(v, v.has("closed") && v.at("closed").boolean());
        const JsonView kind = v.at("kind");
        const std::string word = kind.string();
        if (word == "fold")
            line.kind = InnerLineKind::fold;
        else if (word == "pleat")
            line.kind = InnerLineKind::pleat;
        else if (word == "cut")
            line.kind = InnerLineKind::cut;
        else
            kind.fail("\"fold\", \"pleat\" or \"cut\"");
        if (v.has("angle")) line.rest_angle = v.at("angle").number(-180, 180) * EIGEN_PI / 180;
        return line;
    }

    /// The spans that v names: one edge of one panel, or every edge of a label.
    std::vector<EdgeSpan> read_spans(const JsonView& v) {
        EdgeSpan part;
        part.t0 = v.has("from") ? v.at("from").number(0, 1) : 0;
        part.t1 = v.has("to") ? v.at("to").number(0, 1) : 1;
        if (part.t0 == part.t1) throw InputError(v.place() + " has no length: \"from\" and \"to\" are equal");
        const int only = v.has("panel") ? panel_called(v.at("panel"), v.at("panel").string()) : -1;
        if (v.has("label")) return labelled(v.at("label"), only, part);
        if (only < 0) throw InputError(v.place() + " lacks the key \"panel\" or \"label\"");
        part.panel = only;
        part.edge = v.at("edge").integer(0, int(pattern_.panels[only].outline.size()) - 1);
        return {part};
    }

    std::vector<EdgeSpan> labelled(const JsonView& label, int only, EdgeSpan part) {
        std::vector<EdgeSpan> spans;
        const std::string word = label.string();
        for (part.panel = 0; part.panel < int(pattern_.panels.size()); ++part.panel) {
            const Loop& outline = pattern_.panels[part.panel].outline;
            for (part.edge = 0; part.edge < int(outline.size()); ++part.edge)
                if (outline[part.edge].label == word && (only < 0 || only == part.panel))
                    spans.push_back(part);
        }
        if (spans.empty()) label.fail("the label of an edge");
        named_ += spans.size();
        if (named_ > max_named)
            label.fail("used less often: all labels together name more than 100000 edges");
        return spans;
    }

    void read_pins(const JsonView& v) {
        v.expect_keys({"panel", "edge", "label", "from", "to"});
        for (const EdgeSpan& span : read_spans(v))
            pattern_.pins.push_back({span});
    }

    void read_elastics(const JsonView& v) {
        v.expect_keys({"panel", "edge", "label", "from", "to", "ratio", "stiffness"});
        Elastic elastic;
        elastic.item = items_++;
        elastic.ratio = v.at("ratio").number(least_ratio, 1);
        if (v.has("stiffness")) elastic.stiffness = v.at("stiffness").number(1e-3, 1e6);
        for (const EdgeSpan& span : read_spans(v)) {
            elastic.span = span;
            pattern_.elastics.push_back(elastic);
        }
    }

    EdgeSpan read_seam_span(const JsonView& v) {
        v.expect_keys({"panel", "edge", "from", "to"});
        return read_spans(v).front();
    }

    SeamSide read_side(const JsonView& v) {
        if (!v.value().is_array()) return {read_seam_span(v)};
        v.expect_array(1, max_items);
        SeamSide side;
        for (std::size_t i = 0; i < v.value().size(); ++i)
            side.push_back(read_seam_span(v.at(i, "span")));
        return side;
    }

    Seam read_seam(const JsonView& v) {
        v.expect_keys({"a", "b", "faces"});
        Seam seam;
        seam.a = read_side(v.at("a"));
        seam.b = read_side(v.at("b"));
        if (v.has("faces")) {
            const JsonView faces = v.at("faces");
            const std::string word = faces.string();
            if (word == "right_to_wrong")
                seam.faces = SeamFaces::right_to_wrong;
            else if (word != "right_to_right")
                faces.fail("\"right_to_right\" or \"right_to_wrong\"");
        }
        seam.name = "seam " + std::to_string(pattern_.seams.size()) + " (" + called(seam.a) + " to " +
                    called(seam.b) + ")";
        return seam;
    }

    std::string called(const SeamSide& side) const {
        std::ostringstream out;
        for (std::size_t i = 0; i < side.size(); ++i) {
            const EdgeSpan& s = side[i];
            out << (i ? " + " : "") << pattern_.panels[s.panel].name << '.' << s.edge;
            if (std::min(s.t0, s.t1) > 0 || std::max(s.t0, s.t1) < 1)
                out << '[' << s.t0 << ".." << s.t1 << ']';
        }
        return out.str();
    }

    const JsonView& root_;
    const fs::path folder_;
    Pattern& pattern_;
    EdgeConventions edges_;
    std::size_t named_ = 0;
    int items_ = 0; ///< elastics read
};

void read_text_into(const std::string& text, const std::string& name, const fs::path& folder, Pattern& pattern) {
    const Json json = parse_json(text, name);
    const JsonView root(json, name);
    Pattern with = pattern; // left as it was when the companion is refused
    Reader(root, folder, with).read();
    pattern = std::move(with);
}

constexpr std::uintmax_t max_bytes = JsonLimits{}.max_bytes;

} // namespace

std::string companion_path(const std::string& pattern_path) {
    return fs::path(pattern_path).replace_extension(".toile.json").string();
}

void read_companion(const std::string& path, Pattern& pattern) {
    read_text_into(read_file(path, max_bytes), path, fs::path(path).parent_path(), pattern);
}

void read_companion(std::istream& in, const std::string& name, Pattern& pattern) {
    read_text_into(read_text(in, name, max_bytes), name, {}, pattern);
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/write_altered.h"

#include "geometry/text.h"
#include "io/json.h"
#include "io/read_edge.h"
#include "io/write_file.h"
#include "patterns/curve.h"
#include "patterns/shrink.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace toile {

namespace {

constexpr double least_change = 1e-6; // m
constexpr int samples = 64;           // of an edge
constexpr double margin = 20;         // mm, round every panel of the picture
constexpr double line = 16, letter = 6; // mm, of its words

/// A control point relative to its chord, as files have it.
Vec2 relative(const Edge& e, const Vec2& at) {
    const Vec2 chord = e.end - e.start, off = at - e.start;
    return Vec2(off.dot(chord), chord.x() * off.y() - chord.y() * off.x()) / chord.squaredNorm();
}

/// How a panel of a file became one of a pattern: times `metres`, its x turned over where the reader did so, and shifted.
struct FileFrame {
    double metres = 1;
    bool turned_over = false;
    bool absolute_control = false;

    Vec2 in_file(const Vec2& step) const { return Vec2(turned_over ? -step.x() : step.x(), step.y()) / metres; }
};

bool turned_over(const Json& panel, const Loop& outline) {
    double file = 0, read = 0;
    for (std::size_t k = 0; k < outline.size(); ++k) {
        const auto vertex = [&](int end) {
            const Json& v = panel["vertices"][panel["edges"][k]["endpoints"][end].get<std::size_t>()];
            return Vec2(v[0].get<double>(), v[1].get<double>());
        };
        const Vec2 a = vertex(0) - vertex(1), b = outline[k].start - outline[k].end;
        file = a.x(), read = b.x();
        if (std::abs(read) > 0.1 * b.norm()) break; // an edge along y does not tell
    }
    return file * read < 0;
}

void write_controls(const FileFrame& frame, const Edge& before, const Edge& now, Json& edge) {
    if (!edge.contains("curvature")) return;
    Json& curve = edge["curvature"];
    std::vector<Vec2> old_points, points;
    if (const auto* q = std::get_if<Quadratic>(&now.curve)) {
        points = {q->control};
        old_points = {std::get<Quadratic>(before.curve).control};
    } else if (const auto* c = std::get_if<Cubic>(&now.curve)) {
        points = {c->control0, c->control1};
        const Cubic& old = std::get<Cubic>(before.curve);
        old_points = {old.control0, old.control1};
    } else if (const auto* a = std::get_if<Arc>(&now.curve)) {
        if (a->radius != std::get<Arc>(before.curve).radius) curve["params"][0] = a->radius / frame.metres;
        return;
    }
    for (std::size_t k = 0; k < points.size(); ++k) {
        Json& p = curve.is_array() ? curve : curve["params"][k];
        Vec2 step; // by differences, so that what stays keeps its digits
        if (frame.absolute_control) {
            step = frame.in_file(points[k] - old_points[k]);
        } else {
            step = relative(now, points[k]) - relative(before, old_points[k]);
            if (frame.turned_over) step.y() = -step.y();
            if (step.norm() < 1e-12) continue; // went along with its chord
        }
        for (int c = 0; c < 2; ++c)
            if (step[c] != 0) p[std::size_t(c)] = p[std::size_t(c)].get<double>() + step[c];
    }
}

std::string path_along(const std::vector<Vec2>& points, const Vec2& low, double high, const Vec2& place) {
    std::string path;
    for (const Vec2& p : points)
        path += text("%s%.3f,%.3f", path.empty() ? "M" : " L", place.x() + 1e3 * (p.x() - low.x()), place.y() + 1e3 * (high - p.y()));
    return path;
}

std::string path_of(const Loop& outline, const Vec2& low, double high, const Vec2& place) {
    std::vector<Vec2> points;
    for (const Edge& e : outline)
        for (const Vec2& p : sample(e, 0, 1, std::holds_alternative<Straight>(e.curve) ? 1 : samples)) points.push_back(p);
    return path_along(points, low, high, place);
}

bool rest_lengths_differ(const Pattern& drawn, const Pattern& altered) {
    for (std::size_t p = 0; p < drawn.panels.size(); ++p)
        if (drawn.panels[p].shrink != altered.panels[p].shrink) return true;
    for (std::size_t e = 0; e < drawn.elastics.size(); ++e)
        if (drawn.elastics[e].ratio != altered.elastics[e].ratio || drawn.elastics[e].item < 0) return true;
    return false;
}

Json elastic_json(const Pattern& pattern, const Elastic& e, Json item) {
    item.erase("label");
    item["panel"] = pattern.panels[e.span.panel].name;
    item["edge"] = e.span.edge;
    item["ratio"] = e.ratio;
    return item;
}

/// An item of a companion may be an elastic on every edge of a label; where those have not one ratio any more, it becomes one for
/// each.
void add_elastics(Json item, int number, const Pattern& drawn, const Pattern& altered, Json& list) {
    std::vector<int> own;
    for (int e = 0; e < int(drawn.elastics.size()); ++e)
        if (drawn.elastics[e].item == number) own.push_back(e);
    const auto ratio = [&](int e) { return altered.elastics[e].ratio; };
    const auto same = [&](int e) { return ratio(e) == drawn.elastics[e].ratio; };
    const auto one = [&](int e) { return ratio(e) == ratio(own[0]); };
    if (std::all_of(own.begin(), own.end(), same)) return list.push_back(item);
    if (std::all_of(own.begin(), own.end(), one)) {
        item["ratio"] = ratio(own[0]);
        return list.push_back(item);
    }
    for (const int e : own) list.push_back(elastic_json(drawn, altered.elastics[e], item));
}

/// What outlines do not show of a panel that has changed.
std::vector<std::string> remarks_on(const Pattern& drawn, const Pattern& altered, int panel) {
    std::vector<std::string> all;
    const Panel &before = drawn.panels[panel], &now = altered.panels[panel];
    if (now.shrink != before.shrink) {
        const std::string was = shrink_in_words(before), is = shrink_in_words(now);
        all.push_back("after it is cut " + (is.empty() ? "not shrunk" : is) + ", was " + (was.empty() ? "not" : was));
    }
    for (const ElasticChange& c : elastic_changes(drawn, altered))
        if (const Elastic& e = drawn.elastics[c.elastic]; e.span.panel == panel)
            all.push_back(text("elastic on edge %d: %.1f mm relaxed, was %.1f", e.span.edge, 1e3 * c.after, 1e3 * c.before));
    return all;
}

} // namespace

std::string altered_pattern_text(const std::string& path, const Pattern& drawn, const Pattern& altered) {
    Json root = parse_json(read_file(path, JsonLimits{}.max_bytes), path);
    const JsonView view(root, path);
    const JsonView properties = view.at("properties");
    FileFrame frame;
    frame.metres = read_unit(properties);
    frame.absolute_control = properties.has("curvature_coords") && properties.at("curvature_coords").string() == "absolute";
    for (std::size_t p = 0; p < drawn.panels.size(); ++p) {
        Json& panel = root["pattern"]["panels"][drawn.panels[p].name];
        const Loop &before = drawn.panels[p].outline, &now = altered.panels[p].outline;
        if (!panel.is_object() || panel["edges"].size() != before.size())
            throw InputError(path + " has changed while it was worked on");
        frame.turned_over = turned_over(panel, before);
        for (std::size_t k = 0; k < before.size(); ++k) {
            const Vec2 step = frame.in_file(now[k].start - before[k].start);
            Json& vertex = panel["vertices"][panel["edges"][k]["endpoints"][0].get<std::size_t>()];
            for (int c = 0; c < 2; ++c)
                if (step[c] != 0) vertex[std::size_t(c)] = vertex[std::size_t(c)].get<double>() + step[c];
            write_controls(frame, before[k], now[k], panel["edges"][k]);
        }
    }
    return root.dump(1) + '\n';
}

std::string altered_companion_text(const std::string& path, const Pattern& drawn, const Pattern& altered) {
    Json root{{"toile", 1}};
    if (std::filesystem::exists(path)) {
        const std::string text = read_file(path, JsonLimits{}.max_bytes);
        if (!rest_lengths_differ(drawn, altered)) return text;
        root = parse_json(text, path);
    }
    for (std::size_t p = 0; p < drawn.panels.size(); ++p)
        for (const auto& [key, k] : {std::pair("warp", 1), std::pair("weft", 0)})
            if (altered.panels[p].shrink[k] != drawn.panels[p].shrink[k])
                root["panels"][drawn.panels[p].name]["shrink"][key] = altered.panels[p].shrink[k];
    Json elastics = Json::array();
    if (root.contains("elastics"))
        for (std::size_t item = 0; item < root["elastics"].size(); ++item)
            add_elastics(root["elastics"][item], int(item), drawn, altered, elastics);
    for (const Elastic& e : altered.elastics)
        if (e.item < 0) elastics.push_back(elastic_json(drawn, e, {{"stiffness", e.stiffness}}));
    if (!elastics.empty()) root["elastics"] = elastics;
    return root.dump(1) + '\n';
}

std::string altered_svg(const Pattern& drawn, const Pattern& altered) {
    std::string body;
    Vec2 place(margin, 2 * margin);
    double height = 0;
    const std::vector<EdgeChange> changes = edge_changes(drawn, altered);
    for (std::size_t p = 0; p < drawn.panels.size(); ++p) {
        const auto own = [p](const EdgeChange& c) { return c.panel == int(p); };
        const std::vector<std::string> remarks = remarks_on(drawn, altered, int(p));
        if (remarks.empty() && std::none_of(changes.begin(), changes.end(), own)) continue;
        const Loop &before = drawn.panels[p].outline, &now = altered.panels[p].outline;
        Vec2 low = before[0].start, high = low;
        for (const Loop* loop : {&before, &now})
            for (const Edge& e : *loop)
                for (const Vec2& at : sample(e, 0, 1, samples)) {
                    low = low.cwiseMin(at);
                    high = high.cwiseMax(at);
                }
        body += "<path class=\"old\" d=\"" + path_of(before, low, high.y(), place) + " Z\"/>\n";
        body += "<path class=\"new\" d=\"" + path_of(now, low, high.y(), place) + " Z\"/>\n";
        for (const Elastic& e : altered.elastics)
            if (e.span.panel == int(p))
                body += "<path class=\"band\" d=\"" + path_along(sample(now[e.span.edge], e.span.t0, e.span.t1, samples), low, high.y(), place) +
                        "\"/>\n";
        std::string name; // of a file: only what may stand in text
        for (const char c : drawn.panels[p].name) name += c == '<' || c == '&' ? '_' : c;
        body += text("<text x=\"%.1f\" y=\"%.1f\">", place.x(), place.y() - 5) + name + "</text>\n";
        double below = 1e3 * (high.y() - low.y());
        for (const std::string& remark : remarks)
            body += text("<text x=\"%.1f\" y=\"%.1f\">", place.x(), place.y() + (below += line)) + remark + "</text>\n";
        double wide = 1e3 * (high.x() - low.x());
        for (const std::string& remark : remarks) wide = std::max(wide, letter * double(remark.size()));
        place.x() += wide + margin;
        height = std::max(height, below);
    }
    const double width = place.x(), whole = place.y() + height + margin;
    return text("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.1fmm\" height=\"%.1fmm\" viewBox=\"0 0 %.1f %.1f\">\n", width,
                whole, width, whole) +
           "<style>path{fill:none;stroke-width:1}.old{stroke:#888;stroke-dasharray:6 4}.new{stroke:#000}"
           ".band{stroke:#8020a0;stroke-width:4;stroke-dasharray:2 4}"
           "text{font:12px sans-serif}</style>\n" +
           body + "</svg>\n";
}

std::vector<EdgeChange> edge_changes(const Pattern& drawn, const Pattern& altered) {
    std::vector<EdgeChange> changes;
    for (std::size_t p = 0; p < drawn.panels.size(); ++p)
        for (std::size_t e = 0; e < drawn.panels[p].outline.size(); ++e) {
            const Edge &before = drawn.panels[p].outline[e], &now = altered.panels[p].outline[e];
            EdgeChange c{int(p), int(e), length(before), length(now), 0};
            const std::vector<Vec2> from = sample(before, 0, 1, samples), to = sample(now, 0, 1, samples);
            for (std::size_t k = 0; k < from.size(); ++k) c.moved = std::max(c.moved, (to[k] - from[k]).norm());
            if (c.moved > least_change) changes.push_back(c);
        }
    return changes;
}

std::vector<ElasticChange> elastic_changes(const Pattern& drawn, const Pattern& altered) {
    std::vector<ElasticChange> changes;
    for (std::size_t k = 0; k < drawn.elastics.size(); ++k) {
        const auto relaxed = [k](const Pattern& p) { return p.elastics[k].ratio * length_at_rest(p, p.elastics[k].span); };
        const ElasticChange c{int(k), relaxed(drawn), relaxed(altered)};
        if (std::abs(c.after - c.before) > least_change) changes.push_back(c);
    }
    return changes;
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/stability_svg.h"

#include "geometry/text.h"
#include "io/svg_drawing.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace toile {

namespace {

constexpr double width = 760, height = 440, left = 70, right = 210, top = 58, bottom = 52; // px

/// Orange where none works, blue where all do, pale between: apart for those who see fewer colours.
std::string shade(double share) {
    const double from[3] = {213, 94, 0}, middle[3] = {247, 243, 235}, to[3] = {0, 114, 178};
    const double* a = share < 0.5 ? from : middle;
    const double* b = share < 0.5 ? middle : to;
    const double t = share < 0.5 ? 2 * share : 2 * share - 1;
    int c[3];
    for (int k = 0; k < 3; ++k) c[k] = int(std::lround(a[k] + t * (b[k] - a[k])));
    return text("#%02x%02x%02x", c[0], c[1], c[2]);
}

const char* dashes(MeshKind kind) {
    switch (kind) {
    case MeshKind::aligned: return "";
    case MeshKind::alternating: return "stroke-dasharray=\"7 4\"";
    case MeshKind::unstructured: return "stroke-dasharray=\"2 3\"";
    }
    return "";
}

/// Cells of an axis, each round its value.
class Axis {
public:
    Axis(const std::vector<double>& values, double low, double high) : low_(low), high_(high) {
        for (std::size_t k = 0; k + 1 < values.size(); ++k) borders_.push_back(std::sqrt(values[k] * values[k + 1]));
        const double first = values.size() > 1 ? values[0] / std::sqrt(values[1] / values[0]) : values[0] / 2;
        const double last = values.size() > 1 ? values.back() * std::sqrt(values.back() / values[values.size() - 2]) : values[0] * 2;
        borders_.insert(borders_.begin(), first);
        borders_.push_back(last);
    }
    double at(double value) const {
        return low_ + (high_ - low_) * std::log(value / borders_.front()) / std::log(borders_.back() / borders_.front());
    }
    double border(std::size_t k) const { return at(borders_[k]); }
    bool holds(double value) const { return value >= borders_.front() && value <= borders_.back(); }
    double lowest() const { return borders_.front(); }
    double highest() const { return borders_.back(); }
    std::vector<double> decades() const {
        std::vector<double> all;
        for (int k = int(std::ceil(std::log10(borders_.front()))); k <= std::log10(borders_.back()); ++k) all.push_back(std::pow(10, k));
        return all;
    }

private:
    double low_, high_;
    std::vector<double> borders_;
};

class Picture {
public:
    explicit Picture(const StabilityMap& map)
        : map_(map), x_(map.stiffness, left, width - right), y_(map.values, height - bottom, top) {}

    std::string draw() {
        cells();
        axes();
        boundaries();
        legend();
        return drawing_.document(map_title(map_), width, height);
    }

private:
    void cells() {
        const std::size_t meshes = map_.runs.size() / map_.stiffness.size() / map_.values.size();
        for (std::size_t i = 0; i < map_.stiffness.size(); ++i)
            for (std::size_t j = 0; j < map_.values.size(); ++j) {
                int work = 0;
                std::map<std::string, int> reasons;
                for (std::size_t m = 0; m < meshes; ++m) {
                    const std::string& failure = map_.runs[(i * meshes + m) * map_.values.size() + j].outcome.failure;
                    failure.empty() ? ++work : ++reasons[failure];
                }
                std::string said = text("stiffness %.3g, %s %.3g %s: %d of %d meshes work", map_.stiffness[i], map_.scene.axis.c_str(), map_.values[j],
                                        map_.scene.unit.c_str(), work, int(meshes));
                for (const auto& [why, count] : reasons) said += text("; %d ", count) + why;
                drawing_.titled(text("rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"%s\" stroke=\"#ffffff\" stroke-width=\"0.5\"",
                                     x_.border(i), y_.border(j + 1), x_.border(i + 1) - x_.border(i), y_.border(j) - y_.border(j + 1),
                                     shade(double(work) / double(meshes)).c_str()),
                                said);
            }
    }

    void axes() {
        drawing_.words(left, 20, "start", map_title(map_), "font-size=\"15\" font-weight=\"bold\"");
        drawing_.words(left, 38, "start", "theory: " + map_.scene.theory, "fill=\"#555555\"");
        for (const double value : x_.decades()) {
            drawing_.line(x_.at(value), height - bottom, x_.at(value), height - bottom + 4, "stroke=\"#333333\"");
            drawing_.words(x_.at(value), height - bottom + 18, "middle", text("1e%d", int(std::lround(std::log10(value)))));
        }
        for (const double value : y_.decades()) {
            drawing_.line(left - 4, y_.at(value), left, y_.at(value), "stroke=\"#333333\"");
            drawing_.words(left - 7, y_.at(value) + 4, "end", map_.scene.unit == "s" ? text("%g ms", 1e3 * value) : text("%g", value));
        }
        drawing_.words((left + width - right) / 2, height - 14, "middle", "stiffness k L^2 / D");
        drawing_.words_upward(14, (top + height - bottom) / 2, map_.scene.axis);
    }

    /// Of every mesh, where it is within the picture.
    void boundaries() {
        const std::size_t rows = map_.values.size(), meshes = map_.runs.size() / map_.stiffness.size() / rows;
        for (std::size_t m = 0; m < meshes; ++m)
            for (std::size_t i = 0; i + 1 < map_.stiffness.size(); ++i) {
                const StabilityRun &a = map_.runs[(i * meshes + m) * rows], &b = map_.runs[((i + 1) * meshes + m) * rows];
                const auto drawn = [](const StabilityRun& r) { return r.boundary > 0 && std::isfinite(r.boundary); };
                if (!drawn(a) || !drawn(b)) continue;
                const double slope = std::log(b.boundary / a.boundary) / std::log(b.stiffness / a.stiffness);
                double from = a.stiffness, to = b.stiffness; // cut where it leaves the picture
                for (const double edge : {y_.lowest(), y_.highest()}) {
                    if ((a.boundary < edge) == (b.boundary < edge)) continue;
                    const double cut = a.stiffness * std::pow(edge / a.boundary, 1 / slope);
                    (y_.holds(a.boundary) || (a.boundary < edge) == (edge == y_.highest()) ? to : from) = cut;
                }
                const double middle = std::sqrt(from * to);
                if (!y_.holds(a.boundary * std::pow(middle / a.stiffness, slope))) continue;
                drawing_.line(x_.at(from), y_.at(a.boundary * std::pow(from / a.stiffness, slope)), x_.at(to),
                              y_.at(a.boundary * std::pow(to / a.stiffness, slope)), text("stroke=\"#000000\" stroke-width=\"1.3\" %s", dashes(a.mesh.kind)).c_str());
            }
    }

    void legend() {
        double down = top + 12;
        const double at = width - right + 20;
        for (const double share : {1.0, 0.75, 0.5, 0.25, 0.0}) {
            drawing_.body += text("<rect x=\"%.1f\" y=\"%.1f\" width=\"22\" height=\"14\" fill=\"%s\"/>\n", at, down - 11, shade(share).c_str());
            drawing_.words(at + 30, down, "start", share == 1 ? "all meshes work" : share == 0 ? "none works" : text("%g %%", 100 * share));
            down += 18;
        }
        down += 10;
        drawing_.words(at, down, "start", map_.scene.theory.empty() ? "no theory" : "boundary by theory, each mesh");
        down += 18;
        for (const MeshKind kind : {MeshKind::aligned, MeshKind::alternating, MeshKind::unstructured}) {
            drawing_.line(at, down - 4, at + 26, down - 4, text("stroke=\"#000000\" stroke-width=\"2\" %s", dashes(kind)).c_str());
            drawing_.words(at + 34, down, "start", to_string(kind));
            down += 18;
        }
    }

    const StabilityMap& map_;
    Axis x_, y_;
    SvgDrawing drawing_;
};

} // namespace

std::string map_title(const StabilityMap& map) { return std::string(to_string(map.scene.method)) + ": " + map.scene.name; }

std::string stability_svg(const StabilityMap& map) { return Picture(map).draw(); }

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/chart_svg.h"

#include "geometry/text.h"
#include "io/svg_drawing.h"

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

constexpr double width = 860, height = 480, left = 70, right = 210, top = 44, bottom = 52; // px
constexpr double least_error = 1e-6, most_error = 1; // what lies beyond is drawn at the border
constexpr double value_step = 0.1; // between lines of a scene with a band
constexpr double least_seconds = 1e-4;

/// Shades that stay apart for those who see fewer colours, by method.
const char* colour(Method method) {
    switch (method) {
    case Method::equilibrium: return "#000000";
    case Method::springs_explicit: return "#e69f00";
    case Method::springs_implicit: return "#56b4e9";
    case Method::springs_biphasic: return "#7f7f7f";
    case Method::springs_limited: return "#b8860b";
    case Method::triangles: return "#009e73";
    case Method::projective: return "#0072b2";
    case Method::xpbd: return "#d55e00";
    case Method::inextensible: return "#cc79a7";
    case Method::nonconforming: return "#7b3fa0";
    }
    return "#000000";
}

struct Decades {
    int low, high; ///< powers of ten
};

class Picture {
public:
    Picture(const Chart& chart, const ChartScene& scene) : scene_(scene) {
        double first = INFINITY, last = least_seconds, nearest = most_error;
        for (const ChartPoint& p : chart.points)
            if (p.scene == scene.scene.name) {
                points_.push_back(&p);
                first = std::min(first, std::max(p.seconds_cpu, least_seconds));
                last = std::max(last, p.seconds_cpu);
                nearest = std::min(nearest, std::max(p.error, least_error));
            }
        first = std::min(first, last);
        if (scene.scene.band) {
            values_ = *scene.scene.band;
            for (const ChartPoint* p : points_)
                if (p->failure.empty()) values_ = {std::min(values_.low, p->value), std::max(values_.high, p->value)};
            values_ = {std::floor(values_.low / value_step) * value_step, std::ceil(values_.high / value_step) * value_step};
        }
        time_ = {int(std::floor(std::log10(first))), int(std::floor(std::log10(last))) + 1};
        error_ = {std::min(-3, int(std::floor(std::log10(nearest)))), 0};
    }

    std::string draw() {
        axes();
        front();
        curves();
        marks();
        legend();
        return drawing_.document(scene_.scene.name, width, height);
    }

private:
    double x(double seconds) const {
        const double t = std::log10(std::max(seconds, least_seconds));
        return left + (width - left - right) * std::clamp((t - time_.low) / (time_.high - time_.low), 0.0, 1.0);
    }
    double y(double error) const {
        const double e = std::log10(std::clamp(std::isfinite(error) ? error : most_error, least_error, most_error));
        return height - bottom - (height - top - bottom) * std::clamp((e - error_.low) / double(error_.high - error_.low), 0.0, 1.0);
    }
    /// Of a scene with a band: linear in what is measured.
    double y_of_value(double value) const {
        const double v = std::clamp(std::isfinite(value) ? value : values_.high, values_.low, values_.high);
        return height - bottom - (height - top - bottom) * (v - values_.low) / (values_.high - values_.low);
    }
    double y(const ChartPoint& p) const { return scene_.scene.band ? y_of_value(p.value) : y(p.error); }
    void line(double x0, double y0, double x1, double y1, const char* style) { drawing_.line(x0, y0, x1, y1, style); }
    void words(double x, double y, const char* anchor, const std::string& what, const char* more = "") {
        drawing_.words(x, y, anchor, what, more);
    }

    void axes() {
        words(left, 20, "start", scene_.scene.name, "font-size=\"15\" font-weight=\"bold\"");
        const std::string& quantity = scene_.scene.quantity;
        const std::optional<Band>& b = scene_.scene.band;
        const std::string answer = b ? text("%.3g to %.3g", b->low, b->high) : text("%.6g", scene_.answer);
        words(left, 36, "start", quantity + ": " + answer + " by " + scene_.answer_from, "fill=\"#555555\"");
        for (int k = time_.low; k <= time_.high; ++k) {
            const double at = x(std::pow(10, k));
            line(at, top, at, height - bottom, "stroke=\"#e4e4e4\"");
            words(at, height - bottom + 16, "middle", text("%g s", std::pow(10, k)));
        }
        if (b)
            band();
        else
            errors();
        line(left, height - bottom, width - right, height - bottom, "stroke=\"#333333\"");
        line(left, top, left, height - bottom, "stroke=\"#333333\"");
        words((left + width - right) / 2, height - 14, "middle", "processor time on one thread");
        drawing_.words_upward(16, (top + height - bottom) / 2, b ? quantity : "error");
    }

    void errors() {
        for (int k = error_.low; k <= error_.high; ++k) {
            const double at = y(std::pow(10, k));
            line(left, at, width - right, at, "stroke=\"#e4e4e4\"");
            words(left - 6, at + 4, "end", text("%g %%", std::pow(10, k + 2)));
        }
        for (const double share : marked_errors) {
            line(left, y(share), width - right, y(share), "stroke=\"#c03030\" stroke-dasharray=\"5 4\"");
            words(width - right - 4, y(share) - 4, "end", text("%g %%", 100 * share), "fill=\"#c03030\"");
        }
    }

    void band() {
        const Band& b = *scene_.scene.band;
        drawing_.body += text("<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"#c03030\" fill-opacity=\"0.12\"/>\n", left, y_of_value(b.high),
                              width - left - right, y_of_value(b.low) - y_of_value(b.high));
        words(width - right - 4, y_of_value(b.high) + 14, "end", "measured", "fill=\"#c03030\"");
        for (double v = values_.low; v < values_.high + value_step / 2; v += value_step) {
            line(left, y_of_value(v), width - right, y_of_value(v), "stroke=\"#e4e4e4\"");
            words(left - 6, y_of_value(v) + 4, "end", text("%.1f", v));
        }
    }

    void front() {
        std::vector<const ChartPoint*> best;
        for (const ChartPoint* p : points_)
            if (p->front) best.push_back(p);
        std::sort(best.begin(), best.end(), [](const ChartPoint* a, const ChartPoint* b) { return a->seconds_cpu < b->seconds_cpu; });
        std::string path;
        for (const ChartPoint* p : best) path += text("%s%.1f %.1f", path.empty() ? "M" : " L", x(p->seconds_cpu), y(*p));
        if (best.size() > 1)
            drawing_.body += "<path d=\"" + path + "\" fill=\"none\" stroke=\"#bbbbbb\" stroke-width=\"9\" stroke-linejoin=\"round\" stroke-opacity=\"0.6\"/>\n";
    }

    void curves() {
        for (std::size_t i = 1; i < points_.size(); ++i) {
            const ChartPoint &a = *points_[i - 1], &b = *points_[i];
            if (a.method != b.method || a.step != b.step || !a.failure.empty() || !b.failure.empty()) continue;
            line(x(a.seconds_cpu), y(a), x(b.seconds_cpu), y(b),
                 text("stroke=\"%s\" stroke-width=\"1.6\"", colour(a.method)).c_str());
        }
    }

    void marks() {
        for (const ChartPoint* p : points_) {
            const double at = x(p->seconds_cpu), up = y(*p);
            const std::string what = std::string(to_string(p->method)) + text(", edges of %.3g mm", 1e3 * p->edge_length) +
                                     (p->step > 0 ? text(", steps of %.3g ms", 1e3 * p->step) : "") +
                                     (scene_.scene.band ? text(": %.3g", p->value) : text(": %.3g %%", 100 * p->error)) +
                                     text(" in %.3g s", p->seconds_cpu) +
                                     (p->error_solver ? text(", %.2g %% by the solver", 100 * *p->error_solver) : "") +
                                     (p->failure.empty() ? "" : "; " + p->failure);
            if (p->failure.empty())
                drawing_.titled(text("circle cx=\"%.1f\" cy=\"%.1f\" r=\"4\" fill=\"%s\"", at, up, colour(p->method)), what);
            else
                drawing_.titled(text("path d=\"M%.1f %.1f l8 8 m0 -8 l-8 8\" stroke=\"%s\" stroke-width=\"2\" fill=\"none\"", at - 4, up - 4,
                                     colour(p->method)),
                                what);
        }
    }

    void legend() {
        double down = top + 6;
        const double at = width - right + 18;
        for (const Method m : all_methods()) {
            if (std::none_of(points_.begin(), points_.end(), [m](const ChartPoint* p) { return p->method == m; })) continue;
            drawing_.body += text("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"4\" fill=\"%s\"/>\n", at, down - 4, colour(m));
            words(at + 12, down, "start", to_string(m));
            down += 18;
        }
        down += 6;
        drawing_.body += text("<path d=\"M%.1f %.1f l8 8 m0 -8 l-8 8\" stroke=\"#333333\" stroke-width=\"2\"/>\n", at - 4, down - 8);
        words(at + 12, down, "start", "not at rest");
        down += 18;
        line(at - 6, down - 4, at + 6, down - 4, "stroke=\"#bbbbbb\" stroke-width=\"9\"");
        words(at + 12, down, "start", "Pareto front");
    }

    const ChartScene& scene_;
    std::vector<const ChartPoint*> points_;
    Decades time_{}, error_{};
    Band values_; ///< on the vertical axis of a scene with a band
    SvgDrawing drawing_;
};

} // namespace

std::string chart_svg(const Chart& chart, const ChartScene& scene) { return Picture(chart, scene).draw(); }

} // namespace toile

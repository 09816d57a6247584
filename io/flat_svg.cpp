// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/flat_svg.h"

#include "geometry/text.h"
#include "io/markup.h"
#include "io/write_file.h"
#include "patterns/curve.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace toile {
namespace {

constexpr double mm = 1000; ///< per metre

std::string number(double x) {
    std::string s = text("%.2f", x);
    s.erase(s.find_last_not_of('0') + 1);
    if (s.back() == '.') s.pop_back();
    return s == "-0" ? "0" : s;
}

/// Hues that stay apart however many there are.
std::string seam_colour(std::size_t seam) {
    const double hue = std::fmod(0.61803398875 * double(seam), 1.0) * 6,
                 x = 1 - std::abs(std::fmod(hue, 2.0) - 1);
    const double channels[6][3] = {{1, x, 0}, {x, 1, 0}, {0, 1, x}, {0, x, 1}, {x, 0, 1}, {1, 0, x}};
    const double* c = channels[std::min(5, int(hue))];
    return text("#%02x%02x%02x", int(30 + 170 * c[0]), int(30 + 140 * c[1]), int(30 + 190 * c[2]));
}

struct Frame {
    Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity());
    Vec2 high = -low;
    void add(const Vec2& p) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    Vec2 size() const { return high - low; }
};

std::vector<Vec2> polyline(const Loop& loop) {
    std::vector<Vec2> points;
    for (const Edge& e : loop) {
        const std::vector<Vec2> part = sample(e, 0, 1, std::min(64, intervals_for_sag(e, 1e-3)));
        points.insert(points.end(), part.begin(), part.end());
    }
    return points;
}

double distance_to(const std::vector<Vec2>& points, const Vec2& p) {
    double nearest = INFINITY;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const Vec2 d = points[i + 1] - points[i];
        const double dd = d.squaredNorm(), t = dd > 0 ? std::clamp((p - points[i]).dot(d) / dd, 0.0, 1.0) : 0;
        nearest = std::min(nearest, (p - points[i] - t * d).squaredNorm());
    }
    return std::sqrt(nearest);
}

bool inside(const std::vector<Vec2>& points, const Vec2& p) {
    bool in = false;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec2 &a = points[i], &b = points[(i + 1) % points.size()];
        if ((a.y() > p.y()) != (b.y() > p.y()) &&
            p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()))
            in = !in;
    }
    return in;
}

/// A panel on the sheet.
struct Piece {
    const Panel* panel;
    std::vector<Vec2> outline;    ///< metres, panel coordinates
    Frame frame;                  ///< of the outline
    Vec2 place = Vec2::Zero();    ///< of its upper left corner on the sheet, mm
    Vec2 middle = Vec2::Zero();   ///< a point far from the border, where the name goes
    double room = 0;              ///< its distance from the border, metres
    double width = 0, height = 0; ///< free on both of its sides, metres

    Vec2 on_sheet(const Vec2& p) const {
        return place + mm * Vec2(p.x() - frame.low.x(), frame.high.y() - p.y());
    }
};

/// Twice the distance from p to the outline along an axis (0: x, 1: y), to the nearer side.
double free_length(const std::vector<Vec2>& outline, const Vec2& p, int axis) {
    const int other = 1 - axis;
    double nearest = INFINITY;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const Vec2 &a = outline[i], &b = outline[(i + 1) % outline.size()];
        if ((a[other] > p[other]) == (b[other] > p[other])) continue;
        const double at = a[axis] + (b[axis] - a[axis]) * (p[other] - a[other]) / (b[other] - a[other]);
        nearest = std::min(nearest, std::abs(at - p[axis]));
    }
    return std::isfinite(nearest) ? 2 * nearest : 0;
}

Piece piece_of(const Panel& panel) {
    Piece piece{&panel, polyline(panel.outline), {}};
    for (const Vec2& p : piece.outline)
        piece.frame.add(p);
    std::vector<std::vector<Vec2>> holes;
    for (const Loop& hole : panel.holes)
        holes.push_back(polyline(hole));
    constexpr int n = 24;
    const Vec2 centre = 0.5 * (piece.frame.low + piece.frame.high);
    double best = 0;
    piece.middle = centre;
    for (int i = 1; i < n; ++i)
        for (int k = 1; k < n; ++k) {
            const Vec2 p =
                piece.frame.low + piece.frame.size().cwiseProduct(Vec2(double(i) / n, double(k) / n));
            if (!inside(piece.outline, p)) continue;
            double room = distance_to(piece.outline, p);
            for (const auto& hole : holes)
                room = inside(hole, p) ? 0 : std::min(room, distance_to(hole, p));
            const double score = room * (1.5 - (p - centre).norm() / piece.frame.size().norm());
            if (score <= best) continue;
            best = score;
            piece.room = room;
            piece.middle = p;
        }
    piece.width = free_length(piece.outline, piece.middle, 0);
    piece.height = free_length(piece.outline, piece.middle, 1);
    return piece;
}

class Sheet {
public:
    explicit Sheet(const Pattern& pattern) : pattern_(pattern) {
        for (const Panel& panel : pattern.panels)
            pieces_.push_back(piece_of(panel));
        lay_out();
    }

    std::string draw() {
        for (const Piece& piece : pieces_)
            draw_panel(piece);
        for (std::size_t s = 0; s < pattern_.seams.size(); ++s)
            draw_seam(s);
        for (const Elastic& e : pattern_.elastics)
            draw_elastic(e);
        for (const Pin& p : pattern_.pins)
            draw_pin(p);
        for (const Piece& piece : pieces_)
            draw_words(piece);
        for (std::size_t s = 0; s < pattern_.seams.size(); ++s)
            draw_seam_numbers(s);
        draw_title_and_bar();
        return head() + body_ + "</svg>\n";
    }

private:
    /// Rows of panels, tall ones first, about 1.6 times as wide as high.
    void lay_out() {
        double area = 0, widest = 0;
        for (const Piece& p : pieces_) {
            const Vec2 size = mm * p.frame.size();
            area += size.x() * size.y();
            widest = std::max(widest, size.x());
        }
        text_ = std::clamp(std::sqrt(1.6 * area) / 75, 2.5, 30.0);
        const double gap = 2.5 * text_;
        const double row = std::max(widest, std::sqrt(1.6 * 1.35 * area));
        std::vector<Piece*> order;
        for (Piece& p : pieces_)
            order.push_back(&p);
        std::stable_sort(order.begin(), order.end(), [](const Piece* a, const Piece* b) {
            return a->frame.size().y() > b->frame.size().y();
        });
        Vec2 at(gap, gap + 2 * text_);
        double height = 0;
        for (Piece* piece : order) {
            Piece& p = *piece;
            const Vec2 size = mm * p.frame.size();
            if (at.x() > gap && at.x() + size.x() > gap + row) {
                at = {gap, at.y() + height + 2 * gap};
                height = 0;
            }
            p.place = at;
            at.x() += size.x() + gap;
            height = std::max(height, size.y());
            size_ = size_.cwiseMax(p.place + size);
        }
        size_ += Vec2(gap, 2 * gap + 2 * text_);
        size_.x() = std::max(size_.x(), 100 + 2 * gap);
    }

    std::string head() const {
        return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
               "width=\"" +
               number(size_.x()) + "mm\" height=\"" + number(size_.y()) + "mm\" viewBox=\"0 0 " +
               number(size_.x()) + " " + number(size_.y()) +
               "\" font-family=\"sans-serif\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n" +
               "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
    }

    static std::string pair(const Vec2& p) { return number(p.x()) + " " + number(p.y()); }

    struct Segment {
        const Piece& piece;
        const Edge& edge;
        std::string to(const Vec2& p) const { return pair(piece.on_sheet(p)); }
        std::string operator()(const Straight&) const { return " L" + to(edge.end); }
        std::string operator()(const Quadratic& q) const { return " Q" + to(q.control) + " " + to(edge.end); }
        std::string operator()(const Cubic& k) const {
            return " C" + to(k.control0) + " " + to(k.control1) + " " + to(edge.end);
        }
        std::string operator()(const Arc& a) const {
            // With y down on the sheet, what turns counter-clockwise in the panel has sweep 0.
            const std::string r = number(mm * turn_of(edge, a).radius);
            return " A" + r + " " + r + " 0 " + (a.large ? "1 " : "0 ") + (a.right ? "0 " : "1 ") +
                   to(edge.end);
        }
    };

    static std::string path(const Piece& piece, const Loop& loop) {
        std::string d;
        for (std::size_t i = 0; i < loop.size(); ++i) {
            if (i == 0 || loop[i].start != loop[i - 1].end)
                d += (i ? " M" : "M") + pair(piece.on_sheet(loop[i].start));
            d += std::visit(Segment{piece, loop[i]}, loop[i].curve);
        }
        if (!loop.empty() && loop.front().start == loop.back().end) d += " Z";
        return d;
    }

    /// A part of an edge: the curve itself when it is the whole.
    std::string path(const EdgeSpan& s) const {
        const Piece& piece = pieces_[s.panel];
        const Edge& edge = piece.panel->outline[s.edge];
        if (std::min(s.t0, s.t1) == 0 && std::max(s.t0, s.t1) == 1) return path(piece, {edge});
        std::string d;
        for (const Vec2& p : sample(edge, s.t0, s.t1, std::min(64, intervals_for_sag(edge, 1e-3))))
            d += (d.empty() ? "M" : " L") + pair(piece.on_sheet(p));
        return d;
    }

    void stroke(const std::string& d, const std::string& colour, double width, const std::string& more = "") {
        body_ += "<path d=\"" + d + "\" fill=\"none\" stroke=\"" + colour + "\" stroke-width=\"" +
                 number(width) + "\"" + more + "/>\n";
    }

    std::string dashes(std::initializer_list<double> lengths) const {
        std::string list;
        for (double l : lengths)
            list += (list.empty() ? "" : " ") + number(l * text_);
        return " stroke-dasharray=\"" + list + "\"";
    }

    void words(const Vec2& at, double size, const std::string& text, const std::string& more = "") {
        body_ += "<text x=\"" + number(at.x()) + "\" y=\"" + number(at.y()) + "\" font-size=\"" +
                 number(size) + "\" text-anchor=\"middle\"" + more + ">" + escaped(text) + "</text>\n";
    }

    void draw_panel(const Piece& piece) {
        const Panel& panel = *piece.panel;
        std::string d = path(piece, panel.outline);
        for (const Loop& hole : panel.holes)
            d += " " + path(piece, hole);
        body_ += "<path class=\"panel\" d=\"" + d +
                 "\" fill=\"#f4efe4\" fill-rule=\"evenodd\" stroke=\"#303030\" stroke-width=\"" +
                 number(0.08 * text_) + "\"/>\n";
        for (const InnerLine& line : panel.lines)
            draw_line(piece, line);
    }

    void draw_line(const Piece& piece, const InnerLine& line) {
        const std::string d = path(piece, line.edges);
        if (line.kind == InnerLineKind::cut)
            stroke(d, "#c02020", 0.12 * text_);
        else if (line.kind == InnerLineKind::fold)
            stroke(d, "#606060", 0.1 * text_, dashes({0.8, 0.3, 0.1, 0.3}));
        else
            stroke(d, "#606060", 0.1 * text_, dashes({0.6, 0.4}));
    }

    /// A dart is a seam of two edges of one panel that share the corner at which both sides start or end.
    bool is_dart(const Seam& seam) const {
        if (seam.a.size() != 1 || seam.b.size() != 1 || seam.a[0].panel != seam.b[0].panel) return false;
        const Loop& outline = pattern_.panels[seam.a[0].panel].outline;
        const auto end = [&](const EdgeSpan& s, double t) {
            return t == 0 ? outline[s.edge].start : t == 1 ? outline[s.edge].end : Vec2(Vec2::Constant(NAN));
        };
        return end(seam.a[0], seam.a[0].t0) == end(seam.b[0], seam.b[0].t0) ||
               end(seam.a[0], seam.a[0].t1) == end(seam.b[0], seam.b[0].t1);
    }

    void draw_seam(std::size_t s) {
        const Seam& seam = pattern_.seams[s];
        const std::string more = is_dart(seam) ? dashes({0.5, 0.35}) : "";
        for (const SeamSide* side : {&seam.a, &seam.b})
            for (const EdgeSpan& span : *side)
                stroke(path(span), seam_colour(s), 0.24 * text_, more);
    }

    /// Where a side is half walked: on the sheet, with its direction and the direction into the panel.
    struct Middle {
        Vec2 at, along, inward;
        double length = 0; ///< of the side, mm
        const Piece* piece = nullptr;
    };

    Middle middle_of(const SeamSide& side) const {
        std::vector<double> lengths;
        double total = 0;
        for (const EdgeSpan& s : side) {
            lengths.push_back(std::abs(s.t1 - s.t0) * length(pattern_.panels[s.panel].outline[s.edge]));
            total += lengths.back();
        }
        std::size_t k = 0;
        double rest = 0.5 * total;
        while (k + 1 < side.size() && rest > lengths[k])
            rest -= lengths[k++];
        const EdgeSpan& s = side[k];
        return middle_at(s, s.t0 + (s.t1 - s.t0) * (lengths[k] > 0 ? std::min(1.0, rest / lengths[k]) : 0.5),
                         total);
    }

    Middle middle_at(const EdgeSpan& s, double t, double metres) const {
        Middle m;
        m.piece = &pieces_[s.panel];
        m.length = mm * metres;
        const Edge& edge = m.piece->panel->outline[s.edge];
        const double before = std::max(0.0, t - 0.02), after = std::min(1.0, t + 0.02);
        const Vec2 a = m.piece->on_sheet(sample(edge, before, before, 1)[0]);
        const Vec2 b = m.piece->on_sheet(sample(edge, after, after, 1)[0]);
        m.at = m.piece->on_sheet(sample(edge, t, t, 1)[0]);
        const Vec2 forward = (b - a).norm() > 0 ? Vec2((b - a).normalized()) : Vec2(1, 0);
        const bool left =
            signed_area(m.piece->panel->outline) > 0; // the inside lies left of a counter-clockwise loop
        m.inward = left ? Vec2(forward.y(), -forward.x()) : Vec2(-forward.y(), forward.x());
        m.along = s.t1 < s.t0 ? Vec2(-forward) : forward;
        return m;
    }

    double number_radius(const Middle& m) const {
        return std::clamp(0.2 * m.length, 0.25 * text_, 0.62 * text_);
    }

    void draw_seam_numbers(std::size_t s) {
        const Seam& seam = pattern_.seams[s];
        if (seam.a.empty() || seam.b.empty()) return;
        Middle a = middle_of(seam.a), b = middle_of(seam.b);
        const double r = std::min(number_radius(a), number_radius(b));
        if ((a.at - b.at).norm() < 2.2 * r) { // the legs of a narrow dart
            a.at += 1.2 * r * a.inward;
            b.at += 1.2 * r * b.inward;
        }
        for (const Middle& m : {a, b})
            draw_seam_number(s, m, r);
    }

    void draw_seam_number(std::size_t s, const Middle& m, double r) {
        const Vec2 tip = m.at + 1.75 * r * m.along, foot = m.at + 1.05 * r * m.along;
        const Vec2 across(-m.along.y(), m.along.x());
        const std::string colour = seam_colour(s);
        body_ += "<path d=\"M" + pair(tip) + " L" + pair(foot + 0.45 * r * across) + " L" +
                 pair(foot - 0.45 * r * across) + " Z\" fill=\"" + colour + "\"/>\n<circle cx=\"" +
                 number(m.at.x()) + "\" cy=\"" + number(m.at.y()) + "\" r=\"" + number(r) +
                 "\" fill=\"#ffffff\" stroke=\"" + colour + "\" stroke-width=\"" + number(0.16 * r) +
                 "\"/>\n";
        const std::string label = std::to_string(s);
        const double size = (label.size() > 2 ? 0.8 : 1.15) * r;
        words(m.at + Vec2(0, 0.36 * size), size, label,
              " class=\"seam\" font-weight=\"bold\" fill=\"" + colour + "\"");
    }

    void draw_elastic(const Elastic& e) {
        stroke(path(e.span), "#8020a0", 0.5 * text_, dashes({0.1, 0.5}) + " stroke-opacity=\"0.7\"");
        const Middle m = middle_at(e.span, 0.75 * e.span.t0 + 0.25 * e.span.t1, 0);
        words(m.at + 1.1 * text_ * m.inward, 0.6 * text_, "elastic " + number(e.ratio), " fill=\"#8020a0\"");
    }

    void draw_pin(const Pin& p) {
        stroke(path(p.span), "#101010", 0.3 * text_, dashes({0.01, 0.45}));
        const Middle m = middle_at(p.span, 0.5 * (p.span.t0 + p.span.t1), 0);
        words(m.at + 1.1 * text_ * m.inward, 0.6 * text_, "pinned", " fill=\"#101010\"");
    }

    /// Name, what else is known of the panel, grain, edge numbers and labels.
    void draw_words(const Piece& piece) {
        const Panel& panel = *piece.panel;
        const double room = mm * piece.room;
        const double letters = 0.62 * double(std::max<std::size_t>(6, panel.name.size()));
        const bool upright = piece.height > 2 * piece.width; // a narrow strip: the words run along it
        const double line = 0.9 * mm * (upright ? piece.height : piece.width) / letters;
        const double size = std::clamp(std::min(0.9 * room, line), 0.25 * text_, 1.2 * text_);
        const Vec2 at = piece.on_sheet(piece.middle);
        draw_grain(panel, at, std::min(0.9 * room, 5 * text_), size);
        std::vector<std::string> lines;
        if (!panel.fabric.empty()) lines.push_back(panel.fabric);
        if (panel.layer != 0) lines.push_back("layer " + std::to_string(panel.layer));
        if (panel.shrink.y() != 0) lines.push_back(text("steamed, warp %+.3g %%", -100 * panel.shrink.y()));
        if (panel.shrink.x() != 0) lines.push_back(text("steamed, weft %+.3g %%", -100 * panel.shrink.x()));
        if (signed_area(panel.outline) < 0) lines.push_back("wrong side up");
        const std::string halo = " stroke=\"#f4efe4\" stroke-width=\"" + number(0.25 * size) +
                                 "\" paint-order=\"stroke\"" +
                                 (upright ? " transform=\"rotate(-90 " + pair(at) + ")\"" : "");
        words(at, size, panel.name, " font-weight=\"bold\" fill=\"#202020\"" + halo);
        double below = 0.9 * size;
        for (const std::string& line : lines) {
            words(at + Vec2(0, below), 0.6 * size, line, " fill=\"#505050\"" + halo);
            below += 0.75 * size;
        }
        for (std::size_t e = 0; e < panel.outline.size(); ++e)
            draw_edge_words(piece, int(e));
    }

    void draw_edge_words(const Piece& piece, int e) {
        const Edge& edge = piece.panel->outline[e];
        const EdgeSpan span{int(&piece - pieces_.data()), e, 0, 1};
        const Middle quarter = middle_at(span, 0.25, length(edge));
        const double size = std::clamp(0.15 * quarter.length, 0.2 * text_, 0.5 * text_);
        const Vec2 down(0, 0.35 * size);
        words(quarter.at + 0.9 * size * quarter.inward + down, size, std::to_string(e), " fill=\"#909090\"");
        if (edge.label.empty()) return;
        const Middle m = middle_at(span, 0.7, length(edge)); // beside the seam's number and the panel's name
        double turn = std::atan2(m.along.y(), m.along.x()) * 180 / EIGEN_PI;
        if (turn > 90 || turn < -90) turn += turn > 0 ? -180 : 180;
        const double fit =
            std::clamp(0.5 * m.length / (0.55 * double(edge.label.size())), 0.2 * text_, 0.55 * text_);
        const Vec2 at = m.at + (0.75 * text_ + 0.6 * fit) * m.inward;
        words(at, fit, edge.label,
              " font-style=\"italic\" fill=\"#2060a0\" transform=\"rotate(" + number(turn) + " " + pair(at) +
                  ")\"");
    }

    void draw_grain(const Panel& panel, const Vec2& at, double half, double size) {
        const Vec2 way(std::cos(panel.grain), -std::sin(panel.grain)), across(-way.y(), way.x());
        const double head = std::min(0.4 * size, 0.3 * half);
        std::string d = "M" + pair(at - half * way) + " L" + pair(at + half * way);
        for (double sign : {-1.0, 1.0}) {
            const Vec2 tip = at + sign * half * way, back = tip - sign * head * way;
            d += " M" + pair(back + 0.5 * head * across) + " L" + pair(tip) + " L" +
                 pair(back - 0.5 * head * across);
        }
        body_ += "<path class=\"grain\" d=\"" + d + "\" fill=\"none\" stroke=\"#707070\" stroke-width=\"" +
                 number(0.07 * text_) + "\"/>\n";
    }

    void draw_title_and_bar() {
        const double gap = 2.5 * text_;
        body_ += "<text x=\"" + number(gap) + "\" y=\"" + number(gap) + "\" font-size=\"" +
                 number(1.3 * text_) + "\" fill=\"#202020\">" + escaped(pattern_.name) + "</text>\n";
        const Vec2 from(gap, size_.y() - gap), to = from + Vec2(100, 0), tick(0, 0.4 * text_);
        stroke("M" + pair(from - tick) + " L" + pair(from + tick) + " M" + pair(from) + " L" + pair(to) +
                   " M" + pair(to - tick) + " L" + pair(to + tick),
               "#202020", 0.12 * text_);
        words(0.5 * (from + to) - Vec2(0, 0.6 * text_), 0.9 * text_, "10 cm", " fill=\"#202020\"");
    }

    const Pattern& pattern_;
    std::vector<Piece> pieces_;
    double text_ = 10; ///< size of ordinary text, mm
    Vec2 size_ = Vec2::Zero();
    std::string body_;
};

} // namespace

std::string flat_svg(const Pattern& pattern) {
    return Sheet(pattern).draw();
}

void write_flat_svg(const std::string& path, const Pattern& pattern) {
    write_file(path, flat_svg(pattern));
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "patterns/crossing.h"

#include "patterns/curve.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace toile {
namespace {

/// A piece of an edge between grid points. Coordinates are whole numbers below 2^25 in size, so that the
/// products in `side` are exact in double.
struct Segment {
    Vec2 p, q;
    int chain = 0, edge = 0;
    int place = 0; ///< number along its chain
    double low[2], high[2];
};

double side(const Vec2& a, const Vec2& b, const Vec2& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

struct Grid {
    Vec2 origin;
    double cell;
    Vec2 to(const Vec2& p) const {
        return {std::round((p.x() - origin.x()) / cell), std::round((p.y() - origin.y()) / cell)};
    }
    Vec2 from(const Vec2& g) const { return origin + cell * g; }
};

std::vector<Segment> segments_of(const std::vector<Chain>& chains, const Grid& grid, double sag) {
    std::size_t edges = 0;
    for (const Chain& c : chains)
        edges += c.edges->size();
    const int most = int(std::max<std::size_t>(16, 2'000'000 / std::max<std::size_t>(1, edges)));
    std::vector<Segment> segments;
    for (int c = 0; c < int(chains.size()); ++c) {
        int place = 0;
        for (int e = 0; e < int(chains[c].edges->size()); ++e) {
            const Edge& edge = (*chains[c].edges)[e];
            const std::vector<Vec2> points = sample(edge, 0, 1, std::min(most, intervals_for_sag(edge, sag)));
            for (std::size_t k = 0; k + 1 < points.size(); ++k) {
                Segment s{grid.to(points[k]), grid.to(points[k + 1]), c, e, 0, {}, {}};
                if (s.p == s.q) continue;
                s.place = place++;
                for (int d = 0; d < 2; ++d)
                    std::tie(s.low[d], s.high[d]) = std::minmax(s.p[d], s.q[d]);
                segments.push_back(s);
            }
        }
    }
    return segments;
}

enum class Meeting { none, touch, cross };

bool in_box(const Segment& s, const Vec2& p) {
    return p.x() >= s.low[0] && p.x() <= s.high[0] && p.y() >= s.low[1] && p.y() <= s.high[1];
}

Meeting meeting(const Segment& s, const Segment& t, Vec2& at) {
    const double p = side(s.p, s.q, t.p), q = side(s.p, s.q, t.q), a = side(t.p, t.q, s.p),
                 b = side(t.p, t.q, s.q);
    if (((p > 0 && q < 0) || (p < 0 && q > 0)) && ((a > 0 && b < 0) || (a < 0 && b > 0))) {
        at = s.p + a / (a - b) * (s.q - s.p);
        return Meeting::cross;
    }
    if (p == 0 && in_box(s, t.p)) return at = t.p, Meeting::touch;
    if (q == 0 && in_box(s, t.q)) return at = t.q, Meeting::touch;
    if (a == 0 && in_box(t, s.p)) return at = s.p, Meeting::touch;
    if (b == 0 && in_box(t, s.q)) return at = s.q, Meeting::touch;
    return Meeting::none;
}

constexpr std::size_t enough = 1000; ///< a scribble of n lines has n^2 crossings

class Finder {
public:
    Finder(const std::vector<Chain>& chains, const Grid& grid, const CrossingOptions& options)
        : chains_(chains), grid_(grid), corner_(options.corner / grid.cell),
          segments_(segments_of(chains, grid, options.sag)), count_(chains.size(), 0) {
        for (const Segment& s : segments_)
            count_[s.chain] = std::max(count_[s.chain], s.place + 1);
    }

    /// Sort and sweep along the axis on which the segments overlap less: near-linear for every outline that
    /// is not a comb at 45 degrees.
    std::vector<LineCrossing> run() {
        double spread[2] = {0, 0};
        for (const Segment& s : segments_)
            for (int d = 0; d < 2; ++d)
                spread[d] += s.high[d] - s.low[d];
        const int axis = spread[0] <= spread[1] ? 0 : 1;
        std::stable_sort(segments_.begin(), segments_.end(),
                         [axis](const Segment& s, const Segment& t) { return s.low[axis] < t.low[axis]; });
        std::vector<int> active;
        for (int i = 0; i < int(segments_.size()) && found_.size() < enough; ++i) {
            const Segment& s = segments_[i];
            std::erase_if(active, [&](int j) { return segments_[j].high[axis] < s.low[axis]; });
            for (int j : active)
                if (segments_[j].high[1 - axis] >= s.low[1 - axis] &&
                    segments_[j].low[1 - axis] <= s.high[1 - axis])
                    look(segments_[j], s);
            active.push_back(i);
        }
        std::vector<LineCrossing> found;
        for (const auto& [key, crossing] : found_)
            found.push_back(crossing);
        return found;
    }

private:
    void look(const Segment& s, const Segment& t) {
        if (std::tie(t.chain, t.place) < std::tie(s.chain, s.place)) return look(t, s);
        if (s.chain == t.chain) {
            const int apart = t.place - s.place, n = count_[s.chain];
            if (apart == 1) return look_at_neighbours(s, t);
            if (chains_[s.chain].closed && apart == n - 1) return look_at_neighbours(t, s);
        }
        Vec2 at;
        const Meeting m = meeting(s, t, at);
        if (m == Meeting::none || (m == Meeting::touch && touch_allowed(s, t)) || at_shared_corner(s, t, at))
            return;
        add(s, t, at, m == Meeting::touch);
    }

    /// t follows s and begins where s ends: wrong only when it runs back on it.
    void look_at_neighbours(const Segment& s, const Segment& t) {
        if (side(s.p, s.q, t.q) == 0 && (s.q - s.p).dot(t.q - t.p) < 0) add(s, t, t.p, true);
    }

    bool touch_allowed(const Segment& s, const Segment& t) const {
        return s.chain != t.chain && (chains_[s.chain].may_touch || chains_[t.chain].may_touch);
    }

    /// Neighbouring edges may leave their corner nearly along each other, where polylines stray by their sag.
    bool at_shared_corner(const Segment& s, const Segment& t, const Vec2& at) const {
        if (s.chain != t.chain || s.edge == t.edge) return false;
        const Loop& loop = *chains_[s.chain].edges;
        const int n = int(loop.size());
        const auto near_end_of = [&](int e) { return (grid_.to(loop[e].end) - at).norm() <= corner_; };
        if (t.edge == (s.edge + 1) % n && near_end_of(s.edge)) return true;
        return s.edge == (t.edge + 1) % n && near_end_of(t.edge);
    }

    void add(const Segment& s, const Segment& t, const Vec2& at, bool touch) {
        LineCrossing c{s.chain, s.edge, t.chain, t.edge, grid_.from(at), touch};
        if (std::tie(c.chain_b, c.edge_b) < std::tie(c.chain_a, c.edge_a)) {
            std::swap(c.chain_a, c.chain_b);
            std::swap(c.edge_a, c.edge_b);
        }
        const auto [it, fresh] = found_.try_emplace({c.chain_a, c.edge_a, c.chain_b, c.edge_b}, c);
        if (!fresh && it->second.touch && !touch) it->second = c; // a crossing says more than a touch
    }

    const std::vector<Chain>& chains_;
    const Grid& grid_;
    double corner_;
    std::vector<Segment> segments_;
    std::vector<int> count_; ///< segments per chain
    std::map<std::array<int, 4>, LineCrossing> found_;
};

} // namespace

std::vector<LineCrossing> find_crossings(const std::vector<Chain>& chains, double extent,
                                     const CrossingOptions& options) {
    for (const Chain& c : chains)
        if (!c.edges->empty()) {
            const Grid grid{c.edges->front().start, std::max(1e-6, extent / (1 << 24))};
            return Finder(chains, grid, options).run();
        }
    return {};
}

bool contains(const Loop& loop, const Vec2& p) {
    bool inside = false;
    for (const Edge& e : loop) {
        const std::vector<Vec2> points = sample(e, 0, 1, intervals_for_sag(e, 1e-5));
        for (std::size_t k = 0; k + 1 < points.size(); ++k) {
            const Vec2 &a = points[k], &b = points[k + 1];
            if ((a.y() > p.y()) == (b.y() > p.y())) continue;
            const double s = side(a, b, p);
            if ((s > 0) == (b.y() > a.y())) inside = !inside;
        }
    }
    return inside;
}

} // namespace toile

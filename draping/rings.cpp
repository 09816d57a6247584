// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/rings.h"

#include "draping/pieces.h"
#include "geometry/bvh.h"
#include "geometry/disjoint_sets.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace toile {

namespace {

/// An angle brought to [-pi, pi].
double turned(double angle) { return std::remainder(angle, 2 * EIGEN_PI); }

std::pair<int, int> panels_of(const Garment& g, const Stitch& s) {
    return {g.panel_of_vertex[s.a], g.panel_of_vertex[s.b[0]]};
}

/// Whether what lies at a hangs beside what lies at b as seen from the axis, rather than below or above it.
bool beside(const Vec3& a, const Vec3& b, const Vec3& axis) {
    const Vec2 p(a.x() - axis.x(), a.z() - axis.z()), q(b.x() - axis.x(), b.z() - axis.z());
    return std::min(p.norm(), q.norm()) * (p.normalized() - q.normalized()).norm() > std::abs(a.y() - b.y());
}

/// By ring, which its first panel stands for: whether its seams lead round the axis and back to where they began.
std::vector<bool> rings_that_go_round(const Garment& g, const std::vector<int>& ring, const std::vector<int>& turns) {
    std::vector<int> ahead(ring.size(), 0); // turns, of a panel
    std::vector<bool> reached(ring.size(), false), round(ring.size(), false);
    for (const int first : ring) reached[first] = true;
    for (bool more = true; more;) {
        more = false;
        for (const Stitch& s : g.stitches) {
            const auto [p, q] = panels_of(g, s);
            if (ring[p] != ring[q] || (!reached[p] && !reached[q])) continue;
            more = more || !reached[p] || !reached[q];
            if (!reached[q]) ahead[q] = ahead[p] + turns[s.seam];
            if (!reached[p]) ahead[p] = ahead[q] - turns[s.seam];
            reached[p] = reached[q] = true;
            if (ahead[q] - ahead[p] != turns[s.seam]) round[ring[p]] = true;
        }
    }
    return round;
}

} // namespace

double azimuth(const Vec3& point, const Vec3& axis) {
    return std::atan2(point.z() - axis.z(), point.x() - axis.x());
}

std::vector<Vec3> panel_middles(const Garment& garment, const Points& x) {
    std::vector<Vec3> middles(garment.panel_names.size(), Vec3::Zero());
    for (const Piece& piece : pieces_of(garment, x))
        for (int panel : piece.panels) middles[panel] = piece.middle;
    return middles;
}

std::vector<int> turns_at_seams(const Garment& garment, const Points& x, const Vec3& axis) {
    struct Seam {
        Vec3 a = Vec3::Zero(), b = Vec3::Zero(); // sums over its stitches
        int count = 0, from = 0, to = 0;         // panels
    };
    std::vector<Seam> seams;
    for (const Stitch& s : garment.stitches) {
        seams.resize(std::max(seams.size(), std::size_t(s.seam + 1)));
        Seam& seam = seams[s.seam];
        seam.a += x[s.a];
        seam.b += seam_point(s, x);
        ++seam.count;
        std::tie(seam.from, seam.to) = panels_of(garment, s);
    }
    const std::vector<Vec3> middles = panel_middles(garment, x);
    std::vector<int> turns;
    for (const Seam& s : seams) {
        const double from = azimuth(middles[s.from], axis), to = azimuth(middles[s.to], axis);
        const double a = azimuth(s.a / std::max(s.count, 1), axis), b = azimuth(s.b / std::max(s.count, 1), axis);
        turns.push_back(int(std::lround((from + turned(a - from) + turned(b - a) + turned(to - b) - to) / (2 * EIGEN_PI))));
    }
    return turns;
}

std::vector<bool> skirt_round_arms(const Garment& garment, const Points& x, const TriMesh& body, const std::vector<char>& split,
                                   double armpit) {
    const int panels = int(garment.panel_names.size());
    const Vec3 axis = Bvh(point_boxes(body.points, 0)).bounds().center();
    const std::vector<Vec3> middles = panel_middles(garment, x);
    DisjointSets joined(panels);
    for (const Stitch& s : garment.stitches)
        if (const auto [p, q] = panels_of(garment, s); beside(middles[p], middles[q], axis)) joined.join(p, q);
    const std::vector<int> ring = joined.all();
    const auto below = [&](int p, int q) { return ring[p] != ring[q] && middles[p].y() < middles[q].y(); };

    const std::vector<bool> goes_round = rings_that_go_round(garment, ring, turns_at_seams(garment, x, axis));
    std::vector<bool> blocked(panels, false), hangs(panels, false), high(panels, false); // by ring
    for (const Stitch& s : garment.stitches) {
        const auto [p, q] = panels_of(garment, s);
        if (ring[p] == ring[q] && split[s.seam]) blocked[ring[p]] = true;
        if (!below(p, q) && !below(q, p)) continue;
        const int lower = ring[below(p, q) ? p : q];
        hangs[lower] = true;
        if (seam_point(s, x).y() > armpit) high[lower] = true;
    }
    std::vector<bool> round(panels, false);
    for (int p = 0; p < panels; ++p) round[p] = goes_round[ring[p]] && blocked[ring[p]] && hangs[ring[p]] && !high[ring[p]];
    for (bool more = true; more;) {
        more = false;
        for (const Stitch& s : garment.stitches) {
            auto [from, to] = panels_of(garment, s);
            if (round[to]) std::swap(from, to);
            if (!round[from] || round[to] || !below(to, from)) continue;
            const int hanging = ring[to];
            for (int p = 0; p < panels; ++p) round[p] = round[p] || ring[p] == hanging;
            more = true;
        }
    }
    return round;
}

} // namespace toile

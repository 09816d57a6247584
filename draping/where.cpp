// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/where.h"

#include "geometry/distance.h"
#include "geometry/text.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace toile {

namespace {

constexpr std::size_t most_sections = 256; // of cloth that is too tight: those where it is so most may all leave it over an edge

std::string coordinates(const Vec3& p) {
    return text("(%.3f, %.3f, %.3f) m", p.x(), p.y(), p.z());
}

int panel_of_node(const Garment& g, int node) {
    for (std::size_t v = 0; v < g.node_of_vertex.size(); ++v)
        if (g.node_of_vertex[v] == node) return g.panel_of_vertex[v];
    return -1;
}

std::string on_panel(const Garment& g, int panel, const Vec3& at) {
    return (panel < 0 ? "" : "panel \"" + g.panel_names[panel] + "\" ") + "at " + coordinates(at);
}

/// Share of the way from a to b at which a triangle is crossed between them; infinity when it is not.
double crossing(const Vec3& a, const Vec3& b, const Vec3& p, const Vec3& q, const Vec3& r) {
    const auto at = segment_through_triangle(a, b, p, q, r);
    return at && at->along > 0 && at->along < 1 ? at->along : std::numeric_limits<double>::infinity();
}

/// The middle of the thread's way through the body.
bool thread_in_body(const Vec3& a, const Vec3& b, const TriMesh& body, Vec3& at) {
    double first = 2, last = -1;
    for (const Triangle& t : body.triangles) {
        const double s = crossing(a, b, body.points[t[0]], body.points[t[1]], body.points[t[2]]);
        if (!std::isfinite(s)) continue;
        first = std::min(first, s);
        last = std::max(last, s);
    }
    at = a + (first + last) / 2 * (b - a);
    return last >= 0;
}

/// The first triangle of the cloth that the thread passes through, apart from those of its own ends; -1: none.
int thread_through_cloth(const Garment& g, const Points& x, const Stitch& s) {
    int found = -1;
    double least = 2;
    for (int t = 0; t < int(g.triangles.size()); ++t) {
        const Triangle n = g.nodes(t);
        if (std::any_of(n.begin(), n.end(), [&](int i) { return i == s.a || i == s.b[0] || i == s.b[1]; }))
            continue;
        const double at = crossing(x[s.a], seam_point(s, x), x[n[0]], x[n[1]], x[n[2]]);
        if (at < least) {
            least = at;
            found = t;
        }
    }
    return found;
}

/// What a unit of weft (column 0) and of warp (column 1) has become in space.
Eigen::Matrix<double, 3, 2> yarns_of(const Garment& g, const Points& x, int t) {
    const Triangle n = g.nodes(t);
    Eigen::Matrix<double, 3, 2> edges;
    edges << x[n[1]] - x[n[0]], x[n[2]] - x[n[0]];
    return edges * g.rest.edges[t].inverse();
}

struct Plane {
    Vec3 point, normal;
    double height(const Vec3& p) const { return normal.dot(p - point); }
};

/// A triangle's part of a section by a plane.
struct Cut {
    double space = 0;   ///< m, length in space
    double allowed = 0; ///< m, what its flat length may be stretched to
};

/// What a length of the flat may be stretched to: with both yarns at their limits, as far as they have one, and sheared as it
/// is, up to the limit of that.
double allowed_length(const Vec2& flat, const Fabric& f, const Eigen::Matrix<double, 3, 2>& yarns) {
    const double weft = yarns.col(0).norm(), warp = yarns.col(1).norm();
    const double most_shear = f.limit_shear > 0 ? std::sin(f.limit_shear) : 1;
    const double shear = weft > 0 && warp > 0 ? std::clamp(yarns.col(0).dot(yarns.col(1)) / (weft * warp), -most_shear, most_shear) : 0;
    const double a = flat.x() * (f.limit_weft > 0 ? 1 + f.limit_weft : weft);
    const double b = flat.y() * (f.limit_warp > 0 ? 1 + f.limit_warp : warp);
    return std::sqrt(a * a + b * b + 2 * a * b * shear);
}

bool cut_triangle(const Garment& g, const Points& x, const PanelFabrics& fabrics, int t, const Plane& plane,
                  Cut& cut) {
    const Triangle n = g.nodes(t);
    const Mat2& e = g.rest.edges[t];
    const Vec2 flat[3] = {Vec2::Zero(), e.col(0), e.col(1)};
    Vec3 in_space[2];
    Vec2 in_flat[2];
    int ends = 0;
    for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3;
        const double a = plane.height(x[n[k]]), b = plane.height(x[n[l]]);
        if ((a >= 0) == (b >= 0) || ends == 2) continue;
        const double s = a / (a - b);
        in_space[ends] = (1 - s) * x[n[k]] + s * x[n[l]];
        in_flat[ends++] = (1 - s) * flat[k] + s * flat[l];
    }
    if (ends < 2) return false;
    cut = {(in_space[1] - in_space[0]).norm(),
           allowed_length(in_flat[1] - in_flat[0], fabrics[g.panel_of_triangle[t]], yarns_of(g, x, t))};
    return true;
}

/// By how much the section by a plane, as far as triangles are connected to `seed`, is longer than allowed:
/// with those that are shorter making up for others, and without. `connected` has the triangles' neighbours.
struct Excess {
    double sum = 0, over = 0;
    std::vector<char> panels; ///< which the section goes through
};
Excess section_excess(const Garment& g, const EdgeTable& connected, const Points& x, const PanelFabrics& fabrics,
                      int seed, const Plane& plane) {
    std::vector<char> seen(g.triangles.size(), 0);
    std::vector<int> open{seed};
    seen[seed] = 1;
    Excess excess;
    excess.panels.assign(g.panel_names.size(), 0);
    while (!open.empty()) {
        const int t = open.back();
        open.pop_back();
        Cut cut;
        if (!cut_triangle(g, x, fabrics, t, plane, cut)) continue;
        excess.panels[g.panel_of_triangle[t]] = 1;
        excess.sum += cut.space - cut.allowed;
        excess.over += std::max(0.0, cut.space - cut.allowed);
        for (int edge : connected.of_triangle[t]) {
            for (int i = connected.first[edge]; i < connected.first[edge + 1]; ++i) {
                const int next = connected.incident[i];
                if (!seen[next]) open.push_back(next);
                seen[next] = 1;
            }
        }
    }
    return excess;
}

/// The plane through a triangle's middle that has its normal and its direction of most stretch in it: round a sleeve, it is not level.
Plane along_most_stretch(const Garment& g, const Points& x, int t) {
    const Triangle n = g.nodes(t);
    const Eigen::Matrix<double, 3, 2> yarns = yarns_of(g, x, t);
    const Eigen::SelfAdjointEigenSolver<Mat2> principal(yarns.transpose() * yarns);
    const Vec3 round = yarns * principal.eigenvectors().col(1), out = yarns.col(0).cross(yarns.col(1));
    return {(x[n[0]] + x[n[1]] + x[n[2]]) / 3, round.cross(out).normalized()};
}

/// Gaps on a plane, one per seam of the panels: of the stitch that is nearest to the plane, when that is near.
double gaps_on(const Garment& g, const Points& x, const Plane& plane, const std::vector<char>& panels) {
    std::map<int, std::pair<double, double>> nearest; // by seam: distance from the plane, gap
    for (const Stitch& s : g.stitches) {
        const Vec3 to = seam_point(s, x);
        const double away = std::abs(plane.height(0.5 * (x[s.a] + to)));
        if (away > std::max(s.length, 0.005)) continue;
        if (const int panel = panel_of_node(g, s.a); panel < 0 || !panels[panel]) continue;
        const auto [at, fresh] = nearest.try_emplace(s.seam, away, (x[s.a] - to).norm());
        if (!fresh && away < at->second.first) at->second = {away, (x[s.a] - to).norm()};
    }
    double sum = 0;
    for (const auto& [seam, gap] : nearest)
        sum += gap.second;
    return sum;
}

/// The plane across a seam at a stitch of its; level where the seam has no other.
Plane across_seam(const Garment& g, const Points& x, const Stitch& at) {
    const Vec3 middle = 0.5 * (x[at.a] + seam_point(at, x));
    Vec3 along = Vec3::UnitY();
    double nearest = std::numeric_limits<double>::infinity();
    for (const Stitch& s : g.stitches) {
        const double away = (x[s.a] - x[at.a]).norm();
        if (s.seam != at.seam || s.a == at.a || away == 0 || away >= nearest) continue;
        nearest = away;
        along = (x[s.a] - x[at.a]) / away;
    }
    return {middle, along};
}

} // namespace

std::string place_of_node(const Garment& g, const Points& x, int node) {
    return on_panel(g, panel_of_node(g, node), x[node]);
}

std::string place_of_triangle(const Garment& g, const Points& x, int t) {
    const Triangle n = g.nodes(t);
    return on_panel(g, g.panel_of_triangle[t], (x[n[0]] + x[n[1]] + x[n[2]]) / 3);
}

std::string place_of_pair(const Garment& g, const Points& x, const ContactPair& pair) {
    std::string first, second;
    for (int i : pair.p) {
        if (i >= g.node_count) continue;
        const std::string place = place_of_node(g, x, i);
        if (first.empty())
            first = place;
        else if (second.empty() && !pair.with_body && i != pair.p[1])
            second = place;
    }
    return first + " against " + (pair.with_body ? "the body" : second);
}

int widest_stitch(const Garment& g, const Points& x) {
    int widest = -1;
    double most = -1;
    for (int k = 0; k < int(g.stitches.size()); ++k) {
        const double gap = (x[g.stitches[k].a] - seam_point(g.stitches[k], x)).norm();
        if (gap <= most) continue;
        most = gap;
        widest = k;
    }
    return widest;
}

std::string open_seam(const Garment& g, const Points& x, const std::vector<std::string>& seam_names,
                      const TriMesh& body, const std::vector<ContactPair>& touching) {
    const int k = widest_stitch(g, x);
    if (k < 0) return "";
    const Stitch& s = g.stitches[k];
    const std::string gap = text("%.1f mm", 1e3 * (x[s.a] - seam_point(s, x)).norm());
    const std::string name =
        s.seam < int(seam_names.size()) ? seam_names[s.seam] : "seam " + std::to_string(s.seam);
    std::string text = name + " does not close: " + gap + " are left between " + place_of_node(g, x, s.a) +
                       " and " + place_of_node(g, x, s.b[0]) + "; ";
    Vec3 inside;
    if (thread_in_body(x[s.a], seam_point(s, x), body, inside))
        return text + "the body is between them at " + coordinates(inside);
    if (const int t = thread_through_cloth(g, x, s); t >= 0)
        return text + place_of_triangle(g, x, t) + " is between them";
    for (const ContactPair& pair : touching)
        for (int i : pair.p)
            if (i == s.a || i == s.b[0] || i == s.b[1])
                return text + "what touches there is " + place_of_pair(g, x, pair);
    return text + "nothing is in the way there, the cloth round it is held back";
}

Tightness find_tightness(const Garment& g, const Points& x, const PanelFabrics& fabrics) {
    std::vector<Tightness> beyond;
    for (int t = 0; t < int(g.triangles.size()); ++t) {
        const Fabric& f = fabrics[g.panel_of_triangle[t]];
        const Eigen::Matrix<double, 3, 2> yarns = yarns_of(g, x, t);
        for (const bool warp : {false, true}) {
            const double limit = warp ? f.limit_warp : f.limit_weft;
            const double strain = yarns.col(warp ? 1 : 0).norm() - 1;
            if (limit > 0 && strain > limit) beyond.push_back({t, strain, limit, warp});
        }
    }
    if (beyond.empty()) return {};
    std::sort(beyond.begin(), beyond.end(), [](const Tightness& a, const Tightness& b) {
        return std::make_pair(b.strain - b.limit, a.triangle) < std::make_pair(a.strain - a.limit, b.triangle);
    });
    Tightness worst = beyond[0];
    const std::size_t stride = (beyond.size() + most_sections - 1) / most_sections;
    for (std::size_t k = 0; k < beyond.size(); k += stride) {
        const int t = beyond[k].triangle;
        const Excess excess = section_excess(g, g.edges, x, fabrics, t, along_most_stretch(g, x, t));
        worst.missing = std::max(worst.missing, excess.sum);
        worst.missing_in_part = std::max(worst.missing_in_part, excess.over);
    }
    return worst;
}

double missing_at_open_seam(const Garment& g, const Points& x, const PanelFabrics& fabrics) {
    const int k = widest_stitch(g, x);
    if (k < 0) return 0;
    const Stitch& s = g.stitches[k];
    const Plane plane = across_seam(g, x, s);
    const EdgeTable closed = close_seams(g).edges;
    const int panel = panel_of_node(g, s.a);
    Cut cut;
    for (int t = 0; t < int(g.triangles.size()); ++t) {
        if (g.panel_of_triangle[t] != panel || !cut_triangle(g, x, fabrics, t, plane, cut)) continue;
        const Excess excess = section_excess(g, closed, x, fabrics, t, plane);
        return excess.sum + gaps_on(g, x, plane, excess.panels);
    }
    return 0;
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/strain_difference.h"

#include "draping/flat_places.h"
#include "draping/measure.h"

#include <algorithm>
#include <cmath>

namespace toile {
namespace {

/// Mean strains round every vertex, and a third of the area there.
struct VertexStrains {
    std::vector<Vec2> strain;
    std::vector<double> area;
};

VertexStrains vertex_strains(const Garment& g, const Points& x) {
    VertexStrains v{std::vector<Vec2>(g.uv.size(), Vec2::Zero()), std::vector<double>(g.uv.size(), 0)};
    const std::vector<Vec2> strain = yarn_strains(g, x);
    const std::vector<double> area = rest_areas(g);
    for (std::size_t t = 0; t < g.triangles.size(); ++t)
        for (const int k : g.triangles[t]) {
            v.strain[k] += area[t] / 3 * strain[t];
            v.area[k] += area[t] / 3;
        }
    for (std::size_t k = 0; k < v.strain.size(); ++k)
        if (v.area[k] > 0) v.strain[k] /= v.area[k];
    return v;
}

/// Linear in the triangle.
Vec2 strain_in(const Garment& g, const VertexStrains& strains, int t, const Vec2& at) {
    const Vec3 share = shares_in_triangle(g, t, at);
    Vec2 sum = Vec2::Zero();
    for (int k = 0; k < 3; ++k) sum += share[k] * strains.strain[g.triangles[t][k]];
    return sum;
}

} // namespace

double strain_difference(const Garment& a, const Points& x_a, const Garment& b, const Points& x_b) {
    const VertexStrains of_a = vertex_strains(a, x_a), of_b = vertex_strains(b, x_b);
    std::vector<FlatPanel> panels;
    for (int p = 0; p < int(a.panel_names.size()); ++p) panels.push_back(flat_panel(a, p));
    double sum = 0, area = 0;
    for (std::size_t v = 0; v < b.uv.size(); ++v) {
        const int t = nearest_triangle(a, panels[b.panel_of_vertex[v]], b.uv[v]);
        sum += of_b.area[v] * (of_b.strain[v] - strain_in(a, of_a, t, b.uv[v])).squaredNorm() / 2;
        area += of_b.area[v];
    }
    return area > 0 ? std::sqrt(sum / area) : 0;
}

} // namespace toile

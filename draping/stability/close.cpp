// SPDX-License-Identifier: GPL-3.0-or-later
// A strip lies flat, and its barrier acts farther than its rows are apart: it presses on itself where nothing touches.

#include "draping/cloth.h"
#include "draping/settle_cloth.h"
#include "draping/stability/strip.h"

#include "geometry/text.h"

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

constexpr double strained = 1e-4;
constexpr int most_iterations = 100;

/// Whether two nodes are one, or an edge joins them.
class Neighbours {
public:
    explicit Neighbours(const Garment& g) : nodes_(g.node_count), joined_(nodes_ * nodes_, 0) {
        for (int i = 0; i < nodes_; ++i) joined_[i * nodes_ + i] = 1;
        for (const auto& [a, b] : g.edges.ends) joined_[a * nodes_ + b] = joined_[b * nodes_ + a] = 1;
    }
    bool any(const std::array<int, 4>& p, int first) const { // of the first so many and the rest
        for (int a = 0; a < first; ++a)
            for (int b = first; b < 4; ++b)
                if (joined_[p[a] * nodes_ + p[b]]) return true;
        return false;
    }

private:
    int nodes_;
    std::vector<char> joined_;
};

/// Least distance at rest of parts that no edge joins, m: of neighbours a barrier acts within half of their triangles' height at most, of
/// all others wherever it reaches.
double least_distance(const Garment& g, const Points& x) {
    const Neighbours near(g);
    double least = INFINITY;
    const auto look = [&](const std::array<int, 4>& p, bool edge_edge) {
        if (!near.any(p, edge_edge ? 2 : 1)) least = std::min(least, pair_geometry({x[p[0]], x[p[1]], x[p[2]], x[p[3]]}, edge_edge).d);
    };
    for (std::size_t t = 0; t < g.triangles.size(); ++t)
        for (int i = 0; i < g.node_count; ++i) {
            const Triangle n = g.nodes(int(t));
            look({i, n[0], n[1], n[2]}, false);
        }
    for (std::size_t e = 0; e < g.edges.ends.size(); ++e)
        for (std::size_t f = 0; f < e; ++f)
            look({g.edges.ends[e][0], g.edges.ends[e][1], g.edges.ends[f][0], g.edges.ends[f][1]}, true);
    return least;
}

StabilityOutcome lie(const SceneCloth& cloth, double distance) {
    ClothProblem problem(cloth.garment, cloth.fabrics, {}, barriers_at(distance, cloth.fabrics[0].density));
    for (const int i : cloth.held) problem.pin(i);
    SettleOptions o;
    o.max_iterations = most_iterations;
    Cholesky factor;
    Points x = cloth.x;
    const SettleResult r = settle_cloth(problem, x, factor, o);
    double strain = 0;
    for (const auto& [a, b] : cloth.garment.edges.ends)
        strain = std::max(strain, std::abs((x[b] - x[a]).norm() / (cloth.x[b] - cloth.x[a]).norm() - 1));
    if (r.end != SettleEnd::settled) return {strain, "not at rest"};
    return {strain, strain > strained ? "presses on itself" : ""};
}

} // namespace

StabilityScene close_scene() {
    StabilityScene s;
    s.method = Method::equilibrium;
    s.name = "flat, with a barrier";
    s.what = text("A strip lies flat without weight, in contact with itself. It fails where it does not come to rest or is strained by more than %g %% there.", 100 * strained);
    s.axis = "distance of the barrier over the length of edges";
    s.measure = "largest strain of an edge";
    s.theory = "least distance at rest of what no edge joins";
    s.low = 0.3;
    s.high = 3;
    s.run = [](const StabilityMesh& mesh, double stiffness, const std::vector<double>& values) {
        const SceneCloth cloth = stability_strip(mesh, stiffness);
        const double edge = strip_length / strip_rows;
        StabilityColumn column;
        column.boundary = least_distance(cloth.garment, cloth.x) / edge;
        for (const double value : values) column.outcomes.push_back(lie(cloth, value * edge));
        return column;
    };
    return s;
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/drape.h"

#include "draping/cloth.h"
#include "draping/solve/settle.h"
#include "geometry/intersections.h"
#include "sewing/arrange.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

namespace toile {

namespace {

using Clock = std::chrono::steady_clock;
double since(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

bool talk() { static bool t = std::getenv("TOILE_TALK") != nullptr; return t; }

double total_area(const Garment& g) {
    double a = 0;
    for (const Mat2& r : g.rest.edges) a += 0.5 * std::abs(r.determinant());
    return a;
}

ContactOptions contact_options(double distance, double density) {
    ContactOptions c;
    c.body.distance = distance;
    c.body.floor = 0.1 * distance;
    c.body.stiffness = 1e6 * std::max(0.05, density / 0.15) * (0.5e-3 / distance);
    c.cloth = c.body;
    return c;
}

double largest_gap(const Garment& g, const Points& x) {
    double gap = 0;
    for (const Stitch& s : g.stitches)
        gap = std::max(gap, (x[s.a] - (1 - s.r) * x[s.b[0]] - s.r * x[s.b[1]]).norm());
    return gap;
}

} // namespace

const char* to_string(DrapeStatus s) {
    switch (s) {
    case DrapeStatus::converged: return "converged";
    case DrapeStatus::stalled: return "stalled";
    case DrapeStatus::limit: return "limit";
    case DrapeStatus::too_small: return "too_small";
    case DrapeStatus::slid_off: return "slid_off";
    }
    return "stalled";
}

DrapeResult drape(const Pattern& pattern, const FlatPattern& flat, const Avatar& avatar, const PanelFabrics& fabrics,
                  const DrapeOptions& options) {
    DrapeResult result;
    result.tolerance = options.tolerance;
    double density = 0;
    for (const Fabric& f : fabrics) density = std::max(density, f.density);
    double mu = options.friction;
    if (mu < 0) for (const Fabric& f : fabrics) mu = std::max(mu, f.friction);
    result.friction = mu;
    const int levels = int(flat.levels.size());

    // Sew the coarsest level.
    Points x;
    Garment closed;
    {
        const auto start = Clock::now();
        const FlatLevel& level = flat.levels[0];
        const Garment open = sew(pattern, level);
        x = place(pattern, level);
        ContactOptions co = contact_options(std::max(options.clearance, 0.06 * level.edge_length), density);
        co.self = false;
        ClothProblem problem(open, fabrics, avatar.body, co);
        problem.sheet().softness = 1.0 / 16;
        for (const Stitch& s : open.stitches)
            problem.stitches.push_back({s.a, s.b, s.r, 500 * s.length, 6 * s.length});
        Cholesky factor;
        SettleOptions so;
        so.tolerance = 1e-2;
        so.max_iterations = 6;
        so.exact_below = 0;
        double last = 1e9;
        int its = 0;
        for (int round = 0; round < 100; ++round) {
            so.time_step = std::min(0.02 * std::pow(2.0, round / 3), 1.0);
            const SettleResult r = settle(problem, x, factor, so);
            its += r.iterations;
            const double gap = largest_gap(open, x);
            if (talk()) std::fprintf(stderr, "sew %d gap %.5f residual %.3g energy %.5g it %d (%.2f s)\n", round, gap, r.residual, r.energy, its, since(start));
            if (talk() && round % 10 == 9) {
                int bad = 0; double most = 0;
                for (int i = 0; i < int(open.stitches.size()); ++i) { double d = (x[open.stitches[i].a] - x[open.stitches[i].b[0]]).norm(); if (d > most) { most = d; bad = i; } }
                const Stitch& st = open.stitches[bad];
                std::fprintf(stderr, "   widest: %s at %.3f %.3f %.3f to %.3f %.3f %.3f; blocking pair %d", pattern.seams[st.seam].name.c_str(), x[st.a].x(), x[st.a].y(), x[st.a].z(), x[st.b[0]].x(), x[st.b[0]].y(), x[st.b[0]].z(), problem.blocking_pair());
                if (problem.blocking_pair() >= 0) { const ContactPair& cp = problem.contact().pair(problem.blocking_pair()); const Vec3 q = cp.p[0] < open.node_count ? x[cp.p[0]] : problem.contact().body()[cp.p[0] - open.node_count]; std::fprintf(stderr, " ee %d body %d at %.3f %.3f %.3f", int(cp.edge_edge), int(cp.with_body), q.x(), q.y(), q.z()); }
                std::fprintf(stderr, "\n");
            }
            if (gap < 2e-4) break;
            if (gap < 0.01) for (auto& s : problem.stitches) s.stiffness = std::min(3 * s.stiffness, 1e5 * s.cap / 6);
            if (gap > 0.9 * last) for (auto& s : problem.stitches) s.cap *= 1.5;
            last = gap;
        }
        std::vector<int> map;
        closed = close_seams(open, &map);
        Points merged(closed.node_count, Vec3::Zero());
        std::vector<int> count(closed.node_count, 0);
        for (std::size_t i = 0; i < x.size(); ++i) { merged[map[i]] += x[i]; ++count[map[i]]; }
        for (int i = 0; i < closed.node_count; ++i) merged[i] /= count[i];
        x = merged;
        result.seconds.push_back({"sew", since(start)});
        result.levels.push_back({level.edge_length, int(level.points.size()), its, its, since(start)});
    }

    for (int l = 0; l < levels; ++l) {
        const auto start = Clock::now();
        const FlatLevel& level = flat.levels[l];
        if (l > 0) {
            const Garment coarse = closed;
            closed = close_seams(sew(pattern, level));
            Points fine(closed.node_count, Vec3::Zero());
            std::vector<int> count(closed.node_count, 0);
            for (std::size_t v = 0; v < level.points.size(); ++v) {
                const Interpolation& p = flat.prolongation[l - 1][v];
                Vec3 q = Vec3::Zero();
                for (int k = 0; k < 3; ++k) q += p.weight[k] * x[coarse.node_of_vertex[p.from[k]]];
                fine[closed.node_of_vertex[v]] += q;
                ++count[closed.node_of_vertex[v]];
            }
            for (int i = 0; i < closed.node_count; ++i) fine[i] /= count[i];
            x = fine;
            result.levels.push_back({level.edge_length, int(level.points.size()), 0, 0, 0});
        }
        const bool last = l + 1 == levels;
        ContactOptions co = contact_options(last ? options.clearance : std::max(options.clearance, 0.06 * level.edge_length), density);
        ClothProblem problem(closed, fabrics, avatar.body, co);
        problem.gravity = options.gravity;
        problem.rest_here(x, mu);
        if (talk()) {
            auto ic = count_intersections(node_triangles(closed), x, avatar.body);
            std::fprintf(stderr, "level %d: %d nodes, start violations %d, crossings %d %d\n", l, closed.node_count, problem.contact().violations(x), ic.cloth_avatar, ic.cloth_cloth);
        }
        Cholesky factor;
        SettleOptions so;
        so.progress = [&](int it, double r) {
            if (talk()) std::fprintf(stderr, "  it %d residual %.4g\n", it, r);
            return true;
        };
        const double softness[3] = {1.0 / 16, 1.0 / 4, 1};
        for (int s = l == 0 ? 0 : 1; s < 3; ++s) {
            problem.sheet().softness = softness[s];
            so.tolerance = last && s == 2 ? options.tolerance : 1;
            so.max_iterations = s == 1 && l > 0 ? 8 : last && s == 2 ? 400 : 100;
            so.exact_below = s == 2 ? 20 : 0;
            if (s == 2) problem.limit_strain(x);
            const SettleResult r = settle(problem, x, factor, so);
            result.levels.back().iterations += r.iterations;
            result.levels.back().factorisations += r.factorisations;
            result.residual = r.residual;
            if (talk()) std::fprintf(stderr, "settle level %d soft %g: end %d residual %.3g energy %.6g its %d fac %d cg %d widened %d (%.2f s)\n", l, softness[s], int(r.end), r.residual, r.energy, r.iterations, r.factorisations, r.conjugate_gradients, problem.widened(), since(start));
            if (last && s == 2 && r.end == SettleEnd::settled) result.status = DrapeStatus::converged;
        }
        result.levels.back().seconds += since(start);
        result.seconds.push_back({"settle", since(start)});
        result.barrier = {co.body.distance, co.body.stiffness};
    }
    result.garment = closed;
    result.state.positions = x;
    (void)total_area;
    return result;
}

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_staged.h"

#include "io/garment_obj.h"
#include "io/garment_parts.h"
#include "io/write_file.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <tuple>

namespace toile {
namespace {

std::string formatted(double x) {
    std::ostringstream out;
    out.precision(3);
    out << x;
    return out.str();
}

class Builder {
public:
    Builder(ReadGarment mesh, const std::string& name)
        : name_(name), g_(std::move(mesh.garment)), x_(std::move(mesh.x)), notes_(std::move(mesh.notes)) {}

    StagedMesh build(const ReadStagedOptions& options) {
        check_flat();
        to_metres();
        if (options.body) turn_up(*options.body);
        split_panels();
        check_windings();
        clean_stitches();
        leave_out_collapsing();
        name_seams();
        mark_eased();
        trace_borders();
        return {std::move(g_), std::move(x_), std::move(notes_)};
    }

private:
    [[noreturn]] void refuse(const std::string& what) const { throw InputError(name_ + ": " + what); }

    double flat_area(int t) const { return 0.5 * g_.rest.edges[t].determinant(); }

    void check_flat() const {
        for (int t = 0; t < int(g_.triangles.size()); ++t) {
            const Mat2& e = g_.rest.edges[t];
            if (std::abs(e.determinant()) > 1e-9 * (e.col(0).squaredNorm() + e.col(1).squaredNorm()))
                continue;
            const Vec2& at = g_.uv[g_.triangles[t][0]];
            refuse("triangle " + std::to_string(t) + " near vt (" + formatted(at.x()) + ", " +
                   formatted(at.y()) + ") has no area in the flat");
        }
    }

    /// vt is in metres; v is in the unit that makes the cloth as long in space as it is flat.
    void to_metres() {
        std::vector<double> ratios;
        for (int t = 0; t < int(g_.triangles.size()); ++t) {
            const Triangle n = g_.nodes(t);
            for (int k = 0; k < 2; ++k)
                ratios.push_back((x_[n[k + 1]] - x_[n[0]]).norm() / g_.rest.edges[t].col(k).norm());
        }
        std::nth_element(ratios.begin(), ratios.begin() + ratios.size() / 2, ratios.end());
        const double ratio = ratios[ratios.size() / 2];
        static constexpr std::pair<double, const char*> units[] = {
            {1, "metres"}, {10, "decimetres"}, {100, "centimetres"}, {1000, "millimetres"}};
        for (const auto& [per_metre, unit] : units) {
            if (ratio < per_metre / 2 || ratio > per_metre * 2) continue;
            if (per_metre != 1) notes_.push_back(name_ + " has its positions in " + unit);
            for (Vec3& p : x_)
                p /= per_metre;
            return;
        }
        refuse("its edges in space (v) are " + formatted(ratio) +
               " times as long as in the flat (vt), which fits no unit; " + "vt was expected in metres");
    }

    /// Mean distance of the cloth from the points of the body, of samples of both.
    double distance_from(const TriMesh& body, bool z_up) const {
        const std::size_t cloth_step = 1 + x_.size() / 500, body_step = 1 + body.points.size() / 5000;
        double sum = 0;
        int count = 0;
        for (std::size_t i = 0; i < x_.size(); i += cloth_step, ++count) {
            const Vec3 p = z_up ? Vec3(x_[i].x(), x_[i].z(), -x_[i].y()) : x_[i];
            double nearest = INFINITY;
            for (std::size_t k = 0; k < body.points.size(); k += body_step)
                nearest = std::min(nearest, (body.points[k] - p).squaredNorm());
            sum += std::sqrt(nearest);
        }
        return sum / count;
    }

    void turn_up(const TriMesh& body) {
        if (body.points.empty()) return;
        const double y = distance_from(body, false), z = distance_from(body, true);
        if (y <= z) return;
        for (Vec3& p : x_)
            p = {p.x(), p.z(), -p.y()};
        notes_.push_back(name_ + " has z up: so it starts out " + formatted(100 * z) +
                         " cm from the body on average, and " + formatted(100 * y) + " cm with y up");
    }

    /// Panels are connected pieces of the flat mesh, in the order of their first vertex, called by the file's
    /// group.
    void split_panels() {
        const std::vector<std::string> groups = std::move(g_.panel_names);
        const std::vector<int> piece = pieces(g_.triangles, int(g_.uv.size()));
        std::map<int, int> panel_of_piece;
        for (int p : piece)
            panel_of_piece.try_emplace(p, int(panel_of_piece.size()));
        std::vector<int> group(panel_of_piece.size(), 0);
        for (int v = 0; v < int(g_.uv.size()); ++v) {
            const int panel = panel_of_piece[piece[v]];
            if (piece[v] == v) group[panel] = g_.panel_of_vertex[v];
            g_.panel_of_vertex[v] = panel;
        }
        for (int t = 0; t < int(g_.triangles.size()); ++t)
            g_.panel_of_triangle[t] = g_.panel_of_vertex[g_.triangles[t][0]];
        g_.panel_names.clear();
        std::map<int, int> used, total;
        for (int p : group)
            ++total[p];
        for (int p : group)
            g_.panel_names.push_back(groups[p] + (total[p] > 1 ? "_" + std::to_string(++used[p]) : ""));
        g_.panel_fabrics.assign(group.size(), "");
        g_.panel_layers.assign(group.size(), 0);
    }

    void check_windings() const {
        std::vector<int> sign(g_.panel_names.size(), 0);
        for (int t = 0; t < int(g_.triangles.size()); ++t) {
            int& s = sign[g_.panel_of_triangle[t]];
            const int now = flat_area(t) > 0 ? 1 : -1;
            if (s == 0) s = now;
            if (s == now) continue;
            const Vec2& at = g_.uv[g_.triangles[t][0]];
            refuse("panel \"" + g_.panel_names[g_.panel_of_triangle[t]] +
                   "\" is folded over in the flat near vt (" + formatted(at.x()) + ", " + formatted(at.y()) +
                   "): its triangles run both ways round");
        }
    }

    void clean_stitches() {
        std::vector<Stitch> kept;
        std::set<std::tuple<int, int, int, double>> seen;
        for (Stitch s : g_.stitches) {
            if (!(s.r >= 0 && s.r <= 1))
                refuse("a stitch of node " + std::to_string(s.a) + " has r " + formatted(s.r) +
                       "; 0 to 1 was expected");
            if (s.r == 0) s.b[1] = s.b[0];
            if (s.r == 1) s.b[0] = s.b[1], s.r = 0;
            if (s.b[0] == s.b[1]) s.r = 0;
            if (s.a == s.b[0] && s.a == s.b[1]) continue;
            if (s.a == s.b[0] || s.a == s.b[1])
                refuse("a stitch joins node " + std::to_string(s.a) + " to an edge that ends in it");
            // The same pair of nodes may be named from either side.
            const bool point = s.b[0] == s.b[1];
            const auto key = point ? std::tuple(std::min(s.a, s.b[0]), std::max(s.a, s.b[0]), -1, 0.0)
                                   : std::tuple(s.a, s.b[0], s.b[1], s.r);
            if (seen.insert(key).second) kept.push_back(s);
        }
        g_.stitches = std::move(kept);
    }

    /// A stitch that would join two corners of a triangle, by itself or with those before it, is left out.
    void leave_out_collapsing() {
        std::vector<std::set<int>> beside(g_.node_count); // nodes that share a triangle
        for (int t = 0; t < int(g_.triangles.size()); ++t)
            for (int a : g_.nodes(t))
                for (int b : g_.nodes(t))
                    if (a != b) beside[a].insert(b);
        std::vector<int> group(g_.node_count);
        std::vector<std::vector<int>> members(g_.node_count);
        for (int i = 0; i < g_.node_count; ++i) {
            group[i] = i;
            members[i] = {i};
        }
        const auto joins_neighbours = [&](int a, int b) {
            for (int i : members[a])
                for (int k : beside[i])
                    if (group[k] == b) return true;
            return false;
        };
        const auto out = [&](const Stitch& s) {
            if (s.r != 0) return false;
            const int a = group[s.a], b = group[s.b[0]];
            if (a == b) return false;
            if (joins_neighbours(a, b)) {
                notes_.push_back(name_ + ": the stitch of nodes " + std::to_string(s.a) + " and " +
                                 std::to_string(s.b[0]) +
                                 " was left out, it would join two corners of a triangle");
                return true;
            }
            for (int i : members[b])
                group[i] = a;
            members[a].insert(members[a].end(), members[b].begin(), members[b].end());
            return false;
        };
        std::erase_if(g_.stitches, out);
    }

    /// A vertex of every node. Nodes of closed seams have several; the first one serves.
    std::vector<int> vertex_of_node() const {
        std::vector<int> vertex(g_.node_count, -1);
        for (int v = int(g_.uv.size()) - 1; v >= 0; --v)
            vertex[g_.node_of_vertex[v]] = v;
        return vertex;
    }

    bool border(int e) const { return g_.edges.triangles_at(e) == 1; }

    /// A seam is what joins one pair of panels; a stitch stands for half of every stitched border edge at its
    /// node.
    void name_seams() {
        const std::vector<int> vertex = vertex_of_node();
        const auto panel = [&](int node) { return g_.panel_of_vertex[vertex[node]]; };
        std::map<std::pair<int, int>, int> number;
        std::vector<int> count(g_.node_count, 0);
        for (Stitch& s : g_.stitches) {
            const std::pair<int, int> pair = std::minmax(panel(s.a), panel(s.b[0]));
            s.seam = number.try_emplace(pair, int(number.size())).first->second;
            ++count[s.a];
        }
        std::vector<double> half(g_.node_count, 0);
        for (int e = 0; e < g_.edges.size(); ++e) {
            const auto [a, b] = g_.edges.ends[e];
            if (!g_.seam_edge[e] || !border(e)) continue;
            const double length = flat_length(e);
            half[a] += length / 2;
            half[b] += length / 2;
        }
        for (Stitch& s : g_.stitches)
            s.length = half[s.a] / count[s.a];
    }

    /// Length of edge e in its first triangle's flat.
    double flat_length(int e) const {
        const int t = g_.edges.incident[g_.edges.first[e]];
        Vec2 at[2];
        for (int v : g_.triangles[t])
            for (int k = 0; k < 2; ++k)
                if (g_.node_of_vertex[v] == g_.edges.ends[e][k]) at[k] = g_.uv[v];
        return (at[1] - at[0]).norm();
    }

    /// An open seam is eased where a border edge is sewn to a stretch of another length.
    void mark_eased() {
        constexpr double eased = 0.02;
        const std::vector<int> vertex = vertex_of_node();
        std::vector<std::vector<int>> at(g_.node_count);
        for (int s = 0; s < int(g_.stitches.size()); ++s)
            at[g_.stitches[s].a].push_back(s);
        const auto target = [&](const Stitch& s) -> Vec2 {
            return (1 - s.r) * g_.uv[vertex[s.b[0]]] + s.r * g_.uv[vertex[s.b[1]]];
        };
        std::vector<bool> node_eased(g_.node_count, false);
        for (int e = 0; e < g_.edges.size(); ++e) {
            if (!border(e)) continue;
            const auto [n0, n1] = g_.edges.ends[e];
            for (int i : at[n0])
                for (int k : at[n1]) {
                    const Stitch &s = g_.stitches[i], &u = g_.stitches[k];
                    if (s.seam != u.seam) continue;
                    const double here = flat_length(e), there = (target(s) - target(u)).norm();
                    if (std::max(here, there) <= (1 + eased) * std::min(here, there)) continue;
                    for (int n : {n0, n1, s.b[0], s.b[1], u.b[0], u.b[1]})
                        node_eased[n] = true;
                }
        }
        for (int t = 0; t < int(g_.triangles.size()); ++t)
            for (int n : g_.nodes(t))
                if (node_eased[n]) g_.eased_triangle[t] = true;
    }

    /// One line per border loop of every panel, over vertices, the first one repeated at the end.
    void trace_borders() {
        std::map<std::array<int, 2>, int> inside; // directed edges of triangles
        for (const Triangle& t : g_.triangles)
            for (int k = 0; k < 3; ++k)
                ++inside[{t[k], t[(k + 1) % 3]}];
        std::map<int, std::vector<int>> next;
        for (const auto& [edge, count] : inside)
            if (!inside.count({edge[1], edge[0]})) next[edge[0]].push_back(edge[1]);
        std::vector<int> loops(g_.panel_names.size(), 0);
        while (!next.empty()) {
            BorderLine line;
            int v = next.begin()->first;
            line.panel = g_.panel_of_vertex[v];
            line.edge = loops[line.panel]++;
            line.vertices.push_back(v);
            for (auto at = next.find(v); at != next.end(); at = next.find(v)) {
                v = at->second.back();
                at->second.pop_back();
                if (at->second.empty()) next.erase(at);
                line.vertices.push_back(v);
            }
            g_.borders.push_back(std::move(line));
        }
        std::stable_sort(g_.borders.begin(), g_.borders.end(), [](const BorderLine& a, const BorderLine& b) {
            return std::tie(a.panel, a.edge) < std::tie(b.panel, b.edge);
        });
    }

    const std::string& name_;
    Garment g_;
    Points x_;
    std::vector<std::string> notes_;
};

} // namespace

StagedMesh read_staged(const std::string& path, const ReadStagedOptions& options) {
    GarmentParts parts = parse_garment_obj(read_file(path, options.max_bytes), path);
    if (!parts.uv_metres) parts.uv_metres = 1;
    ReadGarment mesh = assemble(std::move(parts), path);
    if (!mesh.flat)
        throw InputError(path + " has triangles without vt; the flat pattern in metres was expected there");
    return Builder(std::move(mesh), path).build(options);
}

} // namespace toile

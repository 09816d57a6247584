// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_rest_mesh.h"

#include "geometry/edges.h"
#include "geometry/text.h"
#include "io/read_garment.h"
#include "sewing/mesh_grain.h"

#include <algorithm>
#include <set>

namespace toile {
namespace {

constexpr double no_area = 1e-12; // of the square of a triangle's longest edge

class Reader {
public:
    Reader(const std::string& path, const RestMeshOptions& options)
        : path_(path), options_(options), read_(read_garment(path)) {
        out_.file = path;
        out_.mesh.points = read_.x;
        out_.mesh.triangles = node_triangles(read_.garment);
    }

    RestMesh read() {
        refuse_flat_triangles();
        find_borders();
        if (count_pieces(out_.mesh.triangles, int(out_.mesh.points.size())) > 1)
            throw InputError(path_ + ": the mesh has several pieces; one was expected, every panel having a mesh of its own");
        for (int e = 0; e < int(options_.edges.size()); ++e) out_.edges.push_back(walk(e));
        lay_grain();
        lay_flat();
        return std::move(out_);
    }

private:
    int number(int point) const { return read_.file_node[point] + 1; }

    void refuse_flat_triangles() const {
        for (const Triangle& t : out_.mesh.triangles) {
            const Points& x = out_.mesh.points;
            const Vec3 a = x[t[1]] - x[t[0]], b = x[t[2]] - x[t[0]];
            const double longest = std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
            if (!(a.cross(b).norm() > no_area * longest))
                throw InputError(text("%s: the triangle of points %d, %d and %d has no area", path_.c_str(), number(t[0]),
                                      number(t[1]), number(t[2])));
        }
    }

    /// next_[p]: where the border runs from p; -1: not on a border.
    void find_borders() {
        const auto& triangles = out_.mesh.triangles;
        const EdgeTable edges = make_edges(triangles, int(out_.mesh.points.size()));
        next_.assign(out_.mesh.points.size(), -1);
        std::set<std::array<int, 2>> walked;
        for (const Triangle& t : triangles)
            for (int k = 0; k < 3; ++k) {
                const int a = t[k], b = t[(k + 1) % 3], count = edges.triangles_at(edge_between(edges, a, b));
                if (count > 2)
                    throw InputError(text("%s: the edge of points %d and %d has %d triangles; one or two were expected", path_.c_str(),
                                          number(a), number(b), count));
                if (!walked.insert({a, b}).second)
                    throw InputError(text("%s: both triangles at the edge of points %d and %d run along it in the same direction; "
                                          "expected the right side of the cloth to be on the same side of both",
                                          path_.c_str(), number(a), number(b)));
                if (count == 2) continue;
                if (next_[a] >= 0)
                    throw InputError(text("%s: borders meet in point %d; a border was expected to run through a point once",
                                          path_.c_str(), number(a)));
                next_[a] = b;
            }
    }

    int border_point(int e, int number_in_file) const {
        const std::string edge = text("%s: edge %d", path_.c_str(), e);
        const auto at = std::find(read_.file_node.begin(), read_.file_node.end(), number_in_file - 1);
        if (at == read_.file_node.end())
            throw InputError(edge + text(" names point %d, which no triangle has", number_in_file));
        const int point = int(at - read_.file_node.begin());
        if (std::all_of(next_.begin(), next_.end(), [](int n) { return n < 0; }))
            throw InputError(edge + " cannot be found, since the mesh is closed; a mesh with a border was expected");
        if (next_[point] < 0)
            throw InputError(edge + text(" names point %d, which lies inside; a point of the border was expected", number_in_file));
        return point;
    }

    std::vector<int> walk(int e) {
        const auto [from, to] = options_.edges[e];
        const int last = border_point(e, to);
        std::vector<int> line{border_point(e, from)};
        do {
            const int here = line.back(), there = next_[here];
            if (there == line.front() && there != last)
                throw InputError(text("%s: edge %d starts at point %d, and the border comes back there without passing point %d",
                                      path_.c_str(), e, from, to));
            if (!taken_.insert(here).second)
                throw InputError(text("%s: edge %d takes the border from point %d to %d, which an edge before it has; a part of the "
                                      "border can belong to one edge",
                                      path_.c_str(), e, number(here), number(there)));
            line.push_back(there);
        } while (line.back() != last);
        return line;
    }

    void lay_grain() {
        const Garment& g = read_.garment;
        const Points& x = out_.mesh.points;
        out_.warp.assign(g.triangles.size(), options_.warp.norm() > 0 ? options_.warp : Vec3::UnitY());
        if (options_.warp.norm() > 0 || !read_.flat) return;
        for (int t = 0; t < int(g.triangles.size()); ++t) {
            const Triangle n = g.nodes(t), &v = g.triangles[t];
            const Vec3 along = flat_warp(x[n[1]] - x[n[0]], x[n[2]] - x[n[0]], g.uv[v[1]] - g.uv[v[0]], g.uv[v[2]] - g.uv[v[0]]);
            if (along.norm() > 0) out_.warp[t] = along;
        }
    }

    /// Texture coordinates where every point has one pair of them; else seen along the axis in which the mesh is thinnest.
    void lay_flat() {
        const Garment& g = read_.garment;
        out_.flat.assign(out_.mesh.points.size(), Vec2::Zero());
        if (read_.flat && g.uv.size() == out_.flat.size()) {
            for (std::size_t v = 0; v < g.uv.size(); ++v) out_.flat[g.node_of_vertex[v]] = g.uv[v];
            return;
        }
        Vec3 low = out_.mesh.points[0], high = low;
        for (const Vec3& p : out_.mesh.points) low = low.cwiseMin(p), high = high.cwiseMax(p);
        Eigen::Index thin = 0;
        (high - low).minCoeff(&thin);
        for (std::size_t i = 0; i < out_.flat.size(); ++i) {
            const Vec3& p = out_.mesh.points[i];
            out_.flat[i] = thin == 0 ? Vec2(p.z(), p.y()) : thin == 1 ? Vec2(p.x(), p.z()) : Vec2(p.x(), p.y());
        }
    }

    std::string path_;
    const RestMeshOptions& options_;
    ReadGarment read_;
    RestMesh out_;
    std::vector<int> next_;
    std::set<int> taken_; ///< points from which a walked edge runs on
};

} // namespace

RestMesh read_rest_mesh(const std::string& path, const RestMeshOptions& options) { return Reader(path, options).read(); }

} // namespace toile

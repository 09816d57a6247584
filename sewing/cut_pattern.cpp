// SPDX-License-Identifier: GPL-3.0-or-later
#include "sewing/cut_pattern.h"

#include "geometry/disjoint_sets.h"
#include "geometry/distance.h"
#include "geometry/edges.h"
#include "patterns/curve.h"

#include <Eigen/LU>
#include <Eigen/SVD>

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace toile {

namespace {

constexpr double clear = 0.02; // m from the cloth's place outward to where its panel starts out

std::array<int, 2> key(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

int nearest_triangle(const TriMesh& mesh, const Vec3& p) {
    double best = std::numeric_limits<double>::infinity();
    int at = -1;
    for (int t = 0; t < int(mesh.triangles.size()); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        const double squared = nearest_point_triangle(p, mesh.points[a], mesh.points[b], mesh.points[c]).squared;
        if (squared < best) best = squared, at = t;
    }
    return at;
}

/// Triangles joined over edges of no line; and corners of triangles, 3 t + k, that stay one point when cut.
struct Parting {
    DisjointSets triangles, corners;
};

Parting part(const LinedMesh& surface) {
    const TriMesh& mesh = surface.mesh();
    const EdgeTable edges = make_edges(mesh.triangles, int(mesh.points.size()));
    Parting parting{DisjointSets(int(mesh.triangles.size())), DisjointSets(3 * int(mesh.triangles.size()))};
    const auto corner = [&](int t, int point) {
        const Triangle& n = mesh.triangles[t];
        return 3 * t + int(std::find(n.begin(), n.end(), point) - n.begin());
    };
    for (int e = 0; e < edges.size(); ++e) {
        if (edges.triangles_at(e) != 2 || surface.lines().count(edges.ends[e])) continue;
        const int s = edges.incident[edges.first[e]], t = edges.incident[edges.first[e] + 1];
        parting.triangles.join(s, t);
        for (const int point : edges.ends[e]) parting.corners.join(corner(s, point), corner(t, point));
    }
    return parting;
}

CutPiece take(const LinedMesh& surface, Parting& parting, int set, const std::string& name) {
    CutPiece piece{name, {}, {}, {}};
    std::map<int, int> number; // of a set of corners
    const TriMesh& mesh = surface.mesh();
    for (int t = 0; t < int(mesh.triangles.size()); ++t) {
        if (parting.triangles.find(t) != set) continue;
        Triangle& own = piece.mesh.triangles.emplace_back();
        for (int k = 0; k < 3; ++k) {
            const auto [at, fresh] = number.try_emplace(parting.corners.find(3 * t + k), int(piece.source.size()));
            own[k] = at->second;
            if (!fresh) continue;
            piece.source.push_back(mesh.triangles[t][k]);
            piece.mesh.points.push_back(mesh.points[mesh.triangles[t][k]]);
        }
    }
    return piece;
}

void lay_flat(std::vector<CutPiece>& pieces, const FlattenOptions& options) {
    std::vector<TriMesh> meshes;
    std::vector<SewnEdges> sewn;
    std::map<std::array<int, 2>, SewnEdges> open; // by an edge's points of the surface: its first side
    for (int p = 0; p < int(pieces.size()); ++p) {
        meshes.push_back(pieces[p].mesh);
        const std::vector<int> border = border_loop(pieces[p].mesh);
        for (std::size_t k = 0; k < border.size(); ++k) {
            const std::array<int, 2> edge{border[k], border[(k + 1) % border.size()]};
            const auto [at, fresh] = open.try_emplace(key(pieces[p].source[edge[0]], pieces[p].source[edge[1]]), SewnEdges{{p, p}, {edge, edge}});
            if (!fresh) sewn.push_back({{at->second.piece[0], p}, {at->second.points[0], edge}});
        }
    }
    const std::vector<Flattened> flat = flatten(meshes, sewn, options);
    for (std::size_t p = 0; p < pieces.size(); ++p) pieces[p].flat = flat[p];
}

/// A stretch of a piece's border between places where lines meet or end.
struct Chain {
    int panel = 0;
    std::vector<int> points; ///< of the piece
    int line = -1;           ///< -1: the border of the surface
    int other = -1;          ///< the chain that it was one with, which runs against it
    std::vector<int> parts;  ///< where it is divided, as indices into points
};

class Drawing {
public:
    Drawing(const LinedMesh& surface, const std::vector<CutPiece>& pieces, double fit)
        : surface_(surface), pieces_(pieces), fit_(fit) {
        for (const auto& [ends, line] : surface.lines())
            for (const int p : ends) lines_at_[p].push_back(line);
        for (int p = 0; p < int(pieces.size()); ++p) add_chains(p);
        find_others();
        for (Chain& c : chains_) divide(c);
    }

    Pattern pattern(const std::vector<std::string>& lines) const {
        Pattern out;
        std::vector<int> first_edge; // of each chain in its panel
        for (const CutPiece& piece : pieces_) {
            Panel& panel = out.panels.emplace_back();
            panel.name = piece.name;
            place(piece, panel);
        }
        for (const Chain& c : chains_) {
            Loop& outline = out.panels[c.panel].outline;
            first_edge.push_back(int(outline.size()));
            for (std::size_t k = 0; k + 1 < c.parts.size(); ++k) {
                outline.push_back(fitted(c, c.parts[k], c.parts[k + 1]).edge);
                outline.back().label = c.other < 0 && c.line >= 0 ? lines[c.line] : "";
            }
        }
        for (int i = 0; i < int(chains_.size()); ++i) {
            const int j = chains_[i].other, parts = int(chains_[i].parts.size()) - 1;
            for (int k = 0; i < j && k < parts; ++k) {
                Seam seam;
                seam.a = {{chains_[i].panel, first_edge[i] + k, 0, 1}};
                seam.b = {{chains_[j].panel, first_edge[j] + parts - 1 - k, 1, 0}};
                seam.name = lines[chains_[i].line];
                out.seams.push_back(seam);
            }
        }
        return out;
    }

private:
    struct Fit {
        Edge edge;
        double off = 0; ///< m, farthest point of the border from its place on the curve, or what their lengths differ by
    };

    const Vec2& flat(const Chain& c, int k) const { return pieces_[c.panel].flat.points[c.points[k]]; }
    int source(const Chain& c, int k) const { return pieces_[c.panel].source[c.points[k]]; }

    int line_of(int a, int b) const {
        const auto at = surface_.lines().find(key(a, b));
        return at == surface_.lines().end() ? -1 : at->second;
    }

    /// Whether a chain ends at a point of the surface.
    bool is_end(int point) const {
        const auto at = lines_at_.find(point);
        if (at == lines_at_.end()) return false;
        return at->second.size() != 2 || at->second[0] != at->second[1];
    }

    void add_chains(int panel) {
        const CutPiece& piece = pieces_[panel];
        std::vector<int> loop = border_loop(piece.mesh);
        const auto at = [&](std::size_t k) { return piece.source[loop[k % loop.size()]]; };
        const auto breaks = [&](std::size_t k) {
            return is_end(at(k)) || line_of(at(k), at(k + 1)) != line_of(at(k + loop.size() - 1), at(k));
        };
        std::size_t start = 0;
        while (start < loop.size() && !breaks(start)) ++start;
        if (start == loop.size()) { // one line all round: both of its sides begin at the same point of the surface
            start = 0;
            for (std::size_t k = 1; k < loop.size(); ++k)
                if (at(k) < at(start)) start = k;
        }
        for (std::size_t k = start; k < start + loop.size(); ++k) {
            if (k == start || breaks(k)) chains_.push_back({panel, {loop[k % loop.size()]}, line_of(at(k), at(k + 1)), -1, {}});
            chains_.back().points.push_back(loop[(k + 1) % loop.size()]);
        }
    }

    void find_others() {
        std::map<std::array<int, 2>, int> begins; // by the first edge of a chain, as the surface has it
        for (int i = 0; i < int(chains_.size()); ++i) {
            const Chain& c = chains_[i];
            if (c.line >= 0) begins[{source(c, 0), source(c, 1)}] = i;
        }
        for (int i = 0; i < int(chains_.size()); ++i) {
            const Chain& c = chains_[i];
            const int last = int(c.points.size()) - 1;
            const auto at = begins.find({source(c, last), source(c, last - 1)});
            if (at != begins.end() && at->second != i) chains_[i].other = at->second;
        }
    }

    /// The least squares cubic through the ends of part of a chain, by fractions of the border's length.
    Fit fitted(const Chain& c, int from, int to) const {
        std::vector<double> at{0};
        for (int k = from + 1; k <= to; ++k) at.push_back(at.back() + (flat(c, k) - flat(c, k - 1)).norm());
        const Vec2 a = flat(c, from), d = flat(c, to);
        Mat2 normal = Mat2::Zero(), right = Mat2::Zero();
        const auto outer = [&](double t) -> Vec2 { return (1 - t) * (1 - t) * (1 - t) * a + t * t * t * d; };
        const auto weights = [](double t) { return Vec2(3 * t * (1 - t) * (1 - t), 3 * t * t * (1 - t)); };
        for (int k = from + 1; k < to; ++k) {
            const double t = at[k - from] / at.back();
            normal += weights(t) * weights(t).transpose();
            right += weights(t) * (flat(c, k) - outer(t)).transpose();
        }
        Fit fit{{a, d, Straight{}, {}}, 0};
        if (to - from < 3) { // too few points for a curve
            for (int k = from + 1; k < to; ++k) {
                const double s = at[k - from] / at.back();
                fit.off = std::max(fit.off, ((1 - s) * a + s * d - flat(c, k)).norm());
            }
            return fit;
        }
        const Mat2 control = normal.inverse() * right;
        fit.edge.curve = Cubic{control.row(0).transpose(), control.row(1).transpose()};
        for (int k = from + 1; k < to; ++k) {
            const double t = at[k - from] / at.back();
            fit.off = std::max(fit.off, (outer(t) + control.transpose() * weights(t) - flat(c, k)).norm());
        }
        fit.off = std::max(fit.off, std::abs(length(fit.edge) - at.back())); // between few points a cubic may wind
        return fit;
    }

    /// Both sides of a seam are divided at the same points, into as few parts as the fit allows.
    void divide(Chain& c) {
        if (!c.parts.empty()) return;
        Chain* other = c.other >= 0 ? &chains_[c.other] : nullptr;
        const int n = int(c.points.size()) - 1;
        for (int count = 1;; ++count) {
            c.parts.clear();
            for (int k = 0; k <= count; ++k) c.parts.push_back(int(std::int64_t(n) * k / count));
            if (other) {
                other->parts.clear();
                for (int k = count; k >= 0; --k) other->parts.push_back(n - c.parts[k]);
            }
            double off = 0;
            for (int k = 0; k < count; ++k) {
                off = std::max(off, fitted(c, c.parts[k], c.parts[k + 1]).off);
                if (other) off = std::max(off, fitted(*other, other->parts[k], other->parts[k + 1]).off);
            }
            const bool closed = c.points.front() == c.points.back(); // an edge does not end where it starts
            if ((off <= fit_ && (count > 2 || !closed)) || count == n) return;
        }
    }

    /// The motion of the plane that comes nearest to the surface, then straight out until it is clear of it.
    static void place(const CutPiece& piece, Panel& panel) {
        const std::vector<Vec2>& flat = piece.flat.points;
        Vec2 middle = Vec2::Zero();
        Vec3 centre = Vec3::Zero();
        for (std::size_t i = 0; i < flat.size(); ++i) middle += flat[i] / double(flat.size()), centre += piece.mesh.points[i] / double(flat.size());
        Eigen::Matrix<double, 3, 2> spread = Eigen::Matrix<double, 3, 2>::Zero();
        for (std::size_t i = 0; i < flat.size(); ++i) spread += (piece.mesh.points[i] - centre) * (flat[i] - middle).transpose();
        const Eigen::JacobiSVD<Eigen::Matrix<double, 3, 2>> svd(spread, Eigen::ComputeFullU | Eigen::ComputeFullV);
        const Eigen::Matrix<double, 3, 2> axes = svd.matrixU().leftCols<2>() * svd.matrixV().transpose();
        panel.placement.rotation << axes, axes.col(0).cross(axes.col(1));
        const Vec3 out = panel.placement.rotation.col(2);
        double highest = 0;
        for (const Vec3& p : piece.mesh.points) highest = std::max(highest, out.dot(p - centre));
        panel.placement.translation = centre + (highest + clear) * out - axes * middle;
    }

    const LinedMesh& surface_;
    const std::vector<CutPiece>& pieces_;
    double fit_;
    std::map<int, std::vector<int>> lines_at_; ///< by point, the lines of its edges
    std::vector<Chain> chains_;
};

} // namespace

std::vector<CutPiece> cut_out(const LinedMesh& surface, const std::vector<WantedPiece>& wanted, const FlattenOptions& options) {
    Parting parting = part(surface);
    std::map<int, std::string> taken;
    std::vector<CutPiece> pieces;
    for (const WantedPiece& w : wanted) {
        const int set = parting.triangles.find(nearest_triangle(surface.mesh(), w.inside));
        const auto [other, fresh] = taken.emplace(set, w.name);
        if (!fresh)
            throw std::invalid_argument("panels \"" + other->second + "\" and \"" + w.name +
                                        "\" lie in one piece: the lines do not part them");
        pieces.push_back(take(surface, parting, set, w.name));
        try {
            expect_disc(pieces.back().mesh);
        } catch (const std::invalid_argument& error) {
            throw std::invalid_argument("panel \"" + w.name + "\" cannot be flattened: " + error.what() +
                                        "; a piece with one border was expected, which a further line can make of it");
        }
    }
    lay_flat(pieces, options);
    return pieces;
}

Pattern pattern_of(const LinedMesh& surface, const std::vector<CutPiece>& pieces, const std::vector<std::string>& lines, double fit) {
    return Drawing(surface, pieces, fit).pattern(lines);
}

} // namespace toile

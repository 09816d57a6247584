// SPDX-License-Identifier: GPL-3.0-or-later
#include "patterns/open_cuts.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace toile {
namespace {

struct Corner {
    int triangle, k; // corner k of a triangle
};

/// Corners at one point as pieces of cloth: connected across edges that are not cut. The first piece is the
/// one on the left of a cut.
std::vector<std::vector<Corner>> pieces_at(const PlanarMesh& mesh, const std::vector<Corner>& corners,
                                           const std::vector<std::array<bool, 3>>& cut,
                                           const std::vector<std::array<bool, 3>>& left) {
    std::vector<int> piece(corners.size(), -1);
    std::vector<std::vector<Corner>> out;
    for (std::size_t first = 0; first < corners.size(); ++first) {
        if (piece[first] >= 0) continue;
        std::vector<std::size_t> stack{first};
        piece[first] = int(out.size());
        out.emplace_back();
        bool on_left = false;
        while (!stack.empty()) {
            const auto [t, k] = corners[stack.back()];
            stack.pop_back();
            out.back().push_back({t, k});
            for (int e : {(k + 1) % 3, (k + 2) % 3}) { // the edges that meet in the corner
                on_left = on_left || left[t][e];
                if (cut[t][e]) continue;
                for (std::size_t c = 0; c < corners.size(); ++c)
                    if (corners[c].triangle == mesh.across[t][e] && piece[c] < 0) {
                        piece[c] = piece[first];
                        stack.push_back(c);
                    }
            }
        }
        if (on_left) std::swap(out.front(), out.back());
    }
    return out;
}

} // namespace

std::vector<int> open_cuts(PlanarMesh& mesh, const std::vector<std::array<int, 2>>& cuts) {
    std::vector<int> original(mesh.points.size());
    std::iota(original.begin(), original.end(), 0);
    std::vector<std::array<int, 2>> sorted = cuts;
    std::sort(sorted.begin(), sorted.end());
    std::vector<std::array<bool, 3>> cut(mesh.triangles.size()), left(mesh.triangles.size());
    std::map<int, std::vector<Corner>> corners_at;
    for (const auto& [a, b] : cuts)
        corners_at[a], corners_at[b];
    for (int t = 0; t < int(mesh.triangles.size()); ++t)
        for (int k = 0; k < 3; ++k) {
            const int a = mesh.triangles[t][(k + 1) % 3], b = mesh.triangles[t][(k + 2) % 3];
            left[t][k] = std::binary_search(sorted.begin(), sorted.end(), std::array{a, b});
            cut[t][k] = left[t][k] || std::binary_search(sorted.begin(), sorted.end(), std::array{b, a});
            const auto at = corners_at.find(mesh.triangles[t][k]);
            if (at != corners_at.end()) at->second.push_back({t, k});
        }
    for (const auto& [point, corners] : corners_at) {
        const std::vector<std::vector<Corner>> pieces = pieces_at(mesh, corners, cut, left);
        for (std::size_t p = 1; p < pieces.size(); ++p) {
            const int copy = int(mesh.points.size());
            mesh.points.push_back(mesh.points[point]);
            original.push_back(point);
            for (const Corner& c : pieces[p])
                mesh.triangles[c.triangle][c.k] = copy;
        }
    }
    return original;
}

} // namespace toile

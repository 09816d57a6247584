// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/sheet.h"

#include "geometry/parallel.h"

#include <algorithm>
#include <span>

namespace toile {

namespace {

// The nodes an element couples: those of its patch and, where a border gives the patch fewer, of its compact
// bending.
std::span<const int> nodes_of(const StretchElement& e) { return {e.patch.nodes.data(), std::size_t(e.patch.count)}; }
std::span<const int> nodes_of(const HingeBend& e) { return e.nodes; }
std::span<const int> nodes_of(const RestCurvature& e) { return e.nodes; }

Eigen::SparseMatrix<double> compact_matrix(const Bending& bending) {
    std::vector<Eigen::Triplet<double>> entries;
    for (const BendElement& e : bending.compact)
        for (int i = 0; i < e.count; ++i)
            for (int j = 0; j < e.count; ++j) entries.emplace_back(e.nodes[i], e.nodes[j], e.stiffness(i, j));
    Eigen::SparseMatrix<double> k(bending.stiffness.rows(), bending.stiffness.cols());
    k.setFromTriplets(entries.begin(), entries.end());
    return k;
}

/// Triangles that follow each other lie near each other: they are added together, or the matrix would be read and
/// written all over for every single one.
constexpr int cluster = 32;

int cluster_end(const Sheet& sheet, int c) { return std::min((c + 1) * cluster, int(sheet.stretch.size())); }

void colour(Sheet& sheet) {
    const int clusters = (int(sheet.stretch.size()) + cluster - 1) / cluster;
    std::vector<std::vector<char>> taken; // taken[colour][node]
    std::vector<int> colour_of(clusters);
    for (int k = 0; k < clusters; ++k) {
        const auto all_nodes = [&](auto&& holds) {
            for (int t = k * cluster; t < cluster_end(sheet, k); ++t) {
                for (const int i : nodes_of(sheet.stretch[t]))
                    if (!holds(i)) return false;
            }
            return true;
        };
        std::size_t c = 0;
        while (c < taken.size() && !all_nodes([&](int i) { return !taken[c][i]; })) ++c;
        if (c == taken.size()) taken.emplace_back(sheet.bending.stiffness.rows(), 0);
        all_nodes([&](int i) { return taken[c][i] = 1; });
        colour_of[k] = int(c);
    }
    sheet.colours.assign(taken.size() + 1, 0);
    for (int c : colour_of) ++sheet.colours[c + 1];
    for (std::size_t c = 0; c < taken.size(); ++c) sheet.colours[c + 1] += sheet.colours[c];
    sheet.clusters.resize(clusters);
    std::vector<int> next(sheet.colours.begin(), sheet.colours.end() - 1);
    for (int k = 0; k < clusters; ++k) sheet.clusters[next[colour_of[k]]++] = k;
}

template <class F> void for_elements(const Sheet& sheet, F&& f) {
    for (std::size_t c = 0; c + 1 < sheet.colours.size(); ++c) {
        const int first = sheet.colours[c];
        parallel_for(sheet.colours[c + 1] - first, 1, [&](int begin, int end) {
            for (int k = first + begin; k < first + end; ++k)
                for (int t = sheet.clusters[k] * cluster; t < cluster_end(sheet, sheet.clusters[k]); ++t) f(t);
        });
    }
}

template <class Element> bool acts_on(const Element& e, const std::vector<char>& moving) {
    const std::span<const int> nodes = nodes_of(e);
    return std::any_of(nodes.begin(), nodes.end(), [&](int i) { return moving[i]; });
}

Eigen::SparseMatrix<double> part_of(const Eigen::SparseMatrix<double>& k, const std::vector<int>& local, int nodes) {
    std::vector<Eigen::Triplet<double>> entries;
    for (int j = 0; j < k.outerSize(); ++j)
        for (Eigen::SparseMatrix<double>::InnerIterator entry(k, j); local[j] >= 0 && entry; ++entry)
            if (local[entry.row()] >= 0) entries.emplace_back(local[entry.row()], local[j], entry.value());
    Eigen::SparseMatrix<double> part(nodes, nodes);
    part.setFromTriplets(entries.begin(), entries.end());
    return part;
}

} // namespace

Sheet make_sheet(const Garment& garment, const std::vector<Fabric>& fabrics) {
    Sheet sheet;
    sheet.stretch = make_stretch(garment, fabrics);
    sheet.bending = make_bending(garment, fabrics);
    sheet.creases = make_creases(garment, fabrics);
    sheet.curved = make_rest_curvature(garment, fabrics);
    sheet.limits = make_strain_limits(garment, fabrics);
    // One list of nodes per element: the patch's, and the compact bending's after them.
    for (std::size_t t = 0; t < sheet.stretch.size(); ++t) {
        Patch& patch = sheet.stretch[t].patch;
        const BendElement& bend = sheet.bending.compact[t];
        for (int k = 0; k < bend.count; ++k) {
            const auto end = patch.nodes.begin() + patch.count;
            if (patch.count < Patch::max_nodes && std::find(patch.nodes.begin(), end, bend.nodes[k]) == end)
                patch.nodes[patch.count++] = bend.nodes[k];
        }
        auto& place = sheet.bend_place.emplace_back();
        for (int a = 0; a < Patch::max_nodes; ++a) {
            const auto end = bend.nodes.begin() + bend.count;
            const auto at = std::find(bend.nodes.begin(), end, patch.nodes[a]);
            place[a] = a < patch.count && at != end ? int(at - bend.nodes.begin()) : -1;
        }
    }
    sheet.beyond_compact = sheet.bending.stiffness - compact_matrix(sheet.bending);
    colour(sheet);
    return sheet;
}

std::vector<char> coupled_nodes(const Sheet& sheet, const std::vector<char>& moving) {
    std::vector<char> coupled = moving;
    const auto mark = [&](const auto& elements) {
        for (const auto& e : elements)
            if (acts_on(e, moving))
                for (const int i : nodes_of(e)) coupled[i] = 1;
    };
    mark(sheet.stretch);
    mark(sheet.creases);
    mark(sheet.curved);
    const auto& k = sheet.bending.stiffness;
    for (int j = 0; j < k.outerSize(); ++j)
        for (Eigen::SparseMatrix<double>::InnerIterator entry(k, j); moving[j] && entry; ++entry) coupled[entry.row()] = 1;
    return coupled;
}

Sheet part_of(const Sheet& sheet, const std::vector<char>& moving, const std::vector<int>& local, int nodes) {
    Sheet part;
    part.softness = sheet.softness;
    for (std::size_t t = 0; t < sheet.stretch.size(); ++t) {
        if (!acts_on(sheet.stretch[t], moving)) continue;
        part.stretch.push_back(sheet.stretch[t]);
        part.bending.compact.push_back(sheet.bending.compact[t]);
        part.bend_place.push_back(sheet.bend_place[t]);
        if (!sheet.limits.empty()) part.limits.push_back(sheet.limits[t]);
        Patch& patch = part.stretch.back().patch;
        for (int a = 0; a < patch.count; ++a) patch.nodes[a] = local[patch.nodes[a]];
        BendElement& bend = part.bending.compact.back();
        for (int a = 0; a < bend.count; ++a) bend.nodes[a] = local[bend.nodes[a]];
        if (!sheet.limits.empty())
            for (int& i : part.limits.back().nodes) i = local[i];
    }
    for (const HingeBend& crease : sheet.creases) {
        if (!acts_on(crease, moving)) continue;
        part.creases.push_back(crease);
        for (int& i : part.creases.back().nodes) i = local[i];
    }
    for (const RestCurvature& curved : sheet.curved) {
        if (!acts_on(curved, moving)) continue;
        part.curved.push_back(curved);
        for (int& i : part.curved.back().nodes) i = local[i];
    }
    part.bending.stiffness = part_of(sheet.bending.stiffness, local, nodes);
    part.beyond_compact = part_of(sheet.beyond_compact, local, nodes);
    colour(part);
    return part;
}

double sheet_value(const Sheet& sheet, const Points& x) {
    double sum = sheet.softness * stretch_value(sheet.stretch, x) + bend_value(sheet.bending, x) + value(sheet.creases, x);
    if (!sheet.curved.empty()) sum += value(sheet.curved, x);
    if (!sheet.limits.empty()) sum += strain_limit_value(sheet.limits, x);
    return sum;
}

void sheet_gradient(const Sheet& sheet, const Points& x, Points& gradient) {
    if (sheet.softness == 1) {
        stretch_gradient(sheet.stretch, x, gradient);
    } else {
        Points soft(x.size(), Vec3::Zero());
        stretch_gradient(sheet.stretch, x, soft);
        flat(gradient) += sheet.softness * flat(soft);
    }
    bend_gradient(sheet.bending, x, gradient);
    if (!sheet.creases.empty() || !sheet.curved.empty()) {
        Eigen::VectorXd bent = Eigen::VectorXd::Zero(3 * Eigen::Index(x.size()));
        add_gradient(sheet.creases, x, bent);
        add_gradient(sheet.curved, x, bent);
        flat(gradient) += bent;
    }
    if (!sheet.limits.empty()) strain_limit_gradient(sheet.limits, x, gradient);
}

void sheet_couplings(const Sheet& sheet, std::vector<std::pair<int, int>>& pairs) {
    for (int t = 0; t < int(sheet.stretch.size()); ++t) {
        const std::span<const int> node = nodes_of(sheet.stretch[t]);
        for (std::size_t a = 0; a < node.size(); ++a)
            for (std::size_t b = 0; b < a; ++b) pairs.emplace_back(node[a], node[b]);
    }
    couplings(sheet.creases, pairs);
}

void sheet_slots(Sheet& sheet, const BlockMatrix& matrix) {
    sheet.slots.resize(sheet.stretch.size());
    parallel_for(int(sheet.stretch.size()), 256, [&](int begin, int end) {
        for (int t = begin; t < end; ++t) {
            const std::span<const int> node = nodes_of(sheet.stretch[t]);
            for (std::size_t a = 0; a < node.size(); ++a)
                for (std::size_t b = 0; b < a; ++b)
                    sheet.slots[t][a * Patch::max_nodes + b] =
                        matrix.find(std::max(node[a], node[b]), std::min(node[a], node[b]));
        }
    });
}

void sheet_hessian(const Sheet& sheet, const Points& x, HessianKind kind, BlockMatrix& matrix) {
    for_elements(sheet, [&](int t) {
        const StretchCurvature stretch = stretch_curvature(sheet.stretch[t], x, kind);
        const auto& node = sheet.stretch[t].patch.nodes;
        const BendElement& bend = sheet.bending.compact[t];
        const auto& place = sheet.bend_place[t];
        Eigen::Matrix<double, 9, 9> limit;
        const bool limited = !sheet.limits.empty() && strain_limit_hessian(sheet.limits[t], x, kind, limit);
        for (int a = 0; a < stretch.count; ++a)
            for (int b = 0; b <= a; ++b) {
                Mat3 block = sheet.softness * stretch.block(a, b);
                if (place[a] >= 0 && place[b] >= 0)
                    block.diagonal().array() += bend.stiffness(place[a], place[b]);
                if (limited && a < 3) block += limit.block<3, 3>(3 * a, 3 * b);
                if (a == b)
                    matrix.add_diagonal(node[a], block);
                else if (node[a] > node[b])
                    matrix.add_off_diagonal(node[b], sheet.slots[t][a * Patch::max_nodes + b], block);
                else
                    matrix.add_off_diagonal(node[a], sheet.slots[t][a * Patch::max_nodes + b], block.transpose());
            }
    });
    add_hessian(sheet.creases, x, kind, matrix);
}

void sheet_beyond_compact(const Sheet& sheet, const Points& x, const Eigen::VectorXd& v, Eigen::VectorXd& y) {
    const auto& k = sheet.beyond_compact;
    parallel_for(int(k.outerSize()), 512, [&](int begin, int end) {
        for (int i = begin; i < end; ++i)
            for (Eigen::SparseMatrix<double>::InnerIterator entry(k, i); entry; ++entry)
                y.segment<3>(3 * i) += entry.value() * v.segment<3>(3 * entry.index());
    });
    add_product(sheet.curved, x, v, y);
}

void SheetEnergy::add_gradient(const Points& x, Eigen::VectorXd& g) const {
    Points own(x.size(), Vec3::Zero());
    sheet_gradient(sheet, x, own);
    g += flat(own);
}

} // namespace toile

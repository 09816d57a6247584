// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/sheet.h"

#include "geometry/parallel.h"

#include <algorithm>

namespace toile {

namespace {

constexpr int chunk = 64;

// The nodes an element couples: those of its patch and, where a border gives the patch fewer, of its compact
// bending.
struct ElementNodes {
    int count = 0;
    std::array<int, Patch::max_nodes> node{};
};

ElementNodes element_nodes(const Sheet& sheet, int t) {
    const Patch& patch = sheet.stretch[t].patch;
    return {patch.count, patch.nodes};
}

Eigen::SparseMatrix<double> compact_matrix(const Bending& bending) {
    std::vector<Eigen::Triplet<double>> entries;
    for (const BendElement& e : bending.compact)
        for (int i = 0; i < e.count; ++i)
            for (int j = 0; j < e.count; ++j) entries.emplace_back(e.nodes[i], e.nodes[j], e.stiffness(i, j));
    Eigen::SparseMatrix<double> k(bending.stiffness.rows(), bending.stiffness.cols());
    k.setFromTriplets(entries.begin(), entries.end());
    return k;
}

void colour(Sheet& sheet) {
    const int n = int(sheet.stretch.size());
    std::vector<std::vector<char>> taken; // taken[colour][node]
    std::vector<int> colour_of(n);
    for (int t = 0; t < n; ++t) {
        const ElementNodes e = element_nodes(sheet, t);
        const auto free = [&](const std::vector<char>& used) {
            return std::none_of(e.node.begin(), e.node.begin() + e.count, [&](int i) { return used[i]; });
        };
        std::size_t c = 0;
        while (c < taken.size() && !free(taken[c])) ++c;
        if (c == taken.size()) taken.emplace_back(sheet.bending.stiffness.rows(), 0);
        for (int k = 0; k < e.count; ++k) taken[c][e.node[k]] = 1;
        colour_of[t] = int(c);
    }
    sheet.colours.assign(taken.size() + 1, 0);
    for (int c : colour_of) ++sheet.colours[c + 1];
    for (std::size_t c = 0; c < taken.size(); ++c) sheet.colours[c + 1] += sheet.colours[c];
    sheet.order.resize(n);
    std::vector<int> next(sheet.colours.begin(), sheet.colours.end() - 1);
    for (int t = 0; t < n; ++t) sheet.order[next[colour_of[t]]++] = t;
}

template <class F> void for_elements(const Sheet& sheet, F&& f) {
    for (std::size_t c = 0; c + 1 < sheet.colours.size(); ++c) {
        const int first = sheet.colours[c];
        parallel_for(sheet.colours[c + 1] - first, chunk, [&](int begin, int end) {
            for (int k = begin; k < end; ++k) f(sheet.order[first + k]);
        });
    }
}

} // namespace

Sheet make_sheet(const Garment& garment, const std::vector<Fabric>& fabrics) {
    Sheet sheet;
    sheet.stretch = make_stretch(garment, fabrics);
    sheet.bending = make_bending(garment, fabrics);
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
    }
    sheet.beyond_compact = sheet.bending.stiffness - compact_matrix(sheet.bending);
    colour(sheet);
    return sheet;
}

double sheet_value(const Sheet& sheet, const Points& x) {
    double sum = sheet.softness * stretch_value(sheet.stretch, x) + bend_value(sheet.bending, x);
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
    if (!sheet.limits.empty()) strain_limit_gradient(sheet.limits, x, gradient);
}

void sheet_couplings(const Sheet& sheet, std::vector<std::pair<int, int>>& pairs) {
    for (int t = 0; t < int(sheet.stretch.size()); ++t) {
        const ElementNodes e = element_nodes(sheet, t);
        for (int a = 0; a < e.count; ++a)
            for (int b = 0; b < a; ++b) pairs.emplace_back(e.node[a], e.node[b]);
    }
}

void sheet_slots(Sheet& sheet, const BlockMatrix& matrix) {
    sheet.slots.resize(sheet.stretch.size());
    parallel_for(int(sheet.stretch.size()), 256, [&](int begin, int end) {
        for (int t = begin; t < end; ++t) {
            const ElementNodes e = element_nodes(sheet, t);
            for (int a = 0; a < e.count; ++a)
                for (int b = 0; b < e.count; ++b)
                    sheet.slots[t][a * Patch::max_nodes + b] =
                        e.node[a] > e.node[b] ? matrix.find(e.node[a], e.node[b]) : -1;
        }
    });
}

void sheet_hessian(const Sheet& sheet, const Points& x, HessianKind kind, BlockMatrix& matrix) {
    for_elements(sheet, [&](int t) {
        const ElementNodes e = element_nodes(sheet, t);
        StretchHessian h;
        stretch_hessian(sheet.stretch[t], x, kind, h);
        h *= sheet.softness;
        Eigen::Matrix<double, Patch::max_nodes, Patch::max_nodes> scalar;
        scalar.setZero();
        const BendElement& bend = sheet.bending.compact[t];
        std::array<int, BendElement::max_nodes> place{};
        for (int k = 0; k < bend.count; ++k)
            place[k] = int(std::find(e.node.begin(), e.node.begin() + e.count, bend.nodes[k]) - e.node.begin());
        for (int i = 0; i < bend.count; ++i)
            for (int j = 0; j < bend.count; ++j) scalar(place[i], place[j]) += bend.stiffness(i, j);
        Eigen::Matrix<double, 9, 9> limit;
        const bool limited = !sheet.limits.empty() && strain_limit_hessian(sheet.limits[t], x, kind, limit);
        for (int a = 0; a < e.count; ++a)
            for (int b = 0; b < e.count; ++b) {
                if (e.node[a] < e.node[b]) continue;
                Mat3 block = h.block<3, 3>(3 * a, 3 * b);
                block.diagonal().array() += scalar(a, b);
                if (limited && a < 3 && b < 3) block += limit.block<3, 3>(3 * a, 3 * b);
                if (a == b)
                    matrix.add_diagonal(e.node[a], block);
                else
                    matrix.add_off_diagonal(e.node[b], sheet.slots[t][a * Patch::max_nodes + b], block);
            }
    });
}

void sheet_beyond_compact(const Sheet& sheet, const Eigen::VectorXd& v, Eigen::VectorXd& y) {
    const auto& k = sheet.beyond_compact;
    parallel_for(int(k.outerSize()), 512, [&](int begin, int end) {
        for (int i = begin; i < end; ++i)
            for (Eigen::SparseMatrix<double>::InnerIterator entry(k, i); entry; ++entry)
                y.segment<3>(3 * i) += entry.value() * v.segment<3>(3 * entry.index());
    });
}

} // namespace toile

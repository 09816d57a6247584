// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

namespace toile {

/// Indices below a count, joined into sets. The lowest of a set stands for it, whatever the order of the joins.
class DisjointSets {
public:
    explicit DisjointSets(int count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

    int find(int i) {
        while (parent_[i] != i)
            i = parent_[i] = parent_[parent_[i]];
        return i;
    }

    void join(int i, int j) {
        const int a = find(i), b = find(j);
        parent_[std::max(a, b)] = std::min(a, b);
    }

    /// For every index the one that stands for its set.
    std::vector<int> all() {
        for (int i = 0; i < int(parent_.size()); ++i)
            parent_[i] = find(i);
        return parent_;
    }

private:
    std::vector<int> parent_;
};

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The one place that knows the threading library.

#include <functional>

namespace toile {

/// Number of threads that parallel_for may use; 0 means all. Results never depend on it.
void set_threads(int count);
int threads();

/// body(begin, end) over disjoint chunks of [0, n). Chunks have a fixed size, whatever the number of threads,
/// so that a caller who keeps one partial result per chunk and adds them in order gets the same bits always.
void parallel_for(int n, int chunk, const std::function<void(int begin, int end)>& body);

/// Sum of part(begin, end) over the chunks of [0, n), added in the order of the chunks.
double parallel_sum(int n, int chunk, const std::function<double(int begin, int end)>& part);

} // namespace toile

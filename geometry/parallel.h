// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The one place that knows the threading library.

#include <functional>

namespace toile {

/// Number of threads that parallel_for may use; 0 means all. Results never depend on it.
/// Not to be called while a parallel_for is under way.
void set_threads(int count);
int threads();

/// body(begin, end) over disjoint chunks of [0, n). Chunks have a fixed size, whatever the number of threads,
/// so that a caller who keeps one partial result per chunk and adds them in order gets the same bits always.
/// `chunk` is at least 1. An exception thrown by the body is thrown on to the caller. May be nested.
void parallel_for(int n, int chunk, const std::function<void(int begin, int end)>& body);

/// Both, at once where there is a thread for it. What either throws is thrown on to the caller.
void parallel_both(const std::function<void()>& a, const std::function<void()>& b);

/// Number of chunks that parallel_for makes of [0, n); chunk c is [c * chunk, min(n, (c + 1) * chunk)).
int chunk_count(int n, int chunk);

/// Sum of part(begin, end) over the chunks of [0, n), added in the order of the chunks.
double parallel_sum(int n, int chunk, const std::function<double(int begin, int end)>& part);

} // namespace toile

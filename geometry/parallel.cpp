// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <memory>
#include <vector>

namespace toile {

namespace {

// The arena says how many threads one loop may use, the control how many workers the process may start: more
// threads than cores need both.
struct Workers {
    explicit Workers(int count)
        : control(tbb::global_control::max_allowed_parallelism, std::size_t(count)), arena(count),
          count(count) {}
    tbb::global_control control;
    tbb::task_arena arena;
    int count;
};

std::unique_ptr<Workers>& workers() {
    static auto instance = std::make_unique<Workers>(tbb::info::default_concurrency());
    return instance;
}

} // namespace

void set_threads(int count) {
    const int wanted = count > 0 ? count : tbb::info::default_concurrency();
    if (workers()->count == wanted) return;
    workers().reset();
    workers() = std::make_unique<Workers>(wanted);
}

int threads() {
    return workers()->count;
}

int chunk_count(int n, int chunk) {
    return n <= 0 ? 0 : (n - 1) / std::max(chunk, 1) + 1;
}

void parallel_for(int n, int chunk, const std::function<void(int, int)>& body) {
    chunk = std::max(chunk, 1);
    const int chunks = chunk_count(n, chunk);
    const auto run = [&](int c) { body(c * chunk, std::min(n - c * chunk, chunk) + c * chunk); };
    if (chunks <= 1 || threads() == 1) {
        for (int c = 0; c < chunks; ++c)
            run(c);
        return;
    }
    workers()->arena.execute([&] { tbb::parallel_for(0, chunks, run); });
}

void parallel_both(const std::function<void()>& a, const std::function<void()>& b) {
    parallel_for(2, 1, [&](int begin, int end) {
        for (int k = begin; k < end; ++k) (k == 0 ? a : b)();
    });
}

double parallel_sum(int n, int chunk, const std::function<double(int, int)>& part) {
    chunk = std::max(chunk, 1);
    std::vector<double> parts(chunk_count(n, chunk));
    parallel_for(n, chunk, [&](int begin, int end) { parts[begin / chunk] = part(begin, end); });
    double sum = 0;
    for (double p : parts)
        sum += p;
    return sum;
}

} // namespace toile

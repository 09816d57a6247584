// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/parallel.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <cmath>
#include <mutex>
#include <set>
#include <stdexcept>
#include <vector>

using namespace toile;

namespace {
struct RestoreThreads {
    ~RestoreThreads() { set_threads(0); }
};
} // namespace

TEST_CASE("parallel_for covers every index once, in chunks of the size asked for") {
    RestoreThreads restore;
    for (int t : {1, 2, 5})
        for (int n : {0, 1, 7, 64, 1000})
            for (int chunk : {1, 3, 64, 5000}) {
                set_threads(t);
                REQUIRE(threads() == t);
                std::vector<std::atomic<int>> seen(n);
                std::mutex guard;
                std::set<std::pair<int, int>> chunks;
                parallel_for(n, chunk, [&](int begin, int end) {
                    for (int i = begin; i < end; ++i)
                        ++seen[i];
                    std::lock_guard lock(guard);
                    chunks.insert({begin, end});
                });
                for (auto& s : seen)
                    CHECK(s == 1);
                REQUIRE(int(chunks.size()) == chunk_count(n, chunk));
                for (auto [begin, end] : chunks) {
                    CHECK(begin % chunk == 0);
                    CHECK(end == std::min(n, begin + chunk));
                }
            }
}

TEST_CASE("parallel_sum has the same bits for every number of threads") {
    RestoreThreads restore;
    const auto sum = [](int t) {
        set_threads(t);
        return parallel_sum(100000, 128, [](int begin, int end) {
            double s = 0;
            for (int i = begin; i < end; ++i)
                s += std::sin(i) * std::exp(i % 37);
            return s;
        });
    };
    const double one = sum(1);
    REQUIRE(one != 0);
    for (int t : {2, 3, 8})
        CHECK(sum(t) == one);
}

TEST_CASE("parallel_for uses several threads, may be nested and hands exceptions on") {
    RestoreThreads restore;
    set_threads(2);
    std::atomic<int> count = 0;
    parallel_for(8, 1, [&](int, int) { parallel_for(8, 1, [&](int, int) { ++count; }); });
    CHECK(count == 64);
    CHECK_THROWS_AS(parallel_for(100, 1,
                                 [](int begin, int) {
                                     if (begin == 50) throw std::runtime_error("x");
                                 }),
                    std::runtime_error);
}

TEST_CASE("parallel_both runs both and hands exceptions on") {
    RestoreThreads restore;
    for (const int t : {1, 2}) {
        set_threads(t);
        int a = 0, b = 0;
        parallel_both([&] { a = 1; }, [&] { b = 2; });
        CHECK(a == 1);
        CHECK(b == 2);
        CHECK_THROWS_AS(parallel_both([] {}, [] { throw std::runtime_error("x"); }), std::runtime_error);
    }
}

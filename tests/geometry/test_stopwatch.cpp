// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/stopwatch.h"

#include <catch2/catch.hpp>

#include <thread>

using namespace toile;

TEST_CASE("a stopwatch sums up laps, those within others once") {
    const auto wait = [] { std::this_thread::sleep_for(std::chrono::milliseconds(20)); };
    Stopwatch watch;
    wait();
    CHECK(watch.seconds() == 0);
    {
        const Stopwatch::Lap outer(watch);
        const Stopwatch::Lap inner(watch);
        wait();
    }
    const double once = watch.seconds();
    CHECK(once >= 0.02);
    const auto start = Stopwatch::Clock::now();
    {
        const Stopwatch::Lap lap(watch);
        {
            const Stopwatch::Lap inner(watch);
            wait();
        }
        wait();
    }
    const std::chrono::duration<double> gone = Stopwatch::Clock::now() - start;
    CHECK(watch.seconds() - once >= 0.04);
    CHECK(watch.seconds() - once <= gone.count());
}

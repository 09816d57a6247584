// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Wall time that some work takes in all, over many calls, for reports.

#include <chrono>

namespace toile {

/// Sums up laps; one within another counts once. Laps are to be taken by one thread at a time.
class Stopwatch {
public:
    using Clock = std::chrono::steady_clock;

    /// Runs until it goes out of scope.
    class Lap {
    public:
        explicit Lap(Stopwatch& watch) : watch_(watch), outermost_(watch.running_++ == 0) {
            if (outermost_) start_ = Clock::now();
        }
        ~Lap() {
            --watch_.running_;
            if (outermost_) watch_.sum_ += Clock::now() - start_;
        }
        Lap(const Lap&) = delete;
        Lap& operator=(const Lap&) = delete;

    private:
        Stopwatch& watch_;
        bool outermost_;
        Clock::time_point start_;
    };

    double seconds() const { return sum_.count(); }

private:
    int running_ = 0;
    std::chrono::duration<double> sum_{0};
};

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "draping/drape.h"

#include <chrono>
#include <iosfwd>
#include <string>

namespace toile {

/// One line that is written over and over: stage, level, residual, share done, time left.
class ProgressLine {
public:
    /// Writes nothing when not `shown`.
    ProgressLine(std::ostream& err, bool shown) : err_(err), shown_(shown) {}
    ~ProgressLine() { clear(); }
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    void show(const DrapeProgress& progress);
    void show(const std::string& line);
    void clear();

private:
    bool due() const; ///< not so soon after the last one
    void write(const std::string& line);

    std::ostream& err_;
    bool shown_;
    bool dirty_ = false;
    std::chrono::steady_clock::time_point last_{};
};

/// The line's text.
std::string progress_text(const DrapeProgress& progress);

/// While it lives, the first Ctrl-C (or SIGTERM) is remembered instead of ending the process; the second ends
/// it.
class Interrupt {
public:
    Interrupt();
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    bool asked() const;
};

} // namespace toile

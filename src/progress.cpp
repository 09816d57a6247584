// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/progress.h"

#include "geometry/text.h"

#include <cmath>
#include <csignal>
#include <ostream>

namespace toile {
namespace {

volatile std::sig_atomic_t interrupted = 0;

void remember(int) {
    interrupted = 1;
}

std::string time_left(double seconds) {
    if (!std::isfinite(seconds)) return "";
    if (seconds < 60) return text("  %.0f s left", std::ceil(seconds));
    return text("  %.0f min left", std::ceil(seconds / 60));
}

} // namespace

std::string progress_text(const DrapeProgress& p) {
    std::string line = p.stage;
    if (p.levels > 1) line += "  level " + std::to_string(p.level + 1) + " of " + std::to_string(p.levels);
    if (std::isfinite(p.residual)) line += text("  residual %.1e", p.residual);
    line += text("  %.0f %%", std::floor(100 * p.done));
    return line + time_left(p.seconds_left);
}

bool ProgressLine::due() const {
    return shown_ && (!dirty_ || std::chrono::steady_clock::now() - last_ >= std::chrono::milliseconds(100));
}

void ProgressLine::write(const std::string& line) {
    err_ << "\r\033[K" << line << std::flush;
    dirty_ = true;
    last_ = std::chrono::steady_clock::now();
}

void ProgressLine::show(const DrapeProgress& progress) {
    if (due()) write(progress_text(progress));
}

void ProgressLine::show(const std::string& line) {
    if (due()) write(line);
}

void ProgressLine::clear() {
    if (dirty_) err_ << "\r\033[K" << std::flush;
    dirty_ = false;
}

Interrupt::Interrupt() {
    interrupted = 0;
    struct sigaction action = {};
    action.sa_handler = remember;
    action.sa_flags = int(SA_RESETHAND);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

Interrupt::~Interrupt() {
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
}

bool Interrupt::asked() const {
    return interrupted != 0;
}

} // namespace toile

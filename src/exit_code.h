// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>

namespace toile {

/// What the shell learns.
enum ExitCode {
    exit_made = 0,          ///< done as asked
    exit_command_line = 1,  ///< the command line cannot be used
    exit_refused = 2,       ///< an input is refused, or a target cannot be written; nothing was
    exit_not_converged = 3, ///< not converged, slid off or too small; the best state was written
};

/// A command line that cannot be used; what() is one sentence.
struct CommandLineError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

} // namespace toile

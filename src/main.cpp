// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/command_line.h"

#include <iostream>

#include <unistd.h>

int main(int argc, char** argv) {
    const toile::Console console{std::cout, std::cerr, isatty(STDERR_FILENO) == 1};
    return toile::run_command_line({argv + 1, argv + argc}, console);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Options that several commands share.

#include "io/write_garment.h"
#include "sewing/form.h"

#include <string>

namespace CLI {
class App;
}

namespace toile {

/// --height --bust --waist --hip.
void add_form_measures(CLI::App& command, FormMeasures& form);

/// --unit and --up of written OBJ files.
void add_unit_and_up(CLI::App& command, WriteOptions& write);

/// --fabric NAME, one of the presets or a file.
void add_fabric(CLI::App& command, std::string& fabric, const std::string& help);

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Options that several commands share.

#include "io/write_garment.h"
#include "sewing/form.h"

#include <string>
#include <vector>

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

/// --threads, --quiet and --json of a command that writes a report.
void add_run_options(CLI::App& command, int& threads, bool& quiet, bool& json);

/// Throws CommandLineError for a garment file whose name does not end as one.
void refuse_formats(const std::vector<std::string>& garments);

} // namespace toile

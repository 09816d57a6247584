// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The garment of a job, whatever it is read from.

#include "draping/staging.h"
#include "draping/measure.h"
#include "patterns/check.h"
#include "patterns/triangulate.h"

#include <string>
#include <vector>

namespace toile {

struct DrapeInput {
    Staging staging;
    PanelFabrics fabrics; ///< one per panel
    std::string fabric;   ///< name of the garment's
    std::vector<std::string> files; ///< that fabrics and rest meshes came from, by panel
    std::vector<std::string> notes, warnings;
};

/// Whether a file is a staged mesh by its name (.obj), else a pattern.
bool is_staged(const std::string& path);

/// A pattern that check() finds no error in. Its warnings are added. Throws InputError with the first error.
Pattern sound_pattern(const std::string& path, std::vector<std::string>& warnings);

/// The first panel that is not flat at rest; null: none.
const Panel* moulded_panel(const Pattern& pattern);

/// The pattern meshed at `edge_length` metres, along the grain if so asked. Throws InputError when that is too fine, the meshes alone would
/// take the process beyond `max_memory` bytes, or a rest mesh, which has its own triangles, cannot follow.
DrapeInput input_of(const Pattern& pattern, const std::string& fabric, double edge_length, double max_memory = 1e18,
                    bool grain_lattice = false);

/// The edge length, m, below which input_of() would refuse a pattern of flat panels.
double finest_edge(const Pattern& pattern, double max_memory = 1e18);

/// The same pattern's meshes alone; `size` as in TriangulateOptions.
FlatPattern flat_of(const Pattern& pattern, double edge_length, bool grain_lattice = false,
                    const std::function<double(int panel, const Vec2& at)>& size = {});

/// A staged mesh and its companion, which may say fabrics, layers, pins and elastics; the edges of its panels are
/// the loops of their border. Throws InputError.
DrapeInput read_staged_input(const std::string& path, const std::string& fabric, const TriMesh& body);

/// Nested levels for a finest edge length: twice as coarse each, the coarsest of 40 to 80 mm.
int levels_for(double edge_length);

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// From files to files: read a mesh and what its lengths and angles are to be, find the nearest shapes, write them.

#include "draping/rest/nearest.h"

#include "io/read_garment.h"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

namespace toile {

struct RestJob {
    std::string shape;      ///< file: the mesh, and where its points are to begin with
    std::string lengths_of; ///< file with the same triangles, whose lengths are prescribed; empty: those of `shape`
    std::string angles_of;  ///< the same for angles
    std::string data;       ///< file that changes some of them; empty: none
    std::string fabric = "poplin"; ///< preset or file, whose stiffnesses weigh lengths against angles,
    double length_weight = 0; ///< J; more than 0: lengths have this weight instead, and angles 1
    bool relax = false;     ///< the rest shape is what the nearest shape measures; else what was prescribed

    std::string output;     ///< file of the lowest state; empty: not written
    bool all_states = false; ///< the k-th is written beside it as name-k
    std::string rest;       ///< file of the rest shape, JSON; empty: not written
    std::string preview;    ///< PNG file of the misfit; empty: not written
    std::string report;     ///< file; empty: not written
};

struct RestOutcome {
    std::vector<FoundShape> states;
    std::string report;               ///< JSON text, described in docs/rest.md
    std::vector<std::string> written; ///< files
};

/// What a mesh that was read measures, all weights 1. Throws InputError.
Prescribed measured_in(const std::string& path, const ReadGarment& read);

/// The point at each number of the file, from 0; -1: none.
std::vector<int> points_of_file(const ReadGarment& read);

/// The states as the report lists them; what is left of their gradient is under the key `left`.
nlohmann::ordered_json states_json(const Prescribed& data, const std::vector<FoundShape>& states, const char* left);

/// Writes the lowest state, or `all` of them, as the mesh `read` of the file `shape` moved there, to name.obj, name-2.obj,
/// name-3.obj ...; `path` empty: none. Adds the files from the second on to `written`.
void write_states(const std::string& path, bool all, const std::string& shape, const ReadGarment& read,
                  const std::vector<FoundShape>& states, std::vector<std::string>& written);

/// Does the job. Throws InputError (a sentence) when a file is refused or a target cannot be written, before anything is. No
/// states: from no start was a minimum reached.
RestOutcome run_rest(const RestJob& job);

} // namespace toile

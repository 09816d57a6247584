// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// From files to files: read, check, triangulate, drape, write. Start reading toile here.

#include "draping/drape.h"
#include "io/report.h"
#include "io/write_garment.h"
#include "sewing/form.h"

#include <string>
#include <vector>

namespace toile {

struct DrapeJob {
    std::string pattern; ///< file: a pattern, or a staged mesh (.obj)
    std::string avatar;  ///< file; empty: the built-in form of these measures
    std::vector<std::string> avatar_sequence; ///< files of a body in motion, instead of `avatar`; dressed in the first
    FormMeasures form;
    bool repair_avatar = false;
    std::string fabric;        ///< preset or file; empty: what the pattern says, else poplin
    double edge_length = 0.01; ///< m, mean edge of the finest mesh; a staged mesh keeps its own
    double accuracy = 0;         ///< RMS error; not 0: edge lengths are chosen for it, and edge_length is not used
    AccuracyOf accuracy_of = AccuracyOf::place; ///< what it is of: m, or a share
    double accuracy_seconds = 0; ///< s; not 0: they are chosen such that the error gets as small as it goes in that time
    std::string from;          ///< garment file to start from; empty: the pattern's own placement
    DrapeOptions drape;
    std::function<bool()> interrupted; ///< whether drape.progress stopped the work; for the report's `where`

    std::vector<std::string> garments; ///< files to write: .obj, .glb
    double sequence_rate = 0; ///< frames per second of avatar_sequence, for point caches; 0: none are written
    std::string preview, report;       ///< files; empty: not written
    WriteOptions write;                ///< unit and up axis; its avatar is set by with_avatar
    bool with_avatar = false;
};

inline bool is_to_accuracy(const DrapeJob& job) { return job.accuracy > 0 || job.accuracy_seconds > 0; }

struct DrapeOutcome {
    DrapeResult result;
    TriMesh body;
    std::vector<FrameRow> frames;     ///< of a sequence, after the first
    std::string report;               ///< JSON text
    std::vector<std::string> written; ///< files
};

/// Does the job. Throws InputError (a sentence) when a file is refused or a target cannot be written, before
/// anything is; a drape that does not converge is written all the same, and `result.status` says so. Of a sequence
/// every frame's garment is written to files of its number, name.0001.obj for name.obj, as soon as it is done. The frames of an
/// animation go into every .glb, and those of either into point caches beside every .obj.
DrapeOutcome run_job(const DrapeJob& job);

/// Minutes of work must not end in a target that cannot be written or in an overwritten input: throws InputError. Inputs
/// may be empty.
void refuse_targets(const std::vector<std::string>& inputs, const std::vector<std::string>& targets);

/// Whether the drape and all frames asked for converged, or the animation ran to its end.
bool converged(const DrapeJob& job, const DrapeOutcome& outcome);

/// The built-in form. Throws CommandLineError when a measure is out of range.
TriMesh form_of(const FormMeasures& measures);

/// The body of a job in metres, y up, and what was noted when it was read.
struct Body {
    TriMesh mesh;
    std::vector<std::string> notes;
};
Body read_body(const std::string& avatar, const FormMeasures& form, bool repair);

} // namespace toile

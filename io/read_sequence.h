// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "io/read_avatar.h"

namespace toile {

/// A body in motion.
struct ReadSequence {
    TriMesh body;                   ///< of the first frame, as read_avatar() gives it
    std::vector<Points> frames;     ///< positions of its points in every further frame
    std::vector<std::string> notes; ///< of the first frame
};

/// The files of a sequence in order. `words` are either the files themselves, in order, or one of: a folder, whose
/// meshes (OBJ, PLY) are taken by the number that their names end in; or a pattern like walk.%04d.obj, the files of
/// which are taken from the lowest number on. Throws InputError: no file fits, names without a number or two of one
/// number, a number that is missing.
std::vector<std::string> sequence_files(const std::vector<std::string>& words);

/// The numbers that the names of the files end in, when every name has one and they ascend; else 0, 1, 2, ...
std::vector<int> frame_numbers(const std::vector<std::string>& files);

/// Meshes of one topology: the same number of points, and the same corners in every face. What the first file shows
/// (unit, up axis, quads split, points joined, holes closed) holds for all. Throws InputError as read_avatar() does, and
/// with the name of the frame that is another mesh, in what it differs.
ReadSequence read_sequence(const std::vector<std::string>& files, const ReadAvatarOptions& options = {});

} // namespace toile

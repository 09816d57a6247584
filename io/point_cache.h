// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The points of one mesh at equal times, as other programs read them: PC2 (3ds Max's point cache 2) and MDD (LightWave's
// motion designer). docs/outputs.md says what they hold and who reads them.

#include "io/write_garment.h"

namespace toile {

/// Writes positions as write_garment() does to an OBJ, in the order of its nodes, rounded to float: frame by frame beside the
/// target, which is replaced when all is there. Throws InputError when the target cannot be written.
void write_pc2(const std::string& path, const PointFrames& points, const WriteOptions& options = {});
void write_mdd(const std::string& path, const PointFrames& points, const WriteOptions& options = {});

/// The caches that belong to an OBJ garment, tee.pc2 and tee.mdd of tee.obj.
std::vector<std::string> cache_files(const std::string& garment);
void write_caches(const std::string& garment, const PointFrames& points, const WriteOptions& options);

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "io/read_garment.h"

namespace toile {

/// Node positions for `garment` from an earlier drape of nearly the same pattern, whatever its mesh: every
/// vertex looks up its place in the flat panel of the same name. Where a panel has grown, the cloth beside it
/// is continued. Throws InputError when the earlier drape lacks a panel or has no flat pattern; `name` is
/// what messages call it.
Points start_from(const ReadGarment& earlier, const Garment& garment, const std::string& name);

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sewing/avatar.h"
#include "sewing/garment.h"

#include <string>

namespace toile {

struct PreviewOptions {
    int height = 900; ///< pixels; the width follows
};

/// A PNG picture of front, back and side beside each other: shaded cloth and body, panels told apart by shade,
/// seams drawn. Ray-cast; needs no display.
void write_preview(const std::string& path, const Garment& garment, const Points& x, const TriMesh& body,
                   const PreviewOptions& options = {});

} // namespace toile

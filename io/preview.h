// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sewing/avatar.h"
#include "sewing/garment.h"

#include <string>
#include <vector>

namespace toile {

struct PreviewOptions {
    int height = 900; ///< pixels, 16 .. 8192; the width follows from the garment
    std::vector<double> heat{}; ///< per node, in [0, 1]: painted on the cloth from white to red, instead of shades of panels
};

/// A PNG picture of front, back and side (the wearer's left) beside each other, without perspective and all
/// in one scale: shaded cloth and body, panels told apart by shade, the wrong side paler, seams and cut edges
/// drawn. Ray-cast (Embree); needs no display. `body` may be empty. Throws InputError when the file cannot be
/// written.
void write_preview(const std::string& path, const Garment& garment, const Points& x, const TriMesh& body,
                   const PreviewOptions& options = {});

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Places on a garment in words: what blocks, what gapes, what is too tight, and where.

#include "draping/contact/contact.h"
#include "draping/measure.h"

namespace toile {

/// `panel "front" at (0.123, 1.020, 0.101) m`.
std::string place_of_node(const Garment& garment, const Points& x, int node);
std::string place_of_triangle(const Garment& garment, const Points& x, int triangle);

/// Two places of the cloth, or one and the body's, joined by "against".
std::string place_of_pair(const Garment& garment, const Points& x, const ContactPair& pair);

/// The open stitch that gapes most; -1 without stitches.
int widest_stitch(const Garment& garment, const Points& x);

/// A sentence on the seam that gapes most: its name, the gap in mm, both places, and what lies between them: the
/// body or a panel that the thread passes through, else what touches there.
std::string open_seam(const Garment& garment, const Points& x, const std::vector<std::string>& seam_names,
                      const TriMesh& body, const std::vector<ContactPair>& touching);

/// Where the cloth is stretched most beyond its fabric's limit, and by how much connected sections of the garment
/// along the direction of most stretch there are longer than the limits of their cloth allow, at most.
struct Tightness {
    int triangle = -1;    ///< -1: nowhere beyond a limit
    double strain = 0;    ///< of the yarn that is worst there
    double limit = 0;
    bool warp = false;    ///< which yarn
    double missing = 0;   ///< m, of a section as a whole; 0 when cloth that is shorter makes up for what is missing elsewhere
    double missing_in_part = 0; ///< m, of the parts of a section that are too long
    double any_missing() const { return missing > 0 ? missing : missing_in_part; }
};
Tightness find_tightness(const Garment& garment, const Points& x, const PanelFabrics& fabrics);

/// The same for a garment whose seams are open, across the seam at its widest stitch: how much longer the section with
/// the gaps of its seams is than its cloth may become. At most 0 when there is cloth enough and something else keeps
/// the seam open.
double missing_at_open_seam(const Garment& garment, const Points& x, const PanelFabrics& fabrics);

} // namespace toile

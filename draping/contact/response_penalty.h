// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "draping/contact/response.h"

namespace toile {

/// Springs between what is nearer than the thickness, and between nodes in the body and the nearest face.
std::unique_ptr<Response> penalty_response(ContactCloth cloth, const TriMesh& body, const ResponseOptions& options);

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "draping/contact/response.h"

namespace toile {

/// Repulsions, then inelastic impulses, then rigid impact zones.
std::unique_ptr<Response> impulse_response(ContactCloth cloth, const TriMesh& body, const ResponseOptions& options);

/// Rigid impact zones alone.
std::unique_ptr<Response> rigid_response(ContactCloth cloth, const TriMesh& body, const ResponseOptions& options);

} // namespace toile

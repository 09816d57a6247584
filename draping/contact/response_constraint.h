// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "draping/contact/response.h"

namespace toile {

/// Nodes held on faces of the body until the force that holds them pulls. Neither edges nor the cloth's contact with
/// itself are looked at.
std::unique_ptr<Response> constraint_response(ContactCloth cloth, const TriMesh& body, const ResponseOptions& options);

} // namespace toile

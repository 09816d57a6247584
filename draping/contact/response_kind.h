// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The names of the responses to contact and of what they promise.

#include <string>

namespace toile {

enum class ContactResponse { barrier, constraint, penalty, impulse, rigid };

/// "barrier", "constraint", "penalty", "impulse", "rigid".
const char* to_string(ContactResponse response);
/// Throws std::invalid_argument with the names when there is no such response.
ContactResponse contact_response(const std::string& name);

/// What is promised of a start without crossings.
enum class Guarantee {
    no_crossing,     ///< cloth passes neither through the body nor through itself
    no_node_in_body, ///< no node of the cloth passes through a face of the body
    none
};
const char* to_string(Guarantee guarantee); ///< as above

} // namespace toile

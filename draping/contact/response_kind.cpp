// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/contact/response_kind.h"

#include "geometry/named.h"

#include <array>

namespace toile {

const char* to_string(ContactResponse r) {
    switch (r) {
    case ContactResponse::barrier: return "barrier";
    case ContactResponse::constraint: return "constraint";
    case ContactResponse::penalty: return "penalty";
    case ContactResponse::impulse: return "impulse";
    case ContactResponse::rigid: return "rigid";
    }
    return "barrier";
}

ContactResponse contact_response(const std::string& name) {
    return named(name, std::array{ContactResponse::barrier, ContactResponse::constraint, ContactResponse::penalty,
                                  ContactResponse::impulse, ContactResponse::rigid},
                 "contact response", "responses");
}

const char* to_string(Guarantee g) {
    switch (g) {
    case Guarantee::no_crossing: return "no_crossing";
    case Guarantee::no_node_in_body: return "no_node_in_body";
    case Guarantee::none: return "none";
    }
    return "none";
}

} // namespace toile

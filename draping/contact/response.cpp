// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/contact/response.h"

#include "draping/contact/response_constraint.h"
#include "draping/contact/response_impulse.h"
#include "draping/contact/response_penalty.h"

#include <stdexcept>
#include <tuple>

namespace toile {

bool before(const Touch& a, const Touch& b) {
    return std::tie(a.point, a.edge_edge) < std::tie(b.point, b.edge_edge);
}

std::unique_ptr<Response> make_response(ContactResponse response, ContactCloth cloth, const TriMesh& body,
                                        const ResponseOptions& options) {
    switch (response) {
    case ContactResponse::constraint: return constraint_response(std::move(cloth), body, options);
    case ContactResponse::penalty: return penalty_response(std::move(cloth), body, options);
    case ContactResponse::impulse: return impulse_response(std::move(cloth), body, options);
    case ContactResponse::rigid: return rigid_response(std::move(cloth), body, options);
    case ContactResponse::barrier: break;
    }
    throw std::invalid_argument("the barrier has to be solved for: it is no correction of velocities");
}

} // namespace toile

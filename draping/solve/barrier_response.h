// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The barrier as a response, for steppers that do not solve for contact: the places that a step without contact would
// lead to give way to
//   argmin_y  1/2 |y - (x + dt v)|^2_M / dt^2 + contact(y),
// a proximal step of the barrier and its friction (Li et al.: Incremental Potential Contact, 2020, with the cloth's own energy
// left to the stepper), from x by Newton steps of which none passes through anything. Its forces are those of the barrier at
// the end of the step: a cloth at rest is where they are in balance with its own.

#include "draping/contact/resting_contact.h"
#include "draping/contact/response.h"

namespace toile {

/// `barriers`: as for equilibrium. Friction is by the ties of RestingContact; a body that moves carries none of them along.
std::unique_ptr<Response> barrier_response(ContactCloth cloth, const TriMesh& body, const ContactOptions& barriers,
                                           const ResponseOptions& options);

} // namespace toile

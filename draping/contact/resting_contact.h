// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Contact by the barrier with friction of cloth at rest, as a part of whatever problem brings the cloth there.

#include "draping/contact/cloth_friction.h"

namespace toile {

class RestingContact {
public:
    RestingContact(ContactCloth cloth, const TriMesh& body, const ContactOptions& options);

    Friction friction;       ///< on the body; coefficient 0: none
    Friction cloth_friction; ///< of cloth on cloth

    Contact& contact() { return contact_; }
    const Contact& contact() const { return contact_; }

    /// Every touching or later touching node is tied by friction to where it is now. If x is a state at rest,
    /// friction is at once what holds it there; otherwise it follows contact slowly.
    void rest_here(const Points& x, const FrictionCoefficients& coefficients, bool at_rest = false);

    /// Goes on with the contact and friction of a larger cloth in the state x, whose node nodes[k] is node k here.
    void begin_as_part(const RestingContact& whole, const std::vector<int>& nodes, const Points& x);
    /// Goes on with what has become of the friction of such a part of this; x is the state now.
    void end_part(const RestingContact& part, const std::vector<int>& nodes, const Points& x);

    /// Frozen, all friction ties stay as they are, whatever touches: then all that acts is one energy. rest_here() ends it.
    void freeze_friction() { frozen_ = true; }

    /// Finds the pairs that act at x, on which gradients and second derivatives stand; what is lagged stays as it is.
    void touch(const Points& x);

    int blocking_pair() const { return blocking_; } ///< -1: none limited the last step asked for with shares

protected:
    /// A new state: renews what is lagged, for nodes of these masses, kg. Returns whether friction is to take_up() what the
    /// forces at x leave, as it does once for a state at rest.
    bool renew_contact(const Points& x, const std::vector<double>& node_mass);
    void take_up_forces(const Points& x, const std::vector<char>& pinned, Eigen::VectorXd& g);

    /// `sum` and the energies of contact, in the order of their addition; `active` are the pairs at x.
    double with_contact_value(double sum, const std::vector<ActivePair>& active, const Points& x) const;
    void add_contact_gradient(const std::vector<ActivePair>& active, const Points& x, Eigen::VectorXd& g) const;
    void contact_couplings(std::vector<std::pair<int, int>>& pairs) const;
    /// What pairs of places couple. False when the matrix lacks a block.
    bool add_pair_hessian(const Points& x, bool exact, BlockMatrix& h) const;
    /// The rest, on the diagonal.
    void add_body_friction_hessian(const Points& x, bool exact, BlockMatrix& h) const;

    double longest_contact_step(const Points& x, const Eigen::VectorXd& dx, std::vector<double>* shares);

    /// Of friction over what contact can answer, N per node; 0 while it is frozen.
    std::vector<double> friction_excess(const Points& x) const;
    /// Of so many arrivals, while nothing is near rest, one renews what is lagged.
    void renew_every(int arrivals) { renew_every_ = arrivals; }
    /// The residual of the state at work, by which friction knows how near rest it is.
    void note_residual(double residual) { residual_ = residual; }

    const std::vector<ActivePair>& active() const { return active_; }
    /// The same as touch() where the list of pairs still serves and its active ones are known.
    void touch(std::vector<ActivePair> active) { active_ = std::move(active); }

private:
    void match_cloth_friction(const Points& x);
    void renew_friction(const Points& x, const std::vector<double>& node_mass);
    void adapt_friction(const Points& x);

    Contact contact_;
    std::vector<ActivePair> active_;      ///< at the state of the last touch()
    std::vector<PairForce> cloth_forces_; ///< then, one for each tie
    Points arrived_at_;
    int renew_every_ = 8;
    int arrivals_ = 0;               ///< since the cloth was tied to its place
    bool near_rest_ = false;
    bool frozen_ = false;
    bool trusted_ = false;           ///< the contact forces of the next arrival are those of a state at rest
    bool rising_ = false;            ///< some node's friction has yet to catch up with its normal force
    double residual_ = 0, renewed_at_ = 0;
    int blocking_ = -1;
};

} // namespace toile

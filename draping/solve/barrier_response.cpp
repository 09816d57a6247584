// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/barrier_response.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace toile {

namespace {

using Eigen::VectorXd;

constexpr int most_newton = 100;
constexpr int most_cuts = 20; // of a step in half
constexpr int most_cg = 200;
constexpr double cg_tolerance = 0.05;
constexpr double balanced = 1e-4;     // of a weight, that the forces of a proximal step may be off
constexpr double sufficient = 1e-4;   // of the decrease that the slope promises
constexpr int most_body_rounds = 40;  // shares of its way by which a body comes through a step
constexpr double weight_per_mass = 9.81;
constexpr double residual_per_speed = 1e3; // s/m: to friction all is near rest from a centimetre per second down,
constexpr double moving = 0.05;            // m/s, up to this

class BarrierResponse final : public Response, private RestingContact {
public:
    BarrierResponse(ContactCloth cloth, const TriMesh& body, const ContactOptions& barriers, const ResponseOptions& options)
        : RestingContact(cloth, body, barriers), options_(options) {
        renew_every(1); // what slides does so under forces that come and go
        for (const Triangle& t : cloth.triangles)
            for (int k = 0; k < 3; ++k) couplings_.emplace_back(t[k], t[(k + 1) % 3]);
        for (const auto& e : cloth.edges) couplings_.emplace_back(e[0], e[1]);
    }

    ResponseDone respond(const ResponseStep& step, Points& v) override {
        begin(step, v);
        Points y = step.x;
        ResponseDone done;
        for (int round = 0; round < most_body_rounds; ++round) {
            const bool arrived = go_with_body(step, y);
            minimise(y);
            if (arrived) break;
            done.unresolved = round + 1 == most_body_rounds;
        }
        if (done.unresolved) contact().set_body(step.body_end);
        for (std::size_t i = 0; i < y.size(); ++i)
            if (!fixed_[i]) v[i] = (y[i] - step.x[i]) / step.dt;
        VectorXd g = VectorXd::Zero(3 * Eigen::Index(y.size()));
        add_contact_gradient(active(), y, g);
        done.other_force.resize(y.size());
        flat(done.other_force) = -g;
        tell_friction(v);
        return done;
    }

    Guarantee guarantee() const override { return Guarantee::no_crossing; }
    bool lasts() const override { return true; }
    const Points& body() const override { return contact().body(); }
    const ResponseOptions& options() const override { return options_; }

private:
    /// Ties follow contact while something moves, and give way alone near rest.
    void tell_friction(const Points& v) {
        double fastest = 0;
        for (std::size_t i = 0; i < v.size(); ++i)
            if (!fixed_[i]) fastest = std::max(fastest, v[i].norm());
        note_residual(fastest < moving ? residual_per_speed * fastest : std::numeric_limits<double>::infinity());
    }

    void begin(const ResponseStep& step, const Points& v) {
        const std::size_t n = step.x.size();
        if (friction.ties.empty()) rest_here(step.x, {options_.body_friction, options_.cloth_friction});
        mass_.resize(n);
        fixed_.assign(n, 0);
        target_.resize(n);
        for (std::size_t i = 0; i < n; ++i) {
            fixed_[i] = step.inverse_mass[i] == 0;
            mass_[i] = fixed_[i] ? 0 : 1 / step.inverse_mass[i];
            target_[i] = step.x[i] + step.dt * v[i];
        }
        per_step2_ = 1 / (step.dt * step.dt);
        renew_contact(step.x, mass_);
    }

    /// What the body, and nodes that nothing moves from their way, have left to go; takes them as far as they come. Returns
    /// whether they are there.
    bool go_with_body(const ResponseStep& step, Points& y) {
        Points left = step.body_end;
        double far = 0;
        for (std::size_t k = 0; k < left.size(); ++k) {
            left[k] -= contact().body()[k];
            far = std::max(far, left[k].squaredNorm());
        }
        VectorXd dx = VectorXd::Zero(3 * Eigen::Index(y.size()));
        for (std::size_t i = 0; i < y.size(); ++i)
            if (fixed_[i]) dx.segment<3>(3 * i) = target_[i] - y[i];
        if (far == 0 && dx.isZero(0)) return true;
        contact().prepare(y, dx, &left);
        const double t = contact().feasible_step(y, dx, &left);
        Points body = contact().body();
        for (std::size_t k = 0; k < left.size(); ++k) body[k] = t == 1 ? step.body_end[k] : Vec3(body[k] + t * left[k]);
        contact().set_body(body);
        flat(y) += t * dx;
        touch(y);
        return t == 1;
    }

    double value(const Points& y, const std::vector<ActivePair>& active) const {
        double sum = 0;
        for (std::size_t i = 0; i < y.size(); ++i) sum += 0.5 * per_step2_ * mass_[i] * (y[i] - target_[i]).squaredNorm();
        return with_contact_value(sum, active, y);
    }

    /// Returns the largest force on a node over its weight.
    double gradient(const Points& y, VectorXd& g) const {
        g.setZero(3 * Eigen::Index(y.size()));
        add_contact_gradient(active(), y, g);
        double most = 0;
        for (std::size_t i = 0; i < y.size(); ++i) {
            if (fixed_[i]) {
                g.segment<3>(3 * i).setZero();
                continue;
            }
            g.segment<3>(3 * i) += per_step2_ * mass_[i] * (y[i] - target_[i]);
            most = std::max(most, g.segment<3>(3 * i).norm() / (weight_per_mass * mass_[i]));
        }
        return most;
    }

    const BlockMatrix& matrix(const Points& y) {
        for (;;) {
            if (matrix_.block_rows() == 0) {
                std::vector<std::pair<int, int>> pairs = couplings_;
                contact_couplings(pairs);
                matrix_ = BlockMatrix(int(y.size()), pairs);
            }
            matrix_.set_zero();
            if (add_pair_hessian(y, false, matrix_)) break;
            matrix_ = {};
        }
        add_body_friction_hessian(y, false, matrix_);
        VectorXd inertia(3 * y.size());
        for (std::size_t i = 0; i < y.size(); ++i) inertia.segment<3>(3 * i).setConstant(per_step2_ * mass_[i]);
        matrix_.add_to_diagonal(inertia);
        matrix_.pin(fixed_);
        return matrix_;
    }

    /// Conjugate gradients, preconditioned by the blocks on the diagonal: inertia is most of the matrix.
    void solve(const BlockMatrix& h, const VectorXd& g, VectorXd& dx) {
        const std::vector<int>& column = h.scalar_columns();
        const int n = h.block_rows();
        inverse_.resize(n);
        for (int i = 0; i < n; ++i) {
            Mat3 block;
            for (int c = 0; c < 3; ++c)
                for (int r = c; r < 3; ++r) block(r, c) = block(c, r) = h.values()[column[3 * i + c] + r - c];
            inverse_[i] = block.inverse();
        }
        const auto precondition = [&](const VectorXd& r, VectorXd& z) {
            z.resize(r.size());
            for (int i = 0; i < n; ++i) z.segment<3>(3 * i) = inverse_[i] * r.segment<3>(3 * i);
        };
        VectorXd r = -g, z, p, hp;
        dx.setZero(g.size());
        precondition(r, z);
        p = z;
        double rz = r.dot(z);
        const double stop = cg_tolerance * cg_tolerance * rz;
        for (int k = 0; k < most_cg && rz > stop; ++k) {
            h.multiply(p, hp);
            const double a = rz / p.dot(hp);
            dx += a * p;
            r -= a * hp;
            precondition(r, z);
            const double next = r.dot(z);
            p = z + next / rz * p;
            rz = next;
        }
    }

    void minimise(Points& y) {
        VectorXd g, dx;
        double now = value(y, active());
        for (int k = 0; k < most_newton && gradient(y, g) > balanced; ++k) {
            solve(matrix(y), g, dx);
            double t = longest_contact_step(y, dx, nullptr);
            const double slope = g.dot(dx), noise = 1e-14 * std::abs(now);
            for (int cut = 0;; ++cut, t *= 0.5) {
                if (cut == most_cuts) return;
                Points trial = y;
                flat(trial) += t * dx;
                std::vector<ActivePair> then = contact().active(trial);
                const double value_then = value(trial, then);
                if (value_then > now + sufficient * t * slope + noise) continue;
                y = std::move(trial);
                now = value_then;
                touch(std::move(then));
                break;
            }
        }
    }

    ResponseOptions options_;
    std::vector<std::pair<int, int>> couplings_; ///< of the cloth's own edges
    BlockMatrix matrix_;
    std::vector<double> mass_; ///< kg, 0 where nothing moves a node from its way
    std::vector<char> fixed_;
    Points target_;
    double per_step2_ = 0; ///< 1/s2
    std::vector<Mat3> inverse_;
};

} // namespace

std::unique_ptr<Response> barrier_response(ContactCloth cloth, const TriMesh& body, const ContactOptions& barriers,
                                           const ResponseOptions& options) {
    return std::make_unique<BarrierResponse>(std::move(cloth), body, barriers, options);
}

} // namespace toile

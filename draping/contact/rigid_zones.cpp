// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/contact/rigid_zones.h"

#include "geometry/disjoint_sets.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

namespace toile {

namespace {

/// Velocity field v + w x (p - c).
struct RigidMotion {
    Vec3 centre = Vec3::Zero(), velocity = Vec3::Zero(), turn = Vec3::Zero();

    Vec3 at(const Vec3& p) const { return velocity + turn.cross(p - centre); }
};

/// The rigid motion with the linear and angular momentum of moving masses. About axes without inertia, of points on
/// a line, it does not turn.
struct Momenta {
    double mass = 0;
    Vec3 moment = Vec3::Zero(), momentum = Vec3::Zero();
    std::vector<std::tuple<double, Vec3, Vec3>> points = {}; ///< mass, place, velocity

    void add(double m, const Vec3& p, const Vec3& v) {
        mass += m;
        moment += m * p;
        momentum += m * v;
        points.emplace_back(m, p, v);
    }

    RigidMotion motion() const {
        RigidMotion r{moment / mass, momentum / mass, Vec3::Zero()};
        Vec3 spin = Vec3::Zero();
        Mat3 inertia = Mat3::Zero();
        for (const auto& [m, p, v] : points) {
            const Vec3 arm = p - r.centre;
            spin += m * arm.cross(v - r.velocity);
            inertia += m * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
        }
        const Eigen::SelfAdjointEigenSolver<Mat3> axes(inertia);
        const double least = 1e-9 * axes.eigenvalues()[2];
        for (int k = 0; k < 3; ++k)
            if (axes.eigenvalues()[k] > least)
                r.turn += axes.eigenvectors().col(k) * (axes.eigenvectors().col(k).dot(spin) / axes.eigenvalues()[k]);
        return r;
    }
};

} // namespace

void resolve_by_zones(StepPairs& pairs, const ResponseStep& step, Points& v, int rounds, ResponseDone& done) {
    const int n = int(v.size());
    const Points before = v;
    DisjointSets sets(n);
    std::vector<char> in_zone(n, 0);
    std::map<int, std::set<int>> fixed; // by a node of the zone: points of the body that it meets
    std::map<int, std::set<int>> held;  // the same by zone
    for (int round = 0;; ++round) {
        const std::vector<Impact> impacts = pairs.impacts();
        if (impacts.empty() || round == rounds) {
            // Nearer than impacts may come is no crossing yet.
            done.unresolved = int(std::count_if(impacts.begin(), impacts.end(),
                                                [&](const Impact& i) { return pairs.touches(i.pair); }));
            break;
        }
        for (const Impact& impact : impacts) {
            int first = -1;
            const auto points = pairs.pair(impact.pair).p;
            for (const int i : points) {
                if (i >= n) continue;
                in_zone[i] = 1;
                if (first < 0) first = i;
                sets.join(first, i);
            }
            for (const int i : points)
                if (i >= n) fixed[first].insert(i);
        }
        std::map<int, std::vector<int>> zones;
        held.clear();
        for (int i = 0; i < n; ++i)
            if (in_zone[i]) zones[sets.find(i)].push_back(i);
        for (const auto& [node, points] : fixed) held[sets.find(node)].insert(points.begin(), points.end());
        done.zones = int(zones.size());
        done.zone_nodes = int(std::count(in_zone.begin(), in_zone.end(), 1));
        for (const auto& [zone, nodes] : zones) {
            Momenta free, led;
            for (const int i : nodes)
                if (step.inverse_mass[i] > 0)
                    free.add(1 / step.inverse_mass[i], step.x[i], before[i]);
                else
                    led.add(1, step.x[i], before[i]);
            if (const auto body = held.find(zone); body != held.end())
                for (const int i : body->second) led.add(1, pairs.place(i), pairs.velocity(i));
            const RigidMotion motion = (led.mass > 0 ? led : free).motion();
            for (const int i : nodes)
                if (step.inverse_mass[i] > 0) v[i] = motion.at(step.x[i]);
        }
    }
    for (int i = 0; i < n; ++i) {
        if (!in_zone[i] || step.inverse_mass[i] == 0) continue;
        const auto led = held.find(sets.find(i));
        pairs.note_zone(i, (v[i] - before[i]) / step.inverse_mass[i], led == held.end() ? -1 : *led->second.begin());
    }
}

} // namespace toile

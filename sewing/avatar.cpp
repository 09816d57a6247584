// SPDX-License-Identifier: GPL-3.0-or-later
#include "sewing/avatar.h"

#include "geometry/slice.h"
#include "sewing/sparse_solve.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace toile {

Points Avatar::at(double s) const {
    if (s == 1) return body.points;
    Points points(body.points.size());
    for (size_t i = 0; i < points.size(); ++i) points[i] = (1 - s) * start[i] + s * body.points[i];
    return points;
}

namespace {

/// Lumped mass and t times the cotangent stiffness of one triangle.
void add_triangle(const Points& p, const Triangle& t, double time, std::vector<double>& mass,
                  std::vector<Eigen::Triplet<double>>& entries) {
    const Vec3 e[3] = {p[t[2]] - p[t[1]], p[t[0]] - p[t[2]], p[t[1]] - p[t[0]]};
    const double doubled = e[0].cross(e[1]).norm();
    const double longest = std::max({e[0].squaredNorm(), e[1].squaredNorm(), e[2].squaredNorm()});
    // A sliver's cotangents are unbounded. Dividing all three by the same larger area keeps them definite, which
    // bounding each for itself would not.
    const double area = std::max(doubled, 1e-3 * longest);
    if (area == 0) return;
    for (int k = 0; k < 3; ++k) {
        const int i = t[(k + 1) % 3], j = t[(k + 2) % 3];
        const double weight = -0.5 * time * e[(k + 1) % 3].dot(e[(k + 2) % 3]) / area;
        entries.emplace_back(i, i, weight);
        entries.emplace_back(j, j, weight);
        entries.emplace_back(std::max(i, j), std::min(i, j), -weight);
        mass[t[k]] += doubled / 6;
    }
}

} // namespace

Points smoothed_toward_core(const TriMesh& body, double time) {
    if (!(time >= 0) || !std::isfinite(time))
        throw std::invalid_argument("smoothed_toward_core: the time must be 0 m2 or more");
    const int n = int(body.points.size());
    if (n == 0 || time == 0) return body.points;
    std::vector<double> mass(n, 0);
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(9 * body.triangles.size() + n);
    for (const Triangle& t : body.triangles) add_triangle(body.points, t, time, mass, entries);
    double total = 0;
    for (double m : mass) total += m;
    if (total == 0) return body.points;
    // Points of slivers and points without triangles keep a little mass, so that they stay where they are told.
    for (int i = 0; i < n; ++i) {
        mass[i] = std::max(mass[i], 1e-6 * total / n);
        entries.emplace_back(i, i, mass[i]);
    }
    Eigen::SparseMatrix<double> a(n, n);
    a.setFromTriplets(entries.begin(), entries.end());
    Eigen::MatrixXd b(n, 3);
    for (int i = 0; i < n; ++i) b.row(i) = mass[i] * body.points[i].transpose();
    const Eigen::MatrixXd x = solve_definite(a, b);
    Points points(n);
    for (int i = 0; i < n; ++i) points[i] = x.row(i).transpose();
    return points;
}

namespace {

struct Section {
    double y = 0;
    double area = 0, girth = 0, width = 0; ///< of the torso's loop; area 0: no torso here
    double front = 0;                      ///< its largest z
};

struct Frame {
    double floor = 0, height = 0, axis = 0; ///< axis: the x of the body's middle
};

/// The loop of largest area.
const std::vector<Vec2>* largest(const std::vector<std::vector<Vec2>>& loops) {
    const std::vector<Vec2>* best = nullptr;
    double area = 0;
    for (const std::vector<Vec2>& loop : loops)
        if (const double a = loop_area(loop).area; a > area) {
            area = a;
            best = &loop;
        }
    return best;
}

/// Extent in height, and the middle of the largest loops between hip and waist, where no other part is as large.
Frame frame_of(const TriMesh& body) {
    if (body.points.empty()) throw std::invalid_argument("measure_body: the body has no points");
    Eigen::AlignedBox3d box;
    for (const Vec3& p : body.points) box.extend(p);
    Frame frame{box.min().y(), box.sizes().y(), 0};
    std::vector<double> middles;
    for (int i = 0; i < 9; ++i) {
        const auto loops = slice(body, frame.floor + frame.height * (0.54 + 0.01 * i));
        if (const auto* loop = largest(loops)) middles.push_back(loop_area(*loop).centroid.x());
    }
    if (middles.empty()) throw std::invalid_argument("measure_body: the body has no torso");
    std::sort(middles.begin(), middles.end());
    frame.axis = middles[middles.size() / 2];
    return frame;
}

/// The section of the torso (or neck, or head): the largest loop in the body's middle. A leg's middle lies well
/// to one side.
Section section_at(const TriMesh& body, const Frame& frame, double y) {
    std::vector<std::vector<Vec2>> central = slice(body, y);
    std::erase_if(central, [&](const std::vector<Vec2>& loop) {
        return std::abs(loop_area(loop).centroid.x() - frame.axis) > 0.025 * frame.height;
    });
    Section section;
    section.y = y;
    const std::vector<Vec2>* loop = largest(central);
    if (!loop) return section;
    const auto [low, high] = std::minmax_element(loop->begin(), loop->end(),
                                                 [](const Vec2& a, const Vec2& b) { return a.x() < b.x(); });
    section.area = loop_area(*loop).area;
    section.girth = hull_length(*loop);
    section.width = high->x() - low->x();
    section.front = -std::numeric_limits<double>::infinity();
    for (const Vec2& p : *loop) section.front = std::max(section.front, p.y());
    return section;
}

/// Sections from floor to crown at equal steps.
constexpr int section_count = 400;

std::vector<Section> sections_of(const TriMesh& body, const Frame& frame) {
    std::vector<Section> sections;
    for (int i = 0; i < section_count; ++i)
        sections.push_back(section_at(body, frame, frame.floor + frame.height * (i + 0.5) / section_count));
    return sections;
}

int index_at(double share) { return int(share * section_count); }

/// Index of the smallest or largest girth in [from, to].
int smallest_girth(const std::vector<Section>& s, int from, int to) {
    int best = from;
    for (int i = from; i <= to; ++i)
        if (s[i].area > 0 && s[i].girth < s[best].girth) best = i;
    return best;
}
int largest_girth(const std::vector<Section>& s, int from, int to) {
    int best = from;
    for (int i = from; i <= to; ++i)
        if (s[i].girth > s[best].girth) best = i;
    return best;
}

/// The lowest section of the torso: below it there are two legs.
int find_crotch(const std::vector<Section>& s) {
    int i = index_at(0.58);
    while (i > index_at(0.25) && s[i].area > 0) --i;
    if (s[i].area > 0) throw std::invalid_argument("measure_body: the body does not stand on two legs");
    return i + 1;
}

/// The last section of the torso below the one where the arms join it and its width jumps.
int find_armpit(const std::vector<Section>& s, double height) {
    for (int i = index_at(0.62); i < index_at(0.88); ++i)
        if (s[i].area > 0 && s[i + 1].width - s[i].width > 0.01 * height) return i;
    return index_at(0.76); // no arms: where they would be
}

/// The uppermost level below the armpits where the front stands out most among its neighbours: the bust, or the
/// chest. The largest girth would be the armpits'. A body without such a level has the largest girth for it.
int find_bust(const std::vector<Section>& s, int waist, int armpit) {
    const int reach = section_count / 50;
    for (int i = armpit - 1; i > waist + reach; --i) {
        bool foremost = true;
        for (int k = i - reach; k <= std::min(i + reach, armpit); ++k) foremost &= s[k].front <= s[i].front;
        if (foremost) return i;
    }
    return largest_girth(s, waist, armpit);
}

} // namespace

BodyMeasures measure_body(const TriMesh& body) {
    const Frame frame = frame_of(body);
    const std::vector<Section> s = sections_of(body, frame);
    const int crotch = find_crotch(s);
    const int armpit = find_armpit(s, frame.height);
    const int waist_guess = smallest_girth(s, index_at(0.57), index_at(0.68));
    const int hip = largest_girth(s, crotch, waist_guess);
    const int bust = find_bust(s, waist_guess, armpit);
    const int waist = smallest_girth(s, hip, bust);
    const int head = largest_girth(s, index_at(0.90), index_at(0.99));
    const int neck = smallest_girth(s, armpit, head);

    BodyMeasures m;
    m.height = frame.height;
    m.crotch_y = s[crotch].y;
    m.armpit_y = s[armpit].y;
    m.hip_y = s[hip].y;
    m.waist_y = s[waist].y;
    m.bust_y = s[bust].y;
    m.neck_y = s[neck].y;
    m.hip = s[hip].girth;
    m.waist = s[waist].girth;
    m.bust = s[bust].girth;
    m.neck = s[neck].girth;
    return m;
}

double torso_girth(const TriMesh& body, double y) { return section_at(body, frame_of(body), y).girth; }

} // namespace toile

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sewing/form.h"

#include "geometry/isosurface.h"
#include "geometry/slice.h"
#include "sewing/avatar.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace toile {

namespace {

// The form is a field that is negative inside: limbs and torso are lofts of rounded sections, blended into each
// other. Dimensions are those of a person of 1.68 m; heights scale with the height, sections with the girths.
constexpr double drawn_height = 1.68;
constexpr double hip_level = 0.495 * drawn_height, waist_level = 0.632 * drawn_height,
                 bust_level = 0.723 * drawn_height, shoulder_level = 1.320;
constexpr double armpit_fillet = 0.05; // fillet between arm and torso

/// A section at station s along a loft's axis: centre and half width along the first axis across, front and back
/// along the second, exponent of the rounded shape (2: ellipse; larger: boxier).
struct Section {
    double s, centre, half, front, back, power;
};

/// Tangents of a cubic through the knots that does not overshoot them (Fritsch, Butland 1984).
std::vector<double> tangents(const std::vector<double>& s, const std::vector<double>& v) {
    const size_t n = s.size();
    std::vector<double> m(n, 0);
    for (size_t i = 1; i + 1 < n; ++i) {
        const double h0 = s[i] - s[i - 1], h1 = s[i + 1] - s[i];
        const double d0 = (v[i] - v[i - 1]) / h0, d1 = (v[i + 1] - v[i]) / h1;
        if (d0 * d1 > 0) m[i] = 3 * (h0 + h1) / ((2 * h1 + h0) / d0 + (h1 + 2 * h0) / d1);
    }
    return m;
}

double cubic_at(const std::vector<double>& s, const std::vector<double>& v, const std::vector<double>& m, double at) {
    size_t i = 0;
    while (i + 2 < s.size() && at > s[i + 1]) ++i;
    const double h = s[i + 1] - s[i], t = std::clamp((at - s[i]) / h, 0.0, 1.0), u = 1 - t;
    return u * u * (1 + 2 * t) * v[i] + t * t * (1 + 2 * u) * v[i + 1] + h * t * u * (u * m[i] - t * m[i + 1]);
}

/// A body of smoothly changing sections along a straight axis, with rounded ends.
class Loft {
public:
    Loft(const Vec3& origin, const Vec3& axis, const Vec3& across, std::vector<Section> knots, double cap)
        : origin_(origin), axis_(axis.normalized()), cap_(cap) {
        across_ = (across - across.dot(axis_) * axis_).normalized();
        forward_ = across_.cross(axis_);
        tabulate(knots);
    }

    double operator()(const Vec3& point) const {
        const Vec3 p = point - origin_;
        const double s = p.dot(axis_), x = p.dot(across_), z = p.dot(forward_);
        const double radius = reach(s, x, z);
        // Over a length as wide as a blend, so that the ends of a loft leave no crease in it.
        constexpr double wide = 0.02;
        const double steep = std::clamp((reach(s + wide, x, z) - reach(s - wide, x, z)) / (2 * wide), -0.7, 0.7);
        const double beyond = std::max({0.0, first_ - s, s - last_});
        const Row row = at(s);
        const double off = std::hypot(x - row.centre, z - middle(row));
        return past_outline(off, beyond, radius) / std::sqrt(1 + steep * steep);
    }

    /// At most the distance from the point; quickly found.
    double lower_bound(const Vec3& point) const {
        const Vec3 p = point - origin_;
        const double s = p.dot(axis_), nearest = std::clamp(s, first_, last_);
        return std::sqrt(std::max(0.0, p.squaredNorm() - s * s) + (s - nearest) * (s - nearest)) - farthest_;
    }

private:
    struct Row {
        double centre, half, front, back, power;
    };

    static double middle(const Row& r) { return 0.5 * (r.front + r.back); }

    /// Past the last section, the end is half an ellipse of length cap_.
    double past_outline(double off, double beyond, double radius) const {
        if (beyond == 0) return off - radius;
        return (1 - 1 / std::hypot(off / radius, beyond / cap_)) * std::hypot(off, beyond);
    }

    /// Distance of the outline from the section's middle in the direction of (x, z).
    double reach(double s, double x, double z) const {
        const Row r = at(s);
        const double dx = std::abs(x - r.centre), dz = std::abs(z - middle(r)), depth = 0.5 * (r.front - r.back);
        const double off = std::hypot(dx, dz);
        if (off < 1e-9) return std::min(r.half, depth);
        const double u = dx / r.half, v = dz / depth;
        if (r.power == 2) return off / std::sqrt(u * u + v * v);
        return off / std::pow(std::pow(u, r.power) + std::pow(v, r.power), 1 / r.power);
    }

    Row at(double s) const {
        const double u = std::clamp((s - first_) / (last_ - first_), 0.0, 1.0) * (rows - 1);
        const int i = std::min(int(u), rows - 2);
        const double t = u - i;
        const Row &a = table_[i], &b = table_[i + 1];
        const auto mix = [t](double p, double q) { return p + t * (q - p); };
        return {mix(a.centre, b.centre), mix(a.half, b.half), mix(a.front, b.front), mix(a.back, b.back),
                mix(a.power, b.power)};
    }

    void tabulate(const std::vector<Section>& knots) {
        std::vector<double> s;
        for (const Section& k : knots) s.push_back(k.s);
        first_ = s.front();
        last_ = s.back();
        step_ = (last_ - first_) / (rows - 1);
        table_.resize(rows);
        const std::array<double Section::*, 5> from{&Section::centre, &Section::half, &Section::front, &Section::back,
                                                    &Section::power};
        const std::array<double Row::*, 5> to{&Row::centre, &Row::half, &Row::front, &Row::back, &Row::power};
        for (int c = 0; c < 5; ++c) {
            std::vector<double> v;
            for (const Section& k : knots) v.push_back(k.*from[c]);
            const std::vector<double> m = tangents(s, v);
            for (int i = 0; i < rows; ++i) table_[i].*to[c] = cubic_at(s, v, m, first_ + i * step_);
        }
        farthest_ = cap_;
        for (const Row& r : table_)
            farthest_ = std::max(farthest_, std::hypot(std::abs(r.centre) + r.half, std::max(r.front, -r.back)));
    }

    static constexpr int rows = 200;
    Vec3 origin_, axis_, across_, forward_;
    double first_ = 0, last_ = 0, step_ = 0, cap_, farthest_ = 0;
    std::vector<Row> table_;
};

double ellipsoid(const Vec3& p, const Vec3& centre, const Vec3& radii) {
    const Vec3 d = p - centre;
    const double scaled = d.cwiseQuotient(radii).norm();
    return scaled == 0 ? -radii.minCoeff() : (1 - 1 / scaled) * d.norm();
}

/// The union of two bodies with a fillet of about the size `k`; smooth to the second derivative, so that no line
/// shows where the fillet begins.
double blend(double a, double b, double k) {
    const double h = std::max(1.5 * k - std::abs(a - b), 0.0) / (1.5 * k);
    return std::min(a, b) - 0.25 * k * h * h * h;
}

/// Factors on the drawn torso's sections at hip, waist and bust.
struct Girths {
    double hip = 1, waist = 1, bust = 1;
};

class Form {
public:
    Form(double height, const Girths& girths) : up_(height / drawn_height), girths_(girths), arms_(0.45 + 0.55 * girths.bust),
          legs_(0.45 + 0.55 * girths.hip) {
        build_torso();
        build_neck();
        build_leg();
        build_arm();
    }

    /// Negative inside. Symmetric: the right half is the left half's mirror image.
    double operator()(const Vec3& point) const {
        const Vec3 p(std::abs(point.x()), point.y(), point.z());
        double d = torso_[0](p);
        d = blend(d, pair(p, breast_, breast_radii_, 0.05 * girths_.bust), 0.05 * girths_.bust);
        d = blend(d, pair(p, buttock_, buttock_radii_, 0.04 * girths_.hip), 0.06 * girths_.hip);
        d = with(d, girdle_[0], p, 0.06 * arms_);
        d = legs(d, p);
        d = with(d, arm_[0], p, armpit_fillet * arms_);
        d = with(d, neck_[0], p, 0.045);
        return blend(d, head(p), 0.03);
    }

    double up() const { return up_; }
    double reach() const { return hand_x_; }

private:
    /// d blended with a part, which is left out where it is too far away to matter.
    static double with(double d, const Loft& part, const Vec3& p, double k) {
        return part.lower_bound(p) > d + 1.5 * k ? d : blend(d, part(p), k);
    }

    /// An ellipsoid and its mirror image.
    static double pair(const Vec3& p, const Vec3& centre, const Vec3& radii, double k) {
        return blend(ellipsoid(p, centre, radii), ellipsoid(Vec3(-p.x(), p.y(), p.z()), centre, radii), k);
    }

    double factor(double level) const {
        const std::vector<double> s{0.40, hip_level, waist_level, bust_level, 0.80 * drawn_height, 0.86 * drawn_height};
        const std::vector<double> v{girths_.hip, girths_.hip, girths_.waist, girths_.bust, girths_.bust,
                                    0.5 + 0.5 * girths_.bust};
        return cubic_at(s, v, tangents(s, v), level);
    }

    std::vector<Section> scaled(std::vector<Section> knots) const {
        for (Section& k : knots) {
            const double m = factor(k.s), middle = 0.5 * (k.front + k.back), depth = 0.5 * (k.front - k.back);
            k.half *= m;
            k.front = middle + m * depth;
            k.back = middle - m * depth;
            k.s *= up_;
        }
        return knots;
    }

    void build_torso() {
        torso_.emplace_back(Vec3::Zero(), Vec3::UnitY(), Vec3::UnitX(),
                            scaled({{0.772, 0, 0.058, 0.042, -0.040, 2.0},
                                    {0.796, 0, 0.102, 0.072, -0.074, 2.0},
                                    {0.832, 0, 0.146, 0.093, -0.098, 2.2},
                                    {0.870, 0, 0.157, 0.099, -0.101, 2.3},
                                    {0.910, 0, 0.154, 0.103, -0.096, 2.3},
                                    {0.985, 0, 0.139, 0.102, -0.083, 2.3},
                                    {1.062, 0, 0.123, 0.097, -0.076, 2.2},
                                    {1.120, 0, 0.128, 0.097, -0.086, 2.2},
                                    {1.165, 0, 0.135, 0.097, -0.096, 2.3},
                                    {1.215, 0, 0.142, 0.098, -0.104, 2.3},
                                    {1.270, 0, 0.146, 0.088, -0.108, 2.3},
                                    {1.320, 0, 0.140, 0.068, -0.107, 2.2},
                                    {1.365, 0, 0.115, 0.045, -0.098, 2.1},
                                    {1.405, 0, 0.080, 0.030, -0.085, 2.0},
                                    {1.430, 0, 0.055, 0.025, -0.075, 2.0}}),
                            0.02);
        const double b = girths_.bust, h = girths_.hip;
        breast_ = Vec3(0.070 * b, up_ * 1.216, -0.003 + 0.066 * b);
        breast_radii_ = Vec3(0.072 * b, 0.075 * std::min(up_, 1.4 * b), 0.064 * b);
        buttock_ = Vec3(0.070 * h, up_ * 0.840, -0.003 - 0.060 * h);
        buttock_radii_ = Vec3(0.080 * h, 0.095 * up_, 0.070 * h);
    }

    void build_neck() {
        const double n = 0.6 + 0.4 * arms_;
        std::vector<Section> knots{{1.370, 0, 0.062, 0.026, -0.086, 2}, {1.415, 0, 0.053, 0.032, -0.073, 2},
                                   {1.450, 0, 0.046, 0.034, -0.058, 2}, {1.490, 0, 0.044, 0.041, -0.050, 2},
                                   {1.540, 0, 0.045, 0.046, -0.048, 2}};
        for (Section& k : knots) {
            k.s *= up_;
            k.half *= n;
            k.front *= n;
            k.back *= n;
        }
        neck_.emplace_back(Vec3::Zero(), Vec3::UnitY(), Vec3::UnitX(), knots, 0.02);
    }

    double head(const Vec3& p) const {
        const double s = 0.35 + 0.65 * up_; // heads vary less than heights
        const double top = drawn_height * up_;
        const double skull = ellipsoid(p, Vec3(0, top - 0.095 * s, 0.012), s * Vec3(0.075, 0.095, 0.098));
        const double face = ellipsoid(p, Vec3(0, top - 0.148 * s, 0.042), s * Vec3(0.058, 0.084, 0.066));
        return blend(skull, face, 0.04);
    }

    void build_leg() {
        std::vector<Section> knots{{0.070, 0.111, 0.032, 0.031, -0.049, 2}, {0.095, 0.111, 0.033, 0.030, -0.048, 2},
                                   {0.200, 0.108, 0.042, 0.031, -0.060, 2}, {0.335, 0.104, 0.054, 0.041, -0.072, 2},
                                   {0.420, 0.101, 0.052, 0.048, -0.058, 2}, {0.480, 0.100, 0.055, 0.056, -0.053, 2},
                                   {0.590, 0.097, 0.067, 0.068, -0.070, 2}, {0.680, 0.094, 0.073, 0.079, -0.087, 2},
                                   {0.735, 0.093, 0.073, 0.082, -0.094, 2}, {0.770, 0.090, 0.076, 0.086, -0.098, 2},
                                   {0.800, 0.081, 0.084, 0.087, -0.098, 2}, {0.830, 0.076, 0.085, 0.084, -0.094, 2},
                                   {0.870, 0.071, 0.078, 0.070, -0.080, 2}, {0.930, 0.062, 0.055, 0.040, -0.050, 2}};
        for (Section& k : knots) {
            // Below the knee legs differ less than thighs do.
            const double t = std::clamp((k.s - 0.3) / 0.45, 0.0, 1.0);
            const double m = (1 - t) * (0.5 + 0.5 * legs_) + t * girths_.hip;
            k.s *= up_;
            k.centre *= m;
            k.half *= m;
            k.front *= m;
            k.back *= m;
        }
        leg_.emplace_back(Vec3::Zero(), Vec3::UnitY(), Vec3::UnitX(), knots, 0.015);
        for (Section& k : knots) k.centre = -k.centre;
        leg_.emplace_back(Vec3::Zero(), Vec3::UnitY(), Vec3::UnitX(), knots, 0.015);

        const double f = 0.35 + 0.65 * up_, x = 0.112 * (0.5 + 0.5 * legs_);
        foot_.emplace_back(Vec3(x, 0, 0), Vec3(0.14, 0, 1), -Vec3::UnitX(),
                           std::vector<Section>{{-0.040 * f, 0, 0.030, 0.060, 0, 2.4},
                                                {0.015 * f, 0, 0.032, 0.078, 0, 2.4},
                                                {0.070 * f, 0, 0.039, 0.058, 0, 2.5},
                                                {0.115 * f, 0, 0.043, 0.042, 0, 2.5},
                                                {0.155 * f, 0, 0.036, 0.034, 0, 2.5}},
                           0.022);
    }

    double legs(double torso, const Vec3& p) const {
        const double k = 0.04 * legs_;
        if (std::min(leg_[0].lower_bound(p), foot_[0].lower_bound(p)) > torso + 1.5 * k) return torso;
        const double left = with(leg_[0](p), foot_[0], p, 0.03);
        // The two legs meet at the crotch with a fillet of their own.
        return blend(torso, with(left, leg_[1], p, 0.02), k);
    }

    /// Arms keep clear of the torso wherever they pass it: shoulders are as wide as that needs.
    double shoulder_x() const {
        double x = 0.160 * (0.6 * up_ + 0.4 * girths_.bust);
        const auto clear = [&](double level, double half) {
            const double out = up_ * (shoulder_level - level); // an arm falls as much as it goes out
            x = std::max(x, half + 1.42 * 0.053 * arms_ + 0.6 * armpit_fillet * arms_ + 0.01 - out);
        };
        clear(bust_level, 0.150 * girths_.bust);
        clear(waist_level, 0.130 * girths_.waist);
        clear(hip_level + 0.03, 0.175 * girths_.hip);
        return x;
    }

    void build_arm() {
        const Vec3 shoulder(shoulder_x(), up_ * shoulder_level, -0.034);
        std::vector<Section> knots{{0.000, 0, 0.043, 0.048, -0.048, 2}, {0.080, 0, 0.049, 0.052, -0.052, 2},
                                   {0.150, 0, 0.045, 0.047, -0.047, 2}, {0.270, 0, 0.039, 0.040, -0.039, 2},
                                   {0.330, 0, 0.040, 0.040, -0.039, 2}, {0.420, 0, 0.033, 0.032, -0.031, 2},
                                   {0.500, 0, 0.025, 0.028, -0.027, 2}, {0.550, 0, 0.025, 0.033, -0.031, 2},
                                   {0.610, 0, 0.024, 0.034, -0.032, 2}, {0.665, 0, 0.021, 0.025, -0.024, 2}};
        for (Section& k : knots) {
            const double t = std::clamp((k.s - 0.30) / 0.25, 0.0, 1.0);
            const double m = (1 - t) * arms_ + t * (0.5 + 0.2 * arms_ + 0.3 * up_);
            k.s *= up_;
            k.half *= m;
            k.front *= m;
            k.back *= m;
        }
        const Vec3 along = Vec3(1, -1.03, 0.06).normalized();
        arm_.emplace_back(shoulder, along, Vec3(-1, -1, 0), knots, 0.030);
        hand_x_ = (shoulder + (knots.back().s + 0.06) * along).x() + 0.03;

        // From the neck to the shoulder: collar bone and trapezius.
        const Vec3 collar(0.02, up_ * 1.398, -0.036), end = shoulder + Vec3(0.01, 0.014, 0);
        const double length = (end - collar).norm(), g = 0.6 + 0.4 * arms_;
        girdle_.emplace_back(collar, end - collar, Vec3::UnitY(),
                             std::vector<Section>{{0, 0, 0.040 * g, 0.048 * g, -0.048 * g, 2},
                                                  {0.5 * length, 0, 0.038 * g, 0.050 * g, -0.050 * g, 2},
                                                  {length, 0, 0.040 * g, 0.050 * g, -0.050 * g, 2}},
                             0.04 * g);
    }

    double up_;
    Girths girths_;
    double arms_, legs_; ///< they grow with the torso, but less
    double hand_x_ = 0;
    std::vector<Loft> torso_, neck_, leg_, foot_, arm_, girdle_;
    Vec3 breast_, breast_radii_, buttock_, buttock_radii_;
};

/// Girth of the torso at a level, by rays from its middle in one half.
double girth(const Form& form, double y) {
    constexpr int rays = 60;
    std::vector<Vec2> outline;
    for (int i = 0; i <= rays; ++i) {
        const double angle = EIGEN_PI * (double(i) / rays - 0.5);
        const Vec3 direction(std::cos(angle), 0, std::sin(angle)), middle(0, y, 0);
        double low = 0, high = 0.01;
        while (form(middle + high * direction) < 0 && high < 2) low = std::exchange(high, high + 0.02);
        for (int k = 0; k < 16; ++k) {
            const double mid = 0.5 * (low + high);
            (form(middle + mid * direction) < 0 ? low : high) = mid;
        }
        outline.emplace_back(low * direction.x(), low * direction.z());
        outline.emplace_back(-low * direction.x(), low * direction.z());
    }
    return hull_length(outline);
}

/// The factors with which the field has the girths asked for, from a first guess.
Girths fit(const FormMeasures& m, Girths g) {
    const FormLevels level = form_levels(m);
    for (int round = 0; round < 12; ++round) {
        const Form form(m.height, g);
        const double hip = m.hip / girth(form, level.hip_y), waist = m.waist / girth(form, level.waist_y),
                     bust = m.bust / girth(form, level.bust_y);
        g.hip *= hip;
        g.waist *= waist;
        g.bust *= bust;
        if (std::max({std::abs(hip - 1), std::abs(waist - 1), std::abs(bust - 1)}) < 1e-4) break;
    }
    return g;
}

TriMesh polygonise(const FormMeasures& m, const Form& form) {
    const double largest = std::max({m.bust, m.waist, m.hip}), depth = 0.12 + 0.2 * largest;
    const double side = std::max(form.reach(), 0.25 * largest + 0.05);
    const Eigen::AlignedBox3d box(Vec3(-side, -0.03, -depth), Vec3(side, m.height + 0.03, depth));
    // About as many points whatever the measures, but hands must not fall between the grid's corners.
    const double around = (m.bust + m.waist + m.hip) / (0.90 + 0.72 + 0.96), up = m.height / drawn_height;
    return isosurface(std::cref(form), box, {.cell = 0.0131 * std::min(std::sqrt(up * around), 1.1 * up)});
}

void expect_range(const char* name, double value, double low, double high) {
    if (value >= low && value <= high) return; // NaN fails
    throw std::invalid_argument("the form's " + std::string(name) + " is " + std::to_string(value) +
                                " m; expected " + std::to_string(low).substr(0, 3) + " to " +
                                std::to_string(high).substr(0, 3) + " m");
}

} // namespace

FormLevels form_levels(const FormMeasures& m) {
    const double up = m.height / drawn_height;
    return {up * bust_level, up * waist_level, up * hip_level};
}

TriMesh make_form(const FormMeasures& m) {
    expect_range("height", m.height, 1.2, 2.1);
    expect_range("bust", m.bust, 0.6, 1.5);
    expect_range("waist", m.waist, 0.5, 1.5);
    expect_range("hip", m.hip, 0.6, 1.6);
    // A sharp waist is wider in triangles than in the field; what is missing is asked of the field once more.
    const FormLevels level = form_levels(m);
    FormMeasures asked = m;
    Girths girths{m.hip / 0.96, m.waist / 0.72, m.bust / 0.90};
    for (int attempt = 0;; ++attempt) {
        girths = fit(asked, girths);
        const TriMesh body = polygonise(m, Form(m.height, girths));
        const double hip = m.hip / torso_girth(body, level.hip_y), waist = m.waist / torso_girth(body, level.waist_y),
                     bust = m.bust / torso_girth(body, level.bust_y);
        if (attempt == 2 || std::max({std::abs(hip - 1), std::abs(waist - 1), std::abs(bust - 1)}) < 0.003) return body;
        asked.hip *= hip;
        asked.waist *= waist;
        asked.bust *= bust;
    }
}

} // namespace toile

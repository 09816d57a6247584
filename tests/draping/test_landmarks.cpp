// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/landmarks.h"

#include "sewing/avatar.h"
#include "sewing/form.h"
#include "tests/support/shapes.h"
#include "tests/support/skirt.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace toile;

namespace {

constexpr int columns = 24, rows = 3;
constexpr double half_width = 0.09;

const TriMesh& form() {
    static const TriMesh body = make_form({});
    return body;
}

double neck_y(const TriMesh& body) {
    return measure_body(body).neck_y;
}

Vec3 nearest_point_of(const TriMesh& body, const Vec3& p) {
    return *std::min_element(body.points.begin(), body.points.end(), [&](const Vec3& a, const Vec3& b) {
        return (a - p).squaredNorm() < (b - p).squaredNorm();
    });
}

/// A tube of two panels whose upper border is a neckline, flat before and behind the form, and as it should
/// lie.
struct Top {
    StagedLevel staged;
    Garment sewn;
    Points x;
    std::vector<int> ring; ///< nodes of the neckline

    Neckline neckline() const { return find_neckline(staged, sewn, x, form()); }
    Landmark landmark(const std::string& label) const {
        for (const Landmark& l : find_landmarks(staged, sewn, x, neckline()))
            if (l.label == label) return l;
        throw std::runtime_error("no landmark " + label);
    }
    std::vector<std::string> sentences() const {
        return misplaced(find_landmarks(staged, sewn, x, neckline()), neckline());
    }
    void shift(const Vec3& by) {
        for (int node : ring)
            x[node] += by;
    }
};

Top make_top() {
    const auto open = test::make_skirt(columns, rows, half_width, 1.4, 0.3, false);
    const auto closed = test::make_skirt(columns, rows, half_width, 1.4, 0.3);
    Top top{{0.02, open.garment, open.x}, closed.garment, closed.x, {}};
    for (int p = 0; p < 2; ++p)
        for (int half = 0; half < 2; ++half) {
            BorderLine line{half == p ? "right_collar" : "left_collar", p, half, {}, {}};
            for (int i = half * columns / 2; i <= (half + 1) * columns / 2; ++i) {
                line.vertices.push_back((p * (rows + 1) + rows) * (columns + 1) + i);
                line.at.push_back(2.0 * i / columns - half);
            }
            for (Garment* g : {&top.staged.garment, &top.sewn})
                g->borders.push_back(line);
        }
    const double neck = neck_y(form());
    for (const BorderLine& line : top.sewn.borders)
        for (int v : line.vertices) {
            // Flat, the neckline dips from the neck points to the middle.
            Vec3& flat = top.staged.placed[v];
            flat = Vec3(flat.x(), 1.3 + std::abs(flat.x()), line.panel == 0 ? 0.3 : -0.3);
            Vec3& worn = top.x[top.sewn.node_of_vertex[v]];
            const bool is_neck_point = std::abs(flat.x()) > half_width - 1e-9;
            worn = is_neck_point ? *shoulder_ridge(form(), flat.x(), neck)
                                 : nearest_point_of(form(), Vec3(worn.x(), neck - 0.05, worn.z() - 0.03));
            top.ring.push_back(top.sewn.node_of_vertex[v]);
        }
    std::sort(top.ring.begin(), top.ring.end());
    top.ring.erase(std::unique(top.ring.begin(), top.ring.end()), top.ring.end());
    return top;
}

/// A skirt whose upper border, or whose side seam, is labelled as a waist; it lies where it was placed.
Top make_waist(bool at_side_seam) {
    const auto open = test::make_skirt(columns, rows, 0.13, 1.0, 0.3, false);
    const auto closed = test::make_skirt(columns, rows, 0.13, 1.0, 0.3);
    Top top{{0.02, open.garment, open.x}, closed.garment, closed.x, {}};
    for (int p = 0; p < 2; ++p) {
        BorderLine line{"lower_interface", p, 0, {}, {}};
        for (int k = 0; k <= (at_side_seam ? rows : columns); ++k) {
            line.vertices.push_back(at_side_seam
                                        ? (p * (rows + 1) + k) * (columns + 1) + (p == 0 ? columns : 0)
                                        : (p * (rows + 1) + rows) * (columns + 1) + k);
            line.at.push_back(double(k) / (at_side_seam ? rows : columns));
        }
        for (Garment* g : {&top.staged.garment, &top.sewn})
            g->borders.push_back(line);
    }
    return top;
}

bool says(const std::vector<std::string>& sentences, const std::string& words) {
    for (const std::string& s : sentences)
        if (s.find(words) != std::string::npos) return true;
    return false;
}

} // namespace

TEST_CASE("the ridge of the shoulder is the highest line beside the neck and falls outward") {
    for (const FormMeasures& m :
         {FormMeasures{}, FormMeasures{1.9, 1.1, 0.9, 1.1}, FormMeasures{1.5, 0.8, 0.6, 0.85}}) {
        const TriMesh body = make_form(m);
        const double neck = neck_y(body);
        double above = neck;
        for (double x = 0.07; x < 0.15; x += 0.01) {
            const auto left = shoulder_ridge(body, x, neck), right = shoulder_ridge(body, -x, neck);
            REQUIRE(left);
            REQUIRE(right);
            CHECK((*left - Vec3(-right->x(), right->y(), right->z())).norm() < 1e-3);
            double highest = 0, depth = 0; // of the points nearby
            for (const Vec3& p : body.points)
                if (std::abs(p.x() - x) < 0.005 && p.y() < neck && p.y() > highest)
                    highest = p.y(), depth = p.z();
            CHECK(left->y() == Approx(highest).margin(0.008));
            CHECK(left->z() == Approx(depth).margin(0.02));
            CHECK(left->y() < above);
            above = left->y();
        }
    }
    // Nearer to the axis than the neck's side: the middle of the neck at the height given.
    const auto inside = shoulder_ridge(form(), 0.02, neck_y(form()));
    REQUIRE(inside);
    CHECK(inside->y() == Approx(neck_y(form())));
    CHECK_FALSE(shoulder_ridge(form(), 3, 1.5));
}

TEST_CASE("a neckline on the shoulders is where it belongs, and one beside its place is off by as much") {
    Top top = make_top();
    CHECK(top.neckline().points.size() == 4); // two sides of two panels
    CHECK(top.neckline().round_neck);
    for (const std::string label : {"left_collar", "right_collar"}) {
        const Landmark l = top.landmark(label);
        CHECK(l.belongs == Belongs::neck);
        REQUIRE(l.off);
        CHECK(*l.off < 1e-3);
    }
    CHECK(top.sentences().empty());
    for (const Vec3& by : {Vec3(0.05, 0, 0), Vec3(0, 0.05, 0), Vec3(0, 0, -0.05), Vec3(0, -0.03, 0.04)}) {
        Top shifted = make_top();
        shifted.shift(by);
        for (const std::string label : {"left_collar", "right_collar"}) {
            CHECK(*shifted.landmark(label).off == Approx(0.05).margin(1e-3));
            CHECK(says(shifted.sentences(), "\"" + label + "\" lie 5.0 cm from their place at the neck"));
        }
    }
}

TEST_CASE("a neckline that stands off the body between its neck points is off by its mean distance") {
    Top top = make_top();
    const Points before = top.x;
    top.shift(Vec3(0, 0.1, 0.2));
    for (const NeckPoint& p : top.neckline().points)
        top.x[p.node] = before[p.node];
    const Landmark l = top.landmark("left_collar");
    CHECK(*l.off == top.neckline().from_body.at("left_collar"));
    CHECK(*l.off > 0.05);
    CHECK(*l.off < 0.2);
}

TEST_CASE("a neckline beside the neck does not go round it") {
    Top top = make_top();
    top.shift(Vec3(0.2, 0, 0));
    CHECK_FALSE(top.neckline().round_neck);
    CHECK(says(top.sentences(), "does not go round the neck"));
}

TEST_CASE("one label may have the neck points of both sides") {
    Top top = make_top();
    for (Garment* g : {&top.staged.garment, &top.sewn})
        for (BorderLine& line : g->borders)
            line.label = "collar";
    CHECK(top.neckline().points.size() == 4);
    CHECK(*top.landmark("collar").off < 1e-3);
}

TEST_CASE("an open edge that carries its garment belongs at the file's height, a seam inside is carried") {
    Top skirt = make_waist(false);
    CHECK(skirt.landmark("lower_interface").belongs == Belongs::file_height);
    CHECK(*skirt.landmark("lower_interface").off == Approx(0).margin(1e-12));
    CHECK(skirt.sentences().empty());
    for (Vec3& p : skirt.x)
        p.y() -= 0.05;
    CHECK(*skirt.landmark("lower_interface").off == Approx(0.05));
    CHECK(says(skirt.sentences(), "\"lower_interface\" lie 5.0 cm from their height in the file"));

    Top dress = make_waist(true);
    for (Vec3& p : dress.x)
        p.y() -= 0.05;
    CHECK(dress.landmark("lower_interface").belongs == Belongs::carried);
    CHECK_FALSE(dress.landmark("lower_interface").off);
    CHECK(dress.sentences().empty());
}

TEST_CASE("what cannot be judged is not") {
    Top top = make_top();
    for (Garment* g : {&top.staged.garment, &top.sewn})
        g->borders[0].label = "left_armhole";
    CHECK(top.landmark("left_armhole").belongs == Belongs::anywhere);
    CHECK_FALSE(top.landmark("left_armhole").off);
    const Neckline none = find_neckline(top.staged, top.sewn, top.x, test::sphere(0.2, 3));
    CHECK_FALSE(none.found);
    for (const Landmark& l : find_landmarks(top.staged, top.sewn, top.x, none))
        CHECK_FALSE(l.off);
    CHECK(misplaced(find_landmarks(top.staged, top.sewn, top.x, none), none).empty());
}

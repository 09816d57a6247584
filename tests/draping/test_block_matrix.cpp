// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/algebra/cholesky.h"
#include "geometry/parallel.h"

#include <catch2/catch.hpp>

#include <Eigen/Dense>

using namespace toile;

namespace {

struct Filled {
    BlockMatrix sparse;
    Eigen::MatrixXd dense;
};

// A chain of points, each coupled to the next and to the one after.
std::vector<std::pair<int, int>> chain(int points) {
    std::vector<std::pair<int, int>> pairs;
    for (int i = 0; i < points; ++i)
        for (int k = 1; k <= 2 && i + k < points; ++k) pairs.emplace_back(i, i + k);
    return pairs;
}

// The sides and one diagonal of the squares of a grid, as cloth has them.
std::vector<std::pair<int, int>> grid(int side) {
    std::vector<std::pair<int, int>> pairs;
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) {
            const int here = i * side + j;
            if (j + 1 < side) pairs.emplace_back(here, here + 1);
            if (i + 1 < side) pairs.emplace_back(here, here + side);
            if (i + 1 < side && j + 1 < side) pairs.emplace_back(here, here + side + 1);
        }
    return pairs;
}

/// Springs between the points of each pair, which `spring` gives.
BlockMatrix sprung(int points, const std::vector<std::pair<int, int>>& pairs, auto&& spring) {
    BlockMatrix a(points, pairs);
    for (const auto& [j, i] : pairs) {
        const Mat3 s = spring(j, i);
        a.add_off_diagonal(std::min(i, j), a.find(std::max(i, j), std::min(i, j)), -s);
        a.add_diagonal(i, s);
        a.add_diagonal(j, s);
    }
    return a;
}

Mat3 unit_spring(int, int) { return Mat3::Identity(); }

// Random blocks made diagonally dominant.
Filled filled(int points) {
    const std::vector<std::pair<int, int>> pairs = chain(points);
    Filled f{BlockMatrix(points, pairs), Eigen::MatrixXd::Zero(3 * points, 3 * points)};
    unsigned seed = 7;
    const auto random = [&seed] {
        seed = seed * 1664525u + 1013904223u;
        return double(seed >> 8) / double(1u << 24) - 0.5;
    };
    const auto block = [&] {
        Mat3 m;
        for (int k = 0; k < 9; ++k) m(k / 3, k % 3) = random();
        return m;
    };
    for (const auto& [j, i] : pairs) {
        const Mat3 m = block();
        f.sparse.add_off_diagonal(j, f.sparse.find(i, j), m);
        f.dense.block<3, 3>(3 * i, 3 * j) += m;
        f.dense.block<3, 3>(3 * j, 3 * i) += m.transpose();
    }
    for (int i = 0; i < points; ++i) {
        const Mat3 m = block();
        const Mat3 s = m * m.transpose() + 8 * Mat3::Identity();
        f.sparse.add_diagonal(i, s);
        f.dense.block<3, 3>(3 * i, 3 * i) += s;
    }
    return f;
}

} // namespace

TEST_CASE("a block matrix multiplies, shifts, pins and factors as its dense twin") {
    const int points = 23;
    Filled f = filled(points);
    const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(3 * points, -1, 2);
    Eigen::VectorXd y;
    f.sparse.multiply(x, y);
    CHECK((y - f.dense * x).norm() < 1e-12 * y.norm());

    const Eigen::VectorXd shift = Eigen::VectorXd::LinSpaced(3 * points, 0.5, 1);
    f.sparse.add_to_diagonal(shift);
    f.dense.diagonal() += shift;
    std::vector<char> pinned(points, 0);
    pinned[3] = pinned[22] = 1;
    f.sparse.pin(pinned);
    for (int i : {3, 22}) {
        f.dense.middleRows<3>(3 * i).setZero();
        f.dense.middleCols<3>(3 * i).setZero();
        f.dense.block<3, 3>(3 * i, 3 * i).setIdentity();
    }
    f.sparse.multiply(x, y);
    CHECK((y - f.dense * x).norm() < 1e-12 * y.norm());

    Cholesky cholesky;
    for (const bool keep_order : {false, true}) {
        cholesky.analyse(f.sparse, keep_order);
        REQUIRE(cholesky.factorise(f.sparse));
        Eigen::VectorXd solved;
        cholesky.solve(x, solved);
        CHECK((f.dense * solved - x).norm() < 1e-11 * x.norm());
    }
    CHECK(f.sparse.find(10, 5) == -1);
}

TEST_CASE("a matrix that is not positive definite is told by its factorisation") {
    Filled f = filled(5);
    f.sparse.add_to_diagonal(Eigen::VectorXd::Constant(15, -40));
    Cholesky cholesky;
    cholesky.analyse(f.sparse);
    CHECK_FALSE(cholesky.factorise(f.sparse));
    CHECK_FALSE(cholesky.factorise_preconditioner(f.sparse));
}

TEST_CASE("a preconditioner solves as the exact factor does, with the same bits for any number of threads") {
    const int side = 70, rows = 3 * side * side;
    const auto pairs = grid(side);
    BlockMatrix a = sprung(side * side, pairs, [](int j, int i) -> Mat3 {
        return (Vec3(1, 0.3 * (i % 7), 0.1 * (j % 5)).asDiagonal()) * 50.0;
    });
    Cholesky cholesky;
    cholesky.analyse(a);
    for (const double shift : {0.5, 5.0}) { // a new factor is not solved with the old one
        a.add_to_diagonal(Eigen::VectorXd::Constant(rows, shift));
        const Eigen::VectorXd b = 1e-9 * Eigen::VectorXd::LinSpaced(rows, -1, 3);
        Eigen::VectorXd exact, fast, again;
        REQUIRE(cholesky.factorise(a));
        cholesky.solve(b, exact);
        REQUIRE(cholesky.factorise_preconditioner(a));
        cholesky.precondition(b, fast);
        CHECK((fast - exact).norm() < 1e-4 * exact.norm());
        set_threads(1);
        REQUIRE(cholesky.factorise_preconditioner(a));
        cholesky.precondition(b, again);
        set_threads(0);
        CHECK(fast == again);
        cholesky.precondition(Eigen::VectorXd::Zero(rows), again);
        CHECK(again == Eigen::VectorXd::Zero(rows));
    }
}

TEST_CASE("a matrix of several pieces is factored like any other") {
    for (const int pieces : {2, 3, 7, 30}) {
        const int side = 25, points = pieces * side * side;
        std::vector<std::pair<int, int>> pairs;
        for (int piece = 0; piece < pieces; ++piece)
            for (const auto& [j, i] : grid(side)) pairs.emplace_back(piece * side * side + j, piece * side * side + i);
        BlockMatrix a = sprung(points, pairs, unit_spring);
        a.add_to_diagonal(Eigen::VectorXd::Constant(3 * points, 0.1));
        Cholesky cholesky;
        cholesky.analyse(a);
        const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(3 * points, -1, 3);
        Eigen::VectorXd exact, fast;
        REQUIRE(cholesky.factorise(a));
        cholesky.solve(b, exact);
        REQUIRE(cholesky.factorise_preconditioner(a));
        cholesky.precondition(b, fast);
        CHECK((fast - exact).norm() < 1e-4 * exact.norm());
    }
}

TEST_CASE("a matrix that is definite in double precision alone is a preconditioner too, time and again") {
    const int side = 40, points = side * side;
    // Free to move, so that rounding to single precision decides whether it is definite; here it is not.
    BlockMatrix a = sprung(points, grid(side), [](int j, int i) -> Mat3 { return (1 + (7 * i + 3 * j) % 11 / 9.0) * Mat3::Identity(); });
    a.add_to_diagonal(Eigen::VectorXd::Constant(3 * points, 1e-9));
    Cholesky cholesky;
    cholesky.analyse(a);
    Eigen::VectorXd exact, again, fast, b(3 * points);
    for (int i = 0; i < b.size(); ++i) b[i] = i % 2 ? -1 : 1; // of no force on the whole
    REQUIRE(cholesky.factorise(a));
    cholesky.solve(b, exact);
    for (int k = 0; k < 2; ++k) {
        REQUIRE(cholesky.factorise_preconditioner(a));
        cholesky.precondition(b, fast);
        CHECK(std::abs(fast.dot(b) / exact.dot(b) - 1) < 1e-3);
    }
    REQUIRE(cholesky.factorise(a));
    cholesky.solve(b, again);
    CHECK(again == exact);
}

TEST_CASE("an order is kept until what has come since makes it a poor one") {
    const int side = 20, points = side * side;
    Cholesky cholesky;
    cholesky.analyse(BlockMatrix(points, grid(side)));
    const double new_order = cholesky.work();
    // Sheets folded onto each other ever more: each pattern is factored with the order of the one before, or a new one.
    for (int folded = 1; folded < side / 2; ++folded) {
        auto pairs = grid(side);
        for (int i = 0; i < folded * side; ++i) pairs.emplace_back(i, points - 1 - i);
        BlockMatrix a = sprung(points, pairs, unit_spring);
        a.add_to_diagonal(Eigen::VectorXd::Constant(3 * points, 0.1));
        cholesky.analyse(a, true);
        Cholesky fresh;
        fresh.analyse(a);
        CHECK(cholesky.work() < 2.5 * fresh.work());
        REQUIRE(cholesky.factorise(a));
        const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(3 * points, -1, 3);
        Eigen::VectorXd x, product;
        cholesky.solve(b, x);
        a.multiply(x, product);
        CHECK((product - b).norm() < 1e-9 * b.norm());
    }
    CHECK(cholesky.work() > new_order);
}

TEST_CASE("a matrix too stiff for single precision still has a positive definite preconditioner") {
    const int points = 400;
    // Stiff springs, held in their place by almost nothing.
    BlockMatrix a = sprung(points, chain(points), [](int, int) -> Mat3 { return 1e9 * Mat3::Identity(); });
    a.add_to_diagonal(Eigen::VectorXd::Constant(3 * points, 1e-3));
    Cholesky cholesky;
    cholesky.analyse(a);
    REQUIRE(cholesky.factorise_preconditioner(a));
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(3 * points, -1, 3);
    Eigen::VectorXd x;
    cholesky.precondition(b, x);
    CHECK(x.allFinite());
    CHECK(b.dot(x) > 0);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Collision detection: what the two tests of moving pairs miss, what they report without cause and what they
// cost, on the reference queries and on random ones against exact arithmetic; and how the search for near
// pairs grows.
//   ccd [number of random queries [seed]]
// The reference queries are left out when TOILE_TEST_DATA is not set. Exits with 1 when time_of_impact misses
// a contact; the query is printed with its exact coordinates.
#include "geometry/bvh.h"
#include "geometry/edges.h"
#include "tests/support/ccd_queries.h"
#include "tests/support/surfaces.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>

using namespace toile;
using test::CcdFamily;
using test::PairKind;

namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Query {
    PairKind kind;
    Motion motion;
    double size; ///< lengths are in units of it
    bool touch;  ///< the truth
};

struct Method {
    const char* name;
    bool (*touch)(const Query&);
};

const Method methods[] = {
    {"toi, 0", [](const Query& q) { return test::toi_touch(q.kind, q.motion, 0); }},
    {"toi, 1e-6", [](const Query& q) { return test::toi_touch(q.kind, q.motion, 1e-6 * q.size); }},
    {"cubic, 0", [](const Query& q) { return test::cubic_touch(q.kind, q.motion, 0); }},
    {"cubic, 1e-6", [](const Query& q) { return test::cubic_touch(q.kind, q.motion, 1e-6 * q.size); }},
};
constexpr int method_count = int(std::size(methods));

struct Tally {
    long queries = 0, contacts = 0;
    std::array<long, method_count> missed{}, false_alarms{};
    std::array<double, method_count> seconds{};

    void add(const Tally& other) {
        queries += other.queries;
        contacts += other.contacts;
        for (int k = 0; k < method_count; ++k) {
            missed[k] += other.missed[k];
            false_alarms[k] += other.false_alarms[k];
            seconds[k] += other.seconds[k];
        }
    }
};

/// Counts and times every method on queries whose truth is known; `repeat` times for the clock.
Tally judge(const std::vector<Query>& queries, int repeat, const std::function<void(const Query&)>& on_miss) {
    Tally tally;
    tally.queries = long(queries.size());
    for (const Query& q : queries)
        tally.contacts += q.touch;
    std::vector<char> found(queries.size());
    for (int k = 0; k < method_count; ++k) {
        const auto start = std::chrono::steady_clock::now();
        for (int r = 0; r < repeat; ++r)
            for (std::size_t i = 0; i < queries.size(); ++i)
                found[i] = methods[k].touch(queries[i]);
        tally.seconds[k] = seconds_since(start) / repeat;
        for (std::size_t i = 0; i < queries.size(); ++i) {
            const bool truth = queries[i].touch;
            tally.missed[k] += truth && !found[i];
            tally.false_alarms[k] += found[i] && !truth;
            if (truth && !found[i] && k < 2) on_miss(queries[i]);
        }
    }
    return tally;
}

const char* name_of(PairKind kind) {
    return kind == PairKind::point_triangle ? "point-triangle" : "edge-edge";
}

void print_head(const char* first) {
    std::printf("| %s | queries | contacts |", first);
    for (const Method& m : methods)
        std::printf(" %s |", m.name);
    std::printf("\n|---|---:|---:|");
    for (int k = 0; k < method_count; ++k)
        std::printf("---:|");
    std::puts("");
}

void print_counts(const std::string& name, const Tally& t) {
    std::printf("| %s | %ld | %ld |", name.c_str(), t.queries, t.contacts);
    for (int k = 0; k < method_count; ++k)
        std::printf(" %ld / %ld |", t.missed[k], t.false_alarms[k]);
    std::puts("");
}

void print_times(const std::string& name, const Tally& t) {
    std::printf("| %s | %ld | %ld |", name.c_str(), t.queries, t.contacts);
    for (int k = 0; k < method_count; ++k)
        std::printf(" %.0f |", 1e9 * t.seconds[k] / double(std::max(1L, t.queries)));
    std::puts("");
}

void print_query(const char* what, const Query& q) {
    std::printf("%s: %s\n", what, name_of(q.kind));
    for (int k = 0; k < 4; ++k)
        std::printf("  x = %a %a %a  dx = %a %a %a\n", q.motion.x[k][0], q.motion.x[k][1], q.motion.x[k][2],
                    q.motion.dx[k][0], q.motion.dx[k][1], q.motion.dx[k][2]);
}

/// Contacts that time_of_impact passed: misses, and those before the time up to which it let the pair move.
long bad = 0;

void report(const char* what, const Query& q) {
    if (++bad <= 20) print_query(what, q);
}

void on_miss(const Query& q) {
    report("missed", q);
}

/// By kind of pair.
using Tallies = std::array<Tally, 2>;

Tallies reference_queries(const std::string& folder) {
    std::array<std::vector<Query>, 2> queries;
    for (const test::CcdQuery& q : test::read_ccd_queries(folder))
        queries[int(q.kind)].push_back({q.kind, test::motion_between(q.from, q.to), 1, q.touch});
    return {judge(queries[0], 50, on_miss), judge(queries[1], 50, on_miss)};
}

/// Whether the pair touches on the part of its motion that is allowed when a tenth of the distance is to be
/// kept, as draping asks it.
bool passes_contact(const Query& q) {
    const double t = q.kind == PairKind::point_triangle ? time_of_impact_point_triangle(q.motion, {})
                                                        : time_of_impact_edge_edge(q.motion, {});
    if (t == 0) return false;
    Motion allowed = q.motion;
    for (Vec3& d : allowed.dx)
        d *= t;
    return test::exactly_touch(q.kind, allowed);
}

void random_queries(long count, std::uint64_t seed) {
    constexpr int families = int(CcdFamily::count), batch = 500;
    std::array<Tallies, families> tallies;
    test::Random random(seed);
    const auto start = std::chrono::steady_clock::now();
    long done = 0, late = 0;
    for (int b = 0; done < count; ++b) {
        const auto family = CcdFamily(b / 2 % families);
        const auto kind = PairKind(b % 2);
        std::vector<Query> queries(std::min(long(batch), count - done));
        for (Query& q : queries) {
            q.kind = kind;
            q.motion = test::random_ccd_query(family, kind, random, q.size);
            q.touch = test::exactly_touch(kind, q.motion);
            if (q.touch && passes_contact(q)) {
                ++late;
                report("late", q);
            }
        }
        tallies[int(family)][int(kind)].add(judge(queries, 1, on_miss));
        done += long(queries.size());
    }
    const double seconds = seconds_since(start);
    Tallies all;
    std::printf("\n%ld random queries, seed %llu: missed / false alarms (tolerance relative to the size)\n\n",
                count, static_cast<unsigned long long>(seed));
    print_head("family");
    for (int f = 0; f < families; ++f)
        for (int k = 0; k < 2; ++k) {
            print_counts(std::string(test::name_of(CcdFamily(f))) + ", " + name_of(PairKind(k)),
                         tallies[f][k]);
            all[k].add(tallies[f][k]);
        }
    for (int k = 0; k < 2; ++k)
        print_counts(std::string("all, ") + name_of(PairKind(k)), all[k]);
    std::puts("\nnanoseconds per random query\n");
    print_head("kind");
    for (int k = 0; k < 2; ++k)
        print_times(name_of(PairKind(k)), all[k]);
    std::printf("\n%ld contacts within the motion that toi allows; %.0f queries per second, exact arithmetic "
                "included\n",
                late, double(count) / seconds);
}

} // namespace

int main(int argc, char** argv) {
    const long count = argc > 1 ? std::atol(argv[1]) : 100000;
    const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
    if (const char* data = std::getenv("TOILE_TEST_DATA"); data && *data) {
        const Tallies t = reference_queries(std::string(data) + "/../reference/ccd");
        std::puts("reference queries: missed / false alarms\n");
        print_head("kind");
        for (int k = 0; k < 2; ++k)
            print_counts(name_of(PairKind(k)), t[k]);
        std::puts("\nnanoseconds per reference query\n");
        print_head("kind");
        for (int k = 0; k < 2; ++k)
            print_times(name_of(PairKind(k)), t[k]);
    }
    random_queries(count, seed);
    return bad != 0;
}

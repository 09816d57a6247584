// SPDX-License-Identifier: GPL-3.0-or-later
// Collision detection: what the tests of moving pairs miss, what they report without cause and what they
// cost, on the reference queries and on random ones against exact arithmetic; and how the search for near
// pairs grows.
//   bench_ccd [number of random queries [seed]]
// The reference queries are left out when TOILE_TEST_DATA is not set. Exits with 1 when time_of_impact or
// time_of_contact misses a contact; the query is printed with its exact coordinates.
#include "geometry/bvh.h"
#include "geometry/edges.h"
#include "tests/support/ccd_queries.h"
#include "tests/support/surfaces.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>

using namespace toile;
using test::CcdFamily;

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
    {"toi, then exact",
     [](const Query& q) {
         return time_of_contact(q.kind, q.motion, {.min_distance = 1e-6 * q.size}).has_value();
     }},
    {"cubic, 0", [](const Query& q) { return test::cubic_touch(q.kind, q.motion, 0); }},
    {"cubic, 1e-6", [](const Query& q) { return test::cubic_touch(q.kind, q.motion, 1e-6 * q.size); }},
};
constexpr int method_count = int(std::size(methods));
constexpr int never_miss = 3; // of them, the first

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
        const std::clock_t start = std::clock();
        for (int r = 0; r < repeat; ++r)
            for (std::size_t i = 0; i < queries.size(); ++i)
                found[i] = methods[k].touch(queries[i]);
        tally.seconds[k] = double(std::clock() - start) / CLOCKS_PER_SEC / repeat;
        for (std::size_t i = 0; i < queries.size(); ++i) {
            const bool truth = queries[i].touch;
            tally.missed[k] += truth && !found[i];
            tally.false_alarms[k] += found[i] && !truth;
            if (truth && !found[i] && k < never_miss) on_miss(queries[i]);
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

/// Contacts that were passed: misses, and those before the time up to which it let the pair move.
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
    return exactly_touch(q.kind, allowed);
}

void random_queries(long count, std::uint64_t seed) {
    constexpr int families = int(CcdFamily::count), batch = 500;
    std::array<Tallies, families> tallies;
    test::Random random(seed);
    const auto start = std::chrono::steady_clock::now();
    long done = 0, late = 0;
    double exact_seconds = 0;
    for (int b = 0; done < count; ++b) {
        const auto family = CcdFamily(b / 2 % families);
        const auto kind = PairKind(b % 2);
        std::vector<Query> queries(std::min(long(batch), count - done));
        for (Query& q : queries) {
            q.kind = kind;
            q.motion = test::random_ccd_query(family, kind, random, q.size);
        }
        const std::clock_t exact_start = std::clock();
        for (Query& q : queries)
            q.touch = exactly_touch(kind, q.motion);
        exact_seconds += double(std::clock() - exact_start) / CLOCKS_PER_SEC;
        for (const Query& q : queries)
            if (q.touch && passes_contact(q)) {
                ++late;
                report("late", q);
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
    print_head("family");
    for (int f = 0; f < families; ++f)
        for (int k = 0; k < 2; ++k)
            print_times(std::string(test::name_of(CcdFamily(f))) + ", " + name_of(PairKind(k)),
                        tallies[f][k]);
    for (int k = 0; k < 2; ++k)
        print_times(std::string("all, ") + name_of(PairKind(k)), all[k]);
    std::printf("\nexact arithmetic: %.0f ns per query; in all %.0f queries per second\n",
                1e9 * exact_seconds / double(count), double(count) / seconds);
    std::printf(
        "%ld contacts missed, %ld within the motion that toi allows when it keeps a tenth of the distance\n",
        bad - late, late);
}

/// Pleated cloth round a body, both with about `vertices` vertices, three layers deep where it is folded.
std::pair<TriMesh, TriMesh> pleated_cloth_and_body(int vertices) {
    const int along = int(std::lround(std::sqrt(vertices / 2.0))), around = 2 * along;
    TriMesh cloth = test::tube(1, 0.8, around, along - 1);
    for (Vec3& p : cloth.points) {
        const double angle = std::atan2(p[2], p[0]);
        // Forward, back and forward again: 24 pleats that lie over each other, waving along their height.
        const double turned = angle + 0.1 * std::sin(24 * angle) + 0.02 * std::sin(9 * p[1]);
        const double wave = 0.02 * std::cos(24 * angle) + 0.004 * std::sin(13 * p[1] + 5 * angle);
        const double radius = std::max(0.2205, 0.23 + wave); // lies on the body between pleats
        p = {radius * std::cos(turned), p[1], radius * std::sin(turned)};
    }
    return {cloth, test::tube(0.22, 0.8, around, along - 1)};
}

/// Processor time of the best of ten runs, in milliseconds. Each finds the caches full of other things, as in
/// a step of draping; small meshes would otherwise seem cheap because they stay in there.
double best_ms(const std::function<void()>& work) {
    static std::vector<char> other_things(64 << 20);
    double best = 1e30;
    for (int k = 0; k < 10; ++k) {
        for (std::size_t i = 0; i < other_things.size(); i += 64)
            ++other_things[i];
        const std::clock_t start = std::clock();
        work();
        best = std::min(best, 1e3 * double(std::clock() - start) / CLOCKS_PER_SEC);
    }
    return best;
}

/// Exponent of the power of n that fits best, in logarithms.
double exponent(const std::vector<double>& n, const std::vector<double>& value) {
    double x = 0, y = 0, xx = 0, xy = 0;
    for (std::size_t i = 0; i < n.size(); ++i) {
        const double a = std::log(n[i]), b = std::log(value[i]);
        x += a;
        y += b;
        xx += a * a;
        xy += a * b;
    }
    const double k = double(n.size());
    return (k * xy - x * y) / (k * xx - x * x);
}

void broad_phase() {
    const char* columns[] = {"build, ms",         "refit, ms",          "own triangles, ms", "own edges, ms",
                             "with the body, ms", "own triangle pairs", "own edge pairs",    "body pairs"};
    constexpr std::size_t count = std::size(columns);
    std::puts("\nboxes that meet, of a pleated cloth of n vertices with itself and with a body of as many; "
              "they reach"
              " a tenth of an edge beyond triangles and edges\n");
    std::printf("| n |");
    for (const char* c : columns)
        std::printf(" %s |", c);
    std::printf("\n|---:|");
    for (std::size_t c = 0; c < count; ++c)
        std::printf("---:|");
    std::puts("");
    std::vector<double> n, n_log_n;
    std::array<std::vector<double>, count> values;
    for (int vertices = 2500; vertices <= 80000; vertices *= 2) {
        const auto [cloth, body] = pleated_cloth_and_body(vertices);
        n.push_back(double(cloth.points.size()));
        n_log_n.push_back(n.back() * std::log(n.back()));
        const EdgeTable edges = make_edges(cloth.triangles, int(cloth.points.size()));
        const double reach = 0.1 * std::sqrt(1.5 / n.back());
        const auto triangle_box = triangle_boxes(cloth.points, cloth.triangles, reach);
        const auto edge_box = edge_boxes(cloth.points, edges.ends, reach);
        Bvh triangle_tree, edge_tree;
        const Bvh body_tree(triangle_boxes(body.points, body.triangles, reach));
        double own_triangles = 0, own_edges = 0, with_body = 0;
        const auto count_into = [](double& pairs) { return [&pairs](int, int) { ++pairs; }; };
        const double row[count] = {best_ms([&] {
                                       triangle_tree = Bvh(triangle_box);
                                       edge_tree = Bvh(edge_box);
                                   }),
                                   best_ms([&] {
                                       triangle_tree.refit(triangle_box);
                                       edge_tree.refit(edge_box);
                                   }),
                                   best_ms([&] {
                                       own_triangles = 0;
                                       triangle_tree.overlapping_pairs(count_into(own_triangles));
                                   }),
                                   best_ms([&] {
                                       own_edges = 0;
                                       edge_tree.overlapping_pairs(count_into(own_edges));
                                   }),
                                   best_ms([&] {
                                       with_body = 0;
                                       triangle_tree.overlapping(body_tree, count_into(with_body));
                                   }),
                                   own_triangles,
                                   own_edges,
                                   with_body};
        std::printf("| %.0f |", n.back());
        for (std::size_t c = 0; c < count; ++c) {
            values[c].push_back(row[c]);
            std::printf(c < 5 ? " %.2f |" : " %.0f |", row[c]);
        }
        std::puts("");
    }
    std::printf("| exponent |");
    for (const auto& v : values)
        std::printf(" %.2f |", exponent(n, v));
    std::printf("\n\nexponent of n log n over the same range: %.2f\n", exponent(n, n_log_n));
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
    broad_phase();
    return bad != 0;
}

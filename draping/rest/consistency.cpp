// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/rest/consistency.h"

#include "geometry/text.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCore>
#include <Eigen/SparseQR>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace toile {

namespace {

/// A corner of a triangle at a point, with the edges before and after it, in the sense in which the triangle goes round.
struct Corner {
    double angle = 0;
    int before = 0, after = 0;
};

double corner_angle(double opposite, double a, double b) {
    return std::acos(std::clamp((a * a + b * b - opposite * opposite) / (2 * a * b), -1.0, 1.0));
}

/// The corners round every point, in their order round it; none at border points and where the cloth branches.
std::vector<std::vector<Corner>> rings(const Prescribed& data) {
    if (const int t = impossible_triangle(data); t >= 0) {
        const Triangle& k = data.triangles[t];
        throw std::invalid_argument(text("no triangle has the lengths prescribed for points %d, %d and %d", k[0] + 1, k[1] + 1,
                                         k[2] + 1));
    }
    std::vector<std::vector<Corner>> rings(data.point_count);
    std::vector<char> inner(data.point_count, 1);
    for (int e = 0; e < data.edges.size(); ++e)
        if (data.edges.triangles_at(e) != 2)
            for (const int i : data.edges.ends[e]) inner[i] = 0;
    for (std::size_t t = 0; t < data.triangles.size(); ++t) {
        const auto& edge = data.edges.of_triangle[t];
        for (int k = 0; k < 3; ++k) {
            const int before = edge[(k + 2) % 3], after = edge[(k + 1) % 3]; // towards the next corner, and from the last
            rings[data.triangles[t][k]].push_back(
                {corner_angle(data.length[edge[k]], data.length[before], data.length[after]), before, after});
        }
    }
    for (int i = 0; i < data.point_count; ++i) {
        auto& ring = rings[i];
        if (!inner[i]) ring.clear();
        for (std::size_t k = 0; k + 1 < ring.size(); ++k) {
            const auto next = std::find_if(ring.begin() + k + 1, ring.end(),
                                           [&](const Corner& c) { return c.before == ring[k].after; });
            if (next == ring.end()) { // two fans of triangles that share no more than the point, or a side turned over
                ring.clear();
                break;
            }
            std::iter_swap(ring.begin() + k + 1, next);
        }
    }
    return rings;
}

} // namespace

std::vector<double> misfit(const Prescribed& data) {
    std::vector<double> off;
    for (const auto& ring : rings(data)) {
        Mat3 round = Mat3::Identity();
        for (const Corner& c : ring)
            round = round * Eigen::AngleAxisd(c.angle, Vec3::UnitZ()) * Eigen::AngleAxisd(data.angle[c.after], Vec3::UnitX());
        off.push_back(ring.empty() ? 0 : std::abs(Eigen::AngleAxisd(round).angle()));
    }
    return off;
}

std::vector<double> angle_defects(const Prescribed& data) {
    std::vector<double> defects;
    for (const auto& ring : rings(data)) {
        double& defect = defects.emplace_back(ring.empty() ? 0 : 2 * M_PI);
        for (const Corner& c : ring) defect -= c.angle;
    }
    return defects;
}

DataCount count_data(const Prescribed& data, const Points& x) {
    DataCount count;
    const PrescribedEnergy energy(data);
    count.lengths = int(energy.lengths().springs().size());
    count.angles = int(energy.angles().size());
    for (const auto& ring : rings(data)) count.inner_points += !ring.empty();
    count.freedom = 3 * data.point_count - 6;
    if (data.point_count > most_ranked) return count;

    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](int row, int point, const Vec3& slope) {
        for (int c = 0; c < 3; ++c) entries.emplace_back(row, 3 * point + c, slope[c]);
    };
    int row = 0;
    double mean = 0; // angles times it are as large as lengths
    for (const Spring& s : energy.lengths().springs()) {
        const Vec3 along = (x[s.b] - x[s.a]).normalized();
        add(row, s.a, -along);
        add(row++, s.b, along);
        mean += s.length / count.lengths;
    }
    for (const HingeBend& b : energy.angles()) {
        const HingeAngle a = hinge_angle(b.nodes, x);
        for (int k = 0; k < 4; ++k) add(row, b.nodes[k], mean * a.gradient[k]);
        ++row;
    }
    Eigen::SparseMatrix<double> slopes(row, 3 * data.point_count);
    slopes.setFromTriplets(entries.begin(), entries.end());
    slopes.makeCompressed();
    Eigen::SparseQR<Eigen::SparseMatrix<double>, Eigen::COLAMDOrdering<int>> qr;
    qr.setPivotThreshold(1e-8);
    qr.compute(slopes);
    count.rank = int(qr.rank());
    return count;
}

} // namespace toile

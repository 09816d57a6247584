// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/lay.h"

#include "draping/pieces.h"
#include "geometry/bvh.h"
#include "geometry/distance.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

constexpr double around = 0.3;      // m, that a thread through the body counts as longer
constexpr double wrong_side = 1;    // m, that a right side which looks at the body counts as
constexpr double turning = 0.1;     // m, that a radian of turn counts as
constexpr double beyond = 0.02;    // m, from the body for a panel that is moved through it
constexpr double view = 0.6;        // m, that a panel's right side looks
constexpr double near_gap = 0.03;   // m, below which all gaps weigh the same
constexpr double as_it_was = 1e-4;  // m2, weight of the present rotation where seams leave a turn free
constexpr double seeing = 0.1;      // share of a piece, or of the body's silhouette if that is smaller, that has to see it
constexpr double flat = 0.5;        // size of a piece's mean normal: below, it has no side
constexpr int reweightings = 8;
constexpr int moves_per_piece = 4;  // on average, so that it ends

struct Pose {
    Mat3 rotation = Mat3::Identity();
    Vec3 shift = Vec3::Zero();

    Vec3 operator()(const Vec3& p) const { return rotation * p + shift; }
    Vec3 inverse(const Vec3& p) const { return rotation.transpose() * (p - shift); }
};

/// One end of a thread on a piece; the other lies on another piece.
struct Thread {
    int stitch = 0;
    bool from_a = false; ///< this end is the stitch's node
};

/// A garment whose pieces are being laid.
struct Laying {
    const Garment& garment;
    const TriMesh& body;
    Bvh body_tree;
    double silhouette; ///< m2, of the body, mean of all directions (Cauchy; of a convex one)
    Points x;
    std::vector<Piece> pieces = {};
    std::vector<std::vector<Thread>> threads = {}; ///< by piece

    Vec3 near_end(const Thread& t) const { return end(t, true); }
    Vec3 far_end(const Thread& t) const { return end(t, false); }

    Vec3 end(const Thread& t, bool near) const {
        const Stitch& s = garment.stitches[t.stitch];
        return t.from_a == near ? x[s.a] : seam_point(s, x);
    }
};

void collect_threads(Laying& l) {
    const Garment& g = l.garment;
    l.pieces = pieces_of(g, l.x);
    l.threads.resize(l.pieces.size());
    std::vector<int> piece_of_node(g.node_count, 0);
    for (int i = 0; i < int(l.pieces.size()); ++i)
        for (int node : l.pieces[i].nodes) piece_of_node[node] = i;
    for (int k = 0; k < int(g.stitches.size()); ++k) {
        const int a = piece_of_node[g.stitches[k].a], b = piece_of_node[g.stitches[k].b[0]];
        if (a == b) continue;
        l.threads[a].push_back({k, true});
        l.threads[b].push_back({k, false});
    }
}

/// Where the way from a to b meets the body's surface.
struct Meetings {
    int count = 0;
    double last = 0; ///< as a share of the way
};

Meetings meet(const Laying& l, const Vec3& a, const Vec3& b) {
    Box box;
    box.extend(a);
    box.extend(b);
    Meetings m;
    l.body_tree.overlapping(box, [&](int t) {
        const Triangle& c = l.body.triangles[t];
        const Points& p = l.body.points;
        const auto at = segment_through_triangle(a, b, p[c[0]], p[c[1]], p[c[2]]);
        if (!at) return;
        ++m.count;
        m.last = std::max(m.last, at->along);
    });
    return m;
}

/// The pose that brings a piece's seam points nearest to what they are sewn to, shifted only or turned as well
/// (Kabsch 1976, reweighted toward least distances). Seams in one line leave a turn free: a little weight on no
/// rotation keeps it small.
Pose fit(const Laying& l, int piece, bool turn) {
    Pose pose;
    for (int round = 0; round < reweightings; ++round) {
        double weights = 0;
        Vec3 from = Vec3::Zero(), to = Vec3::Zero();
        std::vector<double> weight;
        for (const Thread& t : l.threads[piece]) {
            const double gap = (pose(l.near_end(t)) - l.far_end(t)).norm();
            weight.push_back(l.garment.stitches[t.stitch].length / (round ? std::max(gap, near_gap) : 1));
            weights += weight.back();
            from += weight.back() * l.near_end(t);
            to += weight.back() * l.far_end(t);
        }
        from /= weights;
        to /= weights;
        if (!turn) {
            pose.shift = to - from;
            continue;
        }
        Mat3 h = as_it_was * weights * Mat3::Identity();
        for (std::size_t k = 0; k < weight.size(); ++k) {
            const Thread& t = l.threads[piece][k];
            h += weight[k] * (l.far_end(t) - to) * (l.near_end(t) - from).transpose();
        }
        const Eigen::JacobiSVD<Mat3> svd(h, Eigen::ComputeFullU | Eigen::ComputeFullV);
        Vec3 sign = Vec3::Ones();
        sign.z() = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
        pose.rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
        pose.shift = to - pose.rotation * from;
    }
    return pose;
}

/// How far a piece must go on along its right side's normal until the body no longer lies before that side; 0
/// where hardly any of it sees the body: a full circle of cloth is much larger than the body before it. What lies in
/// the body counts as well in a new place, but not where the file puts it: place_clear() pushes it out by the shortest
/// way.
double through_to_outside(const Laying& l, int piece, const Pose& pose, bool new_place) {
    const Vec3 normal = pose.rotation * l.pieces[piece].normal;
    int seen = 0;
    double farthest = 0;
    for (int i : l.pieces[piece].nodes) {
        const Vec3 from = pose(l.x[i]);
        const Meetings m = meet(l, from, from + view * normal);
        const bool in_body = m.count % 2 != 0;
        if (m.count == 0 || (in_body && !new_place)) continue;
        ++seen;
        farthest = std::max(farthest, m.last * view);
    }
    const double share = seeing * std::min(1.0, l.silhouette / l.pieces[piece].area);
    return seen > share * double(l.pieces[piece].nodes.size()) ? farthest + beyond : 0;
}

/// Mean length of a piece's threads were it moved, and more where its right side would look at the body, m.
double badness(const Laying& l, int piece, const Pose& pose, bool new_place) {
    double sum = 0, length = 0;
    for (const Thread& t : l.threads[piece]) {
        const double weight = l.garment.stitches[t.stitch].length;
        const Vec3 near = pose(l.near_end(t)), far = l.far_end(t);
        sum += weight * ((near - far).norm() + (meet(l, near, far).count > 0 ? around : 0));
        length += weight;
    }
    return sum / length + turning * Eigen::AngleAxisd(pose.rotation).angle() +
           (through_to_outside(l, piece, pose, new_place) > 0 ? wrong_side : 0);
}

/// Where a piece is least badly off.
Pose best_pose(const Laying& l, int piece) {
    Pose best;
    double least = badness(l, piece, best, false);
    for (Pose pose : {Pose{}, fit(l, piece, false), fit(l, piece, true)}) {
        pose.shift += through_to_outside(l, piece, pose, true) * (pose.rotation * l.pieces[piece].normal);
        const double bad = badness(l, piece, pose, true);
        if (bad >= least) continue;
        least = bad;
        best = pose;
    }
    return best;
}

bool may_move(const Laying& l, int piece, const LayOptions& options) {
    return !l.threads[piece].empty() && l.pieces[piece].flatness > flat &&
           !any_of_panels(l.pieces[piece], options.fixed);
}

/// Whether right sides tell where a piece belongs: those of most look away from the body.
bool sides_known(const Laying& l) {
    int away = 0;
    for (int i = 0; i < int(l.pieces.size()); ++i) away += through_to_outside(l, i, {}, false) == 0;
    return 2 * away >= int(l.pieces.size());
}

void move(Laying& l, int piece, const Pose& pose) {
    Piece& p = l.pieces[piece];
    for (int i : p.nodes) l.x[i] = pose(l.x[i]);
    p.middle = pose(p.middle);
    p.normal = pose.rotation * p.normal;
}

} // namespace

Laid lay_anew(const Garment& garment, const Points& x, const TriMesh& body, const LayOptions& options) {
    double surface = 0;
    for (const Triangle& t : body.triangles) surface += triangle_area(body.points, t);
    Laying l{garment, body, Bvh(triangle_boxes(body.points, body.triangles, 0)), surface / 4, x};
    collect_threads(l);
    const int count = int(l.pieces.size()), most_moves = sides_known(l) ? moves_per_piece * count : 0;
    std::vector<Pose> total(count);
    for (int move_count = 0; move_count < most_moves; ++move_count) {
        int best = -1;
        double most = options.gain;
        Pose to;
        for (int i = 0; i < count; ++i) {
            if (!may_move(l, i, options)) continue;
            const Pose pose = best_pose(l, i);
            const double gain = badness(l, i, {}, false) - badness(l, i, pose, true);
            if (gain <= most) continue;
            most = gain;
            best = i;
            to = pose;
        }
        if (best < 0) break;
        move(l, best, to);
        total[best] = {to.rotation * total[best].rotation, to.rotation * total[best].shift + to.shift};
    }
    Laid laid;
    for (int i = 0; i < count; ++i) {
        const Vec3 middle = l.pieces[i].middle;
        const double moved = (total[i].inverse(middle) - middle).norm();
        if (moved == 0) continue;
        for (int panel : l.pieces[i].panels)
            laid.moved.push_back({panel, moved, Eigen::AngleAxisd(total[i].rotation).angle()});
    }
    std::sort(laid.moved.begin(), laid.moved.end(),
              [](const LaidPanel& a, const LaidPanel& b) { return a.panel < b.panel; });
    laid.x = std::move(l.x);
    return laid;
}

} // namespace toile

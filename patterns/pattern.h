// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What the designer drew: panels of curved edges, the seams between them, and where each panel starts out
// around the body. Metres and radians; panel coordinates are x to the right, y up, as in the file.

#include "patterns/rest_mesh.h"

#include <optional>
#include <variant>

namespace toile {

/// The shape of an edge between its two ends.
struct Straight {};
struct Quadratic { Vec2 control; };
struct Cubic { Vec2 control0, control1; };
/// An arc of `radius` metres; `large` takes the longer way; `right` bulges to the right of travel.
struct Arc { double radius; bool large; bool right; };
using Curve = std::variant<Straight, Quadratic, Cubic, Arc>;

struct Edge {
    Vec2 start, end;
    Curve curve;
    std::string label; ///< as in the file: "lower_interface", "left_collar", ...; may be empty
};

/// An ordered, directed chain of edges. A closed loop ends where it starts. An outline that runs
/// counter-clockwise has the fabric's right side on +z of the panel, a clockwise one on -z.
using Loop = std::vector<Edge>;

enum class InnerLineKind { cut, fold, pleat };
struct InnerLine {
    Loop edges; ///< open or closed
    InnerLineKind kind = InnerLineKind::fold;
    double rest_angle = 0; ///< rad, for folds and pleats
};

/// Panel point (x, y) starts out in space at rotation * (x, y, 0) + translation.
struct Placement {
    Mat3 rotation = Mat3::Identity();
    Vec3 translation = Vec3::Zero();
};

struct Panel {
    std::string name;
    Loop outline;
    std::vector<Loop> holes;
    std::vector<InnerLine> lines;
    Placement placement;
    std::string label;    ///< body part the file assigns: "body", "leg", "arm"; may be empty
    std::string fabric;   ///< preset or name from the companion file; empty: the garment's
    double grain = EIGEN_PI / 2; ///< direction of the warp, rad from the panel's x axis; default: the panel's y
    /// By which share of their length as cut (weft, warp) the cloth is shorter at rest: steam shrinks it, and stretches it
    /// where this is below 0. Fabrics are what the cloth is then.
    Vec2 shrink = Vec2::Zero();
    int layer = 0;        ///< 0 lies next to the body, larger lies outside
    /// Cloth that is not flat at rest. The outline then has edges of the same number, label and length, which are straight and
    /// have no shape; it is empty for a closed surface. There are no holes and no lines.
    std::optional<RestMesh> rest;
};

/// The part [t0, t1] of an outline's edge, as fractions of its arc length, walked from t0 to t1
/// (backwards when t1 < t0).
struct EdgeSpan {
    int panel = 0;
    int edge = 0; ///< index into Panel::outline
    double t0 = 0, t1 = 1;
};

/// One side of a seam: spans walked one after the other.
using SeamSide = std::vector<EdgeSpan>;

enum class SeamFaces { right_to_right, right_to_wrong };

/// Two sides sewn to each other, start to start and end to end: the direction is that of the spans. Both sides
/// carry equally many samples; a difference of length is ease, shared evenly.
struct Seam {
    SeamSide a, b;
    SeamFaces faces = SeamFaces::right_to_right;
    std::string name; ///< how messages call it, e.g. "seam 3 (front.2 to back.4)"
};

/// An elastic band sewn along a span: it wants to be `ratio` times the cloth's length.
struct Elastic {
    EdgeSpan span;
    double ratio = 1;       ///< (0, 1]
    double stiffness = 100; ///< N per unit strain
    int item = -1;          ///< of the elastics in the file that says it, from 0
};
constexpr double least_ratio = 0.05; ///< of elastics in files

/// A span of an edge held where it starts out.
struct Pin { EdgeSpan span; };

struct Pattern {
    std::string name;
    std::vector<Panel> panels;
    std::vector<Seam> seams;
    std::vector<Elastic> elastics;
    std::vector<Pin> pins;
    std::string fabric; ///< of panels that name none; may be empty
};

} // namespace toile

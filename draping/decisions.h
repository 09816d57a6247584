// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What a drape modelled and left out, in sentences with the measure that justified each.

#include "draping/contact/contact.h"
#include "draping/drape.h"
#include "draping/measure.h"

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace toile {

/// Hooks on the edges of one label.
struct HookFacts {
    std::string label;
    bool held = false;     ///< to the end, since it was asked for
    double placed = 0;     ///< m, mean height at which the file puts the edges
    double released = 0;   ///< m, mean height when the hooks were let go; of held ones: not used
    double end = 0;        ///< m, mean height at the end
};

struct TouchFacts {
    int body_pairs = 0;    ///< pairs of cloth and body within the clearance
    int touching_nodes = 0; ///< nodes on which the body presses
    int cloth_pairs = 0;   ///< pairs of cloth and cloth within the clearance
    double press = 0;      ///< N, sum of the body's forces on the nodes
};

/// Counts what touches at x.
TouchFacts count_touching(const Contact& contact, const Points& x);

struct DrapeFacts {
    TouchFacts touch;
    Method method = Method::equilibrium;
    bool projected = true;             ///< MethodOptions::projected
    std::optional<double> kept_strain; ///< as the method's stepper tells it
    ContactReport contact;
    bool self_contact = true;        ///< DrapeOptions::self_contact
    std::optional<MotionReport> motion; ///< of an animation
    FrictionCoefficients friction;
    double clearance = 0;            ///< m
    std::vector<HookFacts> hooks;
    std::map<double, double, std::greater<>> drawn_in; ///< m, by the edge length of levels: how far the body was drawn in to grow back
    double still_drawn_in = 0;       ///< m, DrapeResult::drawn_in
    std::vector<double> edge_lengths; ///< m, per level
    int untangled = 0;               ///< crossings of edges and triangles of cloth that were taken apart
    int held_as_it_lay = 0;          ///< times that friction took up what was left near rest, since it went in circles
    double slid_to_fit = 0;          ///< m, how far what was too tight slid at most when friction let it go; 0: it was not let
    int untangled_as_mesh = 0;       ///< levels on which the rest was taken apart as a mesh
    int pins = 0;                    ///< nodes held
    int band_segments = 0;           ///< of elastics
    double band_length = 0, band_rest = 0; ///< m, of all elastics at the end and relaxed
    double band_pull = 0;            ///< N, largest tension
    int inner_stitches = 0;          ///< stitches to the inside of an edge, which stay springs
    double inner_gap = 0;            ///< m, the widest of them
    bool restarted = false;          ///< from an earlier drape
};

/// One sentence each. Strain and which side is out are measured here.
std::vector<std::string> decisions(const DrapeFacts& facts, const Garment& garment, const Points& x,
                                   const PanelFabrics& fabrics, const TriMesh& body);

/// Share of the cloth's area whose right side looks away from the nearest point of the body.
double right_side_out(const Garment& garment, const Points& x, const TriMesh& body);

} // namespace toile

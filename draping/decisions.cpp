// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/decisions.h"

#include "draping/energy/yarns.h"
#include "geometry/foot.h"
#include "geometry/text.h"

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

std::string contact_sentence(const DrapeFacts& f) {
    if (f.contact.response == ContactResponse::constraint)
        return text("contact of the cloth with itself, and of edges with the body, was left out by the response that was "
                    "asked for: at the end %d pairs of cloth are within %.3g mm of each other",
                    f.touch.cloth_pairs, 1e3 * f.clearance);
    if (!f.self_contact)
        return "contact of the cloth with itself was left out, since by its shape it cannot touch itself";
    return text("contact of the cloth with itself was modelled: at the end %d pairs are within %.3g mm of "
                "each other",
                f.touch.cloth_pairs, 1e3 * f.clearance);
}

std::string cloth_friction_sentence(const DrapeFacts& f) {
    if (f.contact.response == ContactResponse::constraint)
        return text("friction of cloth on cloth was left out (%d pairs touch)", f.touch.cloth_pairs);
    if (f.friction.cloth <= 0)
        return text("friction of cloth on cloth was left out: its coefficient is 0 (%d pairs touch)", f.touch.cloth_pairs);
    return text("of cloth on cloth with coefficient %.3g (%d pairs touch)", f.friction.cloth, f.touch.cloth_pairs);
}

std::string friction_sentence(const DrapeFacts& f, int nodes) {
    if (f.contact.response == ContactResponse::rigid)
        return text("cloth was welded to what it touches, whatever friction would bear (%d of %d nodes are held, with "
                    "%.3g N in all)",
                    f.touch.touching_nodes, nodes, f.touch.press);
    const std::string cloth = cloth_friction_sentence(f);
    if (f.friction.body <= 0)
        return text("friction on the body was left out: its coefficient is 0 (%d of %d nodes touch the body); ",
                    f.touch.touching_nodes, nodes) +
               cloth;
    return text("Coulomb friction with coefficient %.3g was modelled between cloth and body, which touch at %d "
                "of %d nodes with %.3g N in all; ",
                f.friction.body, f.touch.touching_nodes, nodes, f.touch.press) +
           cloth;
}

std::string response_sentence(const DrapeFacts& f) {
    return text("contact was answered by the response \"%s\" while the %s; its guarantee "
                "at the end is \"%s\", steps in which a pair touched for all that: %d",
                to_string(f.contact.response), f.motion ? "cloth moved" : "levels came to rest in damped motion",
                to_string(f.contact.guarantee), f.contact.unresolved);
}

std::string method_sentence(const DrapeFacts& f, const Garment& g) {
    std::string limits = f.method == Method::springs_limited    ? "springs beyond the fabric's limits were shortened in sweeps"
                         : f.method == Method::springs_biphasic ? "springs become stiffer at the fabric's limits"
                                                                : "nothing held strains within the fabric's limits";
    if (f.method == Method::inextensible)
        limits = text("%d of %d edges lie along warp or weft and kept their lengths%s", int(yarn_edges(g).size()), g.edges.size(),
                      f.contact.response == ContactResponse::barrier ? "" : " in every step before contact");
    if (f.method == Method::triangles && (f.motion || f.contact.response != ContactResponse::barrier))
        limits += text("; its steps were solved with %s of its energy",
                       f.projected ? "a positive semidefinite second derivative" : "the exact second derivative");
    if (f.kept_strain)
        limits = text("triangles keep their shape on the midpoints of their edges, where the largest strain at the end is %.2g %%; "
                      "strains elsewhere in this report are of the mesh through the means of their corners",
                      100 * *f.kept_strain);
    if (f.kept_strain && !f.motion && f.contact.response == ContactResponse::barrier)
        limits += "; every level slid to where it fits its lengths before friction held it";
    return text("the %s by the method \"%s\" instead of equilibrium, which sewed and placed the cloth; %s",
                f.motion ? "cloth moved" : "levels were brought to rest", to_string(f.method), limits.c_str());
}

std::string motion_sentence(const DrapeFacts& f) {
    const MotionReport& m = *f.motion;
    return text("the garment was let go where %s, and moved in time for %.4g s: %d frames at "
                "%.4g per second, steps of %.4g ms, %d from frame to frame; air takes %.3g of the speed per second; no point "
                "moves faster than %.3g m/s, which held some back in %d of %d steps",
                f.restarted ? "the earlier drape had ended" : "it was sewn, at rest without its weight",
                (m.frames - 1) / m.rate, m.frames, m.rate, 1e3 * m.time_step, m.steps_per_frame, m.air_damping, m.most_speed,
                m.slowed, m.steps);
}

std::string level_sentence(const DrapeFacts& f) {
    if (f.restarted)
        return text("one level, %.3g mm: the start is an earlier drape", 1e3 * f.edge_lengths.back());
    if (f.edge_lengths.size() == 1)
        return text("one level, %.3g mm: the mesh was taken as it came or is that coarse",
                    1e3 * f.edge_lengths.back());
    std::string list;
    for (double e : f.edge_lengths)
        list += (list.empty() ? "" : ", ") + text("%.3g", 1e3 * e);
    return "levels of " + list + " mm, each twice as fine as the one before, the first one from 40 mm on";
}

std::string hook_sentence(const HookFacts& h) {
    if (h.held)
        return text("hooks held the edges labelled \"%s\" to the end, as asked: at %.1f cm on average, where "
                    "the file puts them at %.1f cm",
                    h.label.c_str(), 100 * h.end, 100 * h.placed);
    return text("hooks held the edges labelled \"%s\" until the garment was to carry itself; since they were "
                "released the edges moved by %+.1f mm in height, to %+.1f mm from where the file puts them",
                h.label.c_str(), 1e3 * (h.end - h.released), 1e3 * (h.end - h.placed));
}

std::string growth_sentence(const DrapeFacts& f) {
    std::string list;
    for (const auto& [edge_length, depth] : f.drawn_in)
        if (depth > 0)
            list += (list.empty() ? "" : ", ") + text("%.0f mm at the level of %.3g mm", 1e3 * depth, 1e3 * edge_length);
    if (f.still_drawn_in > 0)
        return "the body was drawn in, since the cloth started in it, and did not grow back whole: " + list +
               text(", of which %.1f mm are left", 1e3 * f.still_drawn_in);
    if (list.empty()) return "the body was never drawn in: the cloth started clear of it on every level";
    return "the body was drawn in and grew back under contact, since the cloth started in it: " + list;
}

void curve_sentences(Method method, const PanelFabrics& fabrics, std::vector<std::string>& out) {
    std::vector<std::string> said;
    for (const Fabric& f : fabrics) {
        if ((f.curve_warp.empty() && f.curve_weft.empty()) || std::find(said.begin(), said.end(), f.name) != said.end()) continue;
        said.push_back(f.name);
        if (has_curves(method))
            out.push_back("the stretch of " + f.name + " follows its measured curves");
        else if (method == Method::nonconforming)
            out.push_back("the stretch curves of " + f.name + " were left out: this method keeps all lengths");
        else
            out.push_back("the stretch curves of " + f.name +
                          text(" were replaced by their secants at %.3g %% of stretch: %.3g N/m along the warp, %.3g N/m along the "
                               "weft",
                               100 * secant_stretch, f.stretch_warp, f.stretch_weft));
    }
}

void limit_sentences(bool modelled, const Garment& g, const Points& x, const PanelFabrics& fabrics,
                     std::vector<std::string>& out) {
    const StrainMeasure s = measure_strain(g, x, fabrics);
    std::vector<std::string> without;
    for (const Fabric& f : fabrics)
        if (f.limit_warp == 0 && f.limit_weft == 0 && f.limit_shear == 0 &&
            std::find(without.begin(), without.end(), f.name) == without.end())
            without.push_back(f.name);
    for (const std::string& name : without)
        out.push_back("strain limits were left out for " + name + ", which has none; its largest strain is " +
                      text("%.1f %% (warp) and %.1f %% (weft)", 100 * s.warp.max, 100 * s.weft.max));
    const auto reached = [&](double most, double limit, double unit, const char* what, const char* sign) {
        if (limit <= 0) return;
        out.push_back(text("the limit of %s was %s: the largest is %.3g of %.3g %s", what,
                           modelled ? "modelled" : "left to the method", unit * most, unit * limit, sign));
    };
    const double shear = std::max(std::abs(s.shear.min), std::abs(s.shear.max));
    reached(s.warp.max, s.limit_warp, 100, "warp strain", "%");
    reached(s.weft.max, s.limit_weft, 100, "weft strain", "%");
    reached(shear, s.limit_shear, 180 / EIGEN_PI, "shear angle", "degrees");
}

} // namespace

TouchFacts count_touching(const Contact& contact, const Points& x) {
    TouchFacts facts;
    const std::vector<ActivePair> active = contact.active(x);
    for (const ActivePair& a : active)
        ++(contact.pair(a.pair).with_body ? facts.body_pairs : facts.cloth_pairs);
    for (const Vec3& force : contact.body_forces(active)) {
        facts.touching_nodes += force.squaredNorm() > 0;
        facts.press += force.norm();
    }
    return facts;
}

double right_side_out(const Garment& g, const Points& x, const TriMesh& body) {
    const Bvh tree(triangle_boxes(body.points, body.triangles, 0));
    double out = 0, all = 0;
    for (int t = 0; t < int(g.triangles.size()); ++t) {
        const Triangle n = g.nodes(t);
        const Vec3 centre = (x[n[0]] + x[n[1]] + x[n[2]]) / 3;
        const Vec3 area = (x[n[1]] - x[n[0]]).cross(x[n[2]] - x[n[0]]);
        const Foot foot = foot_on(body, tree, centre);
        if (foot.triangle < 0) return 0;
        all += area.norm();
        if (area.dot(centre - foot.at) > 0) out += area.norm();
    }
    return all > 0 ? out / all : 0;
}

std::vector<std::string> decisions(const DrapeFacts& f, const Garment& g, const Points& x,
                                   const PanelFabrics& fabrics, const TriMesh& body) {
    std::vector<std::string> out{level_sentence(f), contact_sentence(f), friction_sentence(f, g.node_count),
                                 growth_sentence(f)};
    if (f.method != Method::equilibrium) out.push_back(method_sentence(f, g));
    if (f.contact.response != ContactResponse::barrier) out.push_back(response_sentence(f));
    if (f.motion) out.push_back(motion_sentence(f));
    if (f.untangled > 0)
        out.push_back(text("where cloth crossed itself after sewing or on a finer mesh, it was taken apart before contact "
                           "took over: at most %d crossings on a level", f.untangled));
    if (f.held_as_it_lay > 0)
        out.push_back(text("near rest, where it and contact chased one another, friction took up what forces were left %s, as far as "
                           "it can bear them", f.held_as_it_lay == 1 ? "once" : text("%d times", f.held_as_it_lay).c_str()));
    if (f.slid_to_fit > 0)
        out.push_back(text("where friction held it the garment was too tight: it was let slide without, by up to %.0f mm, and is held where it came to lie",
                           1e3 * f.slid_to_fit));
    if (f.untangled_as_mesh > 0)
        out.push_back(text("cloth that stayed tangled while it settled was taken apart without regard to its pattern on %d "
                           "of the levels, and settled again",
                           f.untangled_as_mesh));
    for (const HookFacts& h : f.hooks)
        out.push_back(hook_sentence(h));
    if (f.hooks.empty())
        out.push_back(f.restarted ? "no hooks were used: the start is an earlier drape"
                                  : "no hooks were used or released: no labelled edge carries the garment");
    if (f.pins > 0) out.push_back(text("%d nodes were pinned where they start out", f.pins));
    if (f.band_segments > 0)
        out.push_back(text("elastic bands of %.1f cm relaxed, in %d segments, are %.1f cm long and pull with "
                           "up to %.3g N; their cloth counts as gathered",
                           100 * f.band_rest, f.band_segments, 100 * f.band_length, f.band_pull));
    if (f.inner_stitches > 0)
        out.push_back(text("%d stitches to the inside of an edge stayed springs, the widest %.2g mm open; "
                           "triangles that such a stitch joins do not touch each other",
                           f.inner_stitches, 1e3 * f.inner_gap));
    curve_sentences(f.method, fabrics, out);
    limit_sentences(f.method == Method::equilibrium, g, x, fabrics, out);
    if (!body.triangles.empty())
        out.push_back(text("the fabric's right side looks away from the body on %.1f %% of the area",
                           100 * right_side_out(g, x, body)));
    return out;
}

} // namespace toile

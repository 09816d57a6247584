#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Drafts the garments of examples/ from body measures and writes them as GarmentCode specifications.

    scripts/make_examples.py                          # cut for the built-in dress form, into examples/
    scripts/make_examples.py --body b.json --out dir  # cut for another body; b.json overrides entries of BODY

Centimetres throughout. Pattern coordinates: x to the wearer's left, y up, seen from the front; the fabric's right
side is toward the viewer for fronts (counter-clockwise outlines) and away from the viewer for backs (clockwise).
"""

import argparse
import json
import math
import pathlib

# The built-in form of 1.68 m, bust 90, waist 72, hip 96. Heights are above the floor; x is to one side.
BODY = {
    "bust": 90, "waist": 72, "hip": 96,
    "waist_ease": -0.5,                        # of skirts and trousers, which rest 2 to 3 cm lower where it is 1
    "bust_y": 121.5, "waist_y": 106.2, "hip_y": 83.2, "crotch_y": 74.1, "armpit_y": 123.3,
    "neck_x": 8.0, "neck_y": 143.0,            # where the neck meets the shoulder
    "shoulder_x": 18.5, "shoulder_y": 137.9,   # tip of the shoulder
    "front_z": 13.0, "back_z": -13.6,          # farthest points of the torso
    "front_over_bust": 42.0, "back_to_waist": 40.5,  # from neck to waist by tape, over the bust and over the blade
    "arm_x": 25.4, "arm_y": 122.0, "arm_z": -2.9, "arm_angle": 45.9,  # a point of the arm's axis; degrees below level
    "upper_arm": 31.0,
}


# ---- drawing -----------------------------------------------------------------------------------------------------

def add(p, q):
    return (p[0] + q[0], p[1] + q[1])


def along(p, q, distance):
    """The point at a distance from p toward q."""
    length = math.dist(p, q)
    return (p[0] + (q[0] - p[0]) * distance / length, p[1] + (q[1] - p[1]) * distance / length)


class Side:
    """One edge of an outline: where it goes to, by which control points, and what it is called."""

    def __init__(self, to, controls=(), tag="", label=""):
        self.to, self.controls, self.tag, self.label = to, tuple(controls), tag, label


def bezier(points, u):
    while len(points) > 1:
        points = [(p[0] + u * (q[0] - p[0]), p[1] + u * (q[1] - p[1])) for p, q in zip(points, points[1:])]
    return points[0]


def length(points, n=400):
    """Length of a Bezier curve given by its end and control points."""
    walk = [bezier(list(points), i / n) for i in range(n + 1)]
    return sum(math.dist(p, q) for p, q in zip(walk, walk[1:]))


def mirrored(name):
    """left_... for right_... and back; f_l for f_r."""
    swap = {"left": "right", "right": "left", "l": "r", "r": "l"}
    return "_".join(swap.get(word, word) for word in name.split("_"))


class Outline:
    """A closed loop of edges, counter-clockwise unless turned."""

    def __init__(self, start, sides):
        self.start, self.sides = start, list(sides)

    def starts(self):
        return [self.start] + [s.to for s in self.sides[:-1]]

    def turned(self):
        """The same loop run the other way."""
        starts = self.starts()
        sides = [Side(p, reversed(s.controls), s.tag, s.label) for p, s in zip(starts, self.sides)]
        return Outline(self.sides[-1].to, reversed(sides))

    def mirror(self):
        """The mirror image, run the same way round; left and right change in its names."""
        flip = lambda p: (-p[0], p[1])
        image = Outline(flip(self.start), [Side(flip(s.to), map(flip, s.controls), mirrored(s.tag), mirrored(s.label))
                                           for s in self.sides])
        return image.turned()

    def edge_length(self, tag):
        for p, s in zip(self.starts(), self.sides):
            if s.tag == tag:
                return length([p, *s.controls, s.to])
        raise KeyError(tag)


def whole(half):
    """A symmetric outline from its left half, which runs from the centre line to the centre line. A straight edge
    that begins or ends at the centre becomes one edge with its mirror image."""
    image = half.mirror()
    sides = half.sides + image.sides
    start = half.start
    first, last = half.sides[0], half.sides[-1]
    if not last.controls:  # the top
        k = len(half.sides)
        sides[k - 1:k + 1] = [Side(sides[k].to, (), last.tag.replace("left_", ""), last.label.replace("left_", ""))]
    if not first.controls:  # the hem
        end = sides.pop()
        start = image.starts()[-1]
        sides[0] = Side(first.to, (), first.tag.replace("left_", ""), first.label.replace("left_", ""))
        assert end.tag == mirrored(first.tag)
    return Outline(start, sides)


class Garment:
    def __init__(self):
        self.panels, self.stitches = {}, []
        self.lines = {}  # of panels, as the companion file has them

    def panel(self, name, outline, translation, turn=0.0, label="body", about_y=0.0):
        """Places an outline: turned by `turn` degrees in its plane, or out of it about y, then moved."""
        vertices, edges = outline.starts(), []
        for k, (start, side) in enumerate(zip(vertices, outline.sides)):
            edge = {"endpoints": [k, (k + 1) % len(vertices)]}
            if side.label:
                edge["label"] = side.label
            if side.controls:
                kind = {1: "quadratic", 2: "cubic"}[len(side.controls)]
                edge["curvature"] = {"type": kind, "params": [relative(start, side.to, c) for c in side.controls]}
            edges.append(edge)
        self.panels[name] = {"translation": list(translation), "rotation": [0.0, about_y, turn],
                             "vertices": [rounded(v) for v in vertices], "edges": edges, "label": label,
                             "tags": [s.tag for s in outline.sides]}

    def sew(self, panel_a, tag_a, panel_b, tag_b):
        self.stitches.append([{"panel": p, "edge": self.panels[p]["tags"].index(t)}
                              for p, t in ((panel_a, tag_a), (panel_b, tag_b))])

    def sew_both(self, panel_a, tag_a, panel_b, tag_b):
        """A seam and its mirror image."""
        self.sew(panel_a, tag_a, panel_b, tag_b)
        self.sew(mirrored(panel_a), mirrored(tag_a), mirrored(panel_b), mirrored(tag_b))

    def specification(self):
        panels = {name: {k: v for k, v in panel.items() if k != "tags"} for name, panel in self.panels.items()}
        return {
            "pattern": {"panels": panels, "stitches": self.stitches, "panel_order": list(panels)},
            "parameters": {}, "parameter_order": [],
            "properties": {"curvature_coords": "relative", "normalize_panel_translation": False,
                           "normalized_edge_loops": True, "units_in_meter": 100},
        }


def rounded(values, digits=4):
    return [round(v, digits) + 0.0 for v in values]


def relative(start, end, control):
    """A control point along and across its edge, as shares of the edge's length."""
    ex, ey = end[0] - start[0], end[1] - start[1]
    cx, cy = control[0] - start[0], control[1] - start[1]
    square = ex * ex + ey * ey
    return rounded(((cx * ex + cy * ey) / square, (cy * ex - cx * ey) / square), 6)


def solve(function, low, high):
    """Where an increasing function is zero."""
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if function(middle) < 0 else (low, middle)
    return 0.5 * (low + high)


# ---- tee ---------------------------------------------------------------------------------------------------------

def tee_body(b, width, neck_depth, neck_height, underarm, hip):
    """Left half of a front or back, from the hem at the centre to the neck at the centre."""
    neck = (b["neck_x"] + 0.5, neck_height)
    tip = (b["shoulder_x"] + 0.5, neck_height - (b["neck_y"] - b["shoulder_y"]) + 0.3)
    pit = (width, underarm)
    return Outline((0, 0), [
        Side((hip, 0), tag="left_hem"),
        Side(pit, [(0.6 * width + 0.4 * hip, 0.45 * underarm)], tag="left_side"),
        Side(tip, [(width - 0.22 * width, underarm + 0.8), (tip[0] - 1.3, tip[1] - 0.48 * (tip[1] - underarm))],
             tag="left_armhole", label="left_armhole"),
        Side(neck, tag="left_shoulder"),
        Side((0, neck_height - neck_depth),
             [(neck[0] - 0.5, neck[1] - 0.62 * neck_depth), (0.58 * neck[0], neck_height - neck_depth)],
             tag="left_collar", label="left_collar"),
    ])


def cap(height, width, top):
    """Edge of a half sleeve's cap from crown to underarm: S-shaped, square to the fold and to the underarm seam."""
    crown, pit = (-top, 0), (-(top - height), -width)
    return [crown, add(crown, (0, -0.42 * width)), add(pit, (0, 0.34 * width)), pit]


def sleeve_sizes(armholes, biceps, top):
    """Height of the cap, and widths of front and back half, with which each half's cap is as long as its armhole and
    the halves together are as wide as `biceps`."""
    def width(armhole, height):
        return solve(lambda w: length(cap(height, w, top)) - armhole, 1.0, 60.0)

    height = solve(lambda h: biceps - sum(width(a, h) for a in armholes), 2.0, min(top, 0.98 * min(armholes)))
    return height, [width(a, height) for a in armholes]


def half_sleeve(height, width, hem_width, top):
    """Front half of the left sleeve, hem at x = 0, top fold at y = 0."""
    crown, c1, c2, pit = cap(height, width, top)
    return Outline((0, 0), [
        Side(crown, tag="top"),
        Side(pit, [c1, c2], tag="cap"),
        Side((0, -hem_width), tag="underarm"),
        Side((0, 0), tag="cuff"),
    ])


def place_sleeve(b, top, width, off):
    """Where the hem end of the top fold goes, so that the half sleeve lies level with the arm, its crown beside the
    tip of the shoulder."""
    angle = math.radians(b["arm_angle"])
    out, up = (math.cos(angle), -math.sin(angle)), (math.sin(angle), math.cos(angle))
    to_tip = (b["shoulder_x"] - b["arm_x"], b["shoulder_y"] - b["arm_y"])
    reach = to_tip[0] * out[0] + to_tip[1] * out[1] + top + off
    return (b["arm_x"] + out[0] * reach + up[0] * 0.5 * width, b["arm_y"] + out[1] * reach + up[1] * 0.5 * width)


def sew_top(garment, b, prefix="", ease=8, biceps_ease=5.5, hem=2, sleeve=22.0, off=0.0, opens=False):
    """A top with set-in sleeves: its hem `hem` above the hip, its panels `off` farther from the body than those of a
    tee. One that opens has two fronts. Returns the left halves of front and back."""
    hem_y = b["hip_y"] + hem
    chest = b["bust"] + ease
    underarm = b["armpit_y"] - 2.5 - hem_y
    neck = b["neck_y"] - 0.4 - hem_y
    hip = max(chest, b["hip"] + ease - 4)
    front_half = tee_body(b, chest / 4 + 0.5, 9.5, neck + 2.0, underarm, hip / 4 + 0.5)
    back_half = tee_body(b, chest / 4 - 0.5, 2.4, neck + 1.2, underarm, hip / 4 - 0.5)
    front_z, back_z = b["front_z"] + 9 + off, b["back_z"] - 7 - off
    fronts = (f"{prefix}front",) * 2
    if opens:
        fronts = (f"{prefix}left_front", f"{prefix}right_front")
        half = Outline(front_half.start, front_half.sides + [Side(front_half.start, tag="left_edge")])
        garment.panel(fronts[0], half, (0.4, hem_y, front_z))
        garment.panel(fronts[1], half.mirror(), (-0.4, hem_y, front_z))
    else:
        garment.panel(fronts[0], whole(front_half), (0, hem_y, front_z))
    back = f"{prefix}back"
    garment.panel(back, whole(back_half).turned(), (0, hem_y, back_z))

    biceps = b["upper_arm"] + biceps_ease
    height, widths = sleeve_sizes([half.edge_length("left_armhole") for half in (front_half, back_half)], biceps,
                                  sleeve)
    x, y = place_sleeve(b, sleeve, biceps / 2, off=2.0)
    apart = 12 + 0.8 * off
    for name, width, z in zip("fb", widths, (b["arm_z"] + apart, b["arm_z"] - apart)):
        outline = half_sleeve(height, width, width - 1.2, sleeve)
        left = outline if name == "f" else outline.turned()
        garment.panel(f"{prefix}left_sleeve_{name}", left, (x, y, z), -b["arm_angle"], "arm")
        garment.panel(f"{prefix}right_sleeve_{name}", left.mirror(), (-x, y, z), b["arm_angle"], "arm")

    garment.sew_both(fronts[0], "left_shoulder", back, "left_shoulder")
    garment.sew_both(fronts[0], "left_side", back, "left_side")
    left_f, left_b = f"{prefix}left_sleeve_f", f"{prefix}left_sleeve_b"
    garment.sew_both(left_f, "top", left_b, "top")
    garment.sew_both(left_f, "underarm", left_b, "underarm")
    garment.sew_both(left_f, "cap", fronts[0], "left_armhole")
    garment.sew_both(left_b, "cap", back, "left_armhole")
    return front_half, back_half


def tee(b):
    garment = Garment()
    sew_top(garment, b)
    return garment


def hood(front_neck, back_neck):
    """Left half of a hood, seen from the left: x toward the back, the end of the shoulder seam at (0, 1)."""
    shoulder = (0.0, 1.0)
    turn = math.radians(22)
    front = add(shoulder, (-front_neck * math.cos(turn), -front_neck * math.sin(turn)))
    turn = math.radians(7)
    back = add(shoulder, (back_neck * math.cos(turn), -back_neck * math.sin(turn)))
    crown, brow = (14.0, 20.0), (-10.0, 35.0)
    return Outline(front, [
        Side(shoulder, tag="left_front_neck"),
        Side(back, tag="left_back_neck"),
        Side(crown, [(back[0] + 3.6, 0.5 * (back[1] + crown[1]))], tag="left_nape"),
        Side(brow, [(13.6, 31.0), (4.0, 38.5)], tag="left_crown"),
        Side(front, tag="left_opening"),
    ])


def hooded_top(b):
    garment = Garment()
    front, back = sew_top(garment, b)
    half = hood(*(o.edge_length("left_collar") for o in (front, back)))
    y, z = b["neck_y"] - 1.5, 0.5 * (b["front_z"] + b["back_z"]) - 1.7
    garment.panel("left_hood", half, (13.0, y, z), label="head", about_y=90.0)
    garment.panel("right_hood", half.mirror(), (-13.0, y, z), label="head", about_y=-90.0)
    garment.sew_both("left_hood", "left_front_neck", "front", "left_collar")
    garment.sew_both("left_hood", "left_back_neck", "back", "left_collar")
    for tag in ("left_nape", "left_crown"):
        garment.sew("left_hood", tag, "right_hood", mirrored(tag))
    return garment


def shirt_and_jacket(b):
    """A tee, and over it a jacket that opens at the front."""
    garment = Garment()
    sew_top(garment, b)
    wide = dict(b, neck_x=b["neck_x"] + 1.0, neck_y=b["neck_y"] + 0.6, shoulder_x=b["shoulder_x"] + 1.2,
                armpit_y=b["armpit_y"] - 4.0)
    sew_top(garment, wide, prefix="jacket_", ease=16, biceps_ease=11, hem=-5, sleeve=25.0, off=9.0, opens=True)
    return garment


# ---- skirts ------------------------------------------------------------------------------------------------------

def skirt_half(waist, centre, dart, dart_length, hip, hip_depth, skirt_length, flare, raise_side, side_length):
    """Left half of an A-line skirt's front or back, waist at y = 0. `waist` is what is left of it when the dart,
    `centre` from the centre line, is closed. `side_length`: of the curve from waist to hip, None to let it fall."""
    def points(raised):
        dart_in, dart_out = (centre, 0.15 * raised), (centre + dart, 0.3 * raised)
        # Straight on from the dart to the side, so long that the pieces make up the waist.
        x = math.sqrt((waist - centre) ** 2 - (0.7 * raised) ** 2)
        side = (dart_out[0] + x, raised)
        middle = (0.5 * (dart_in[0] + dart_out[0]), 0.5 * (dart_in[1] + dart_out[1]))
        across = (dart_out[0] - dart_in[0], dart_out[1] - dart_in[1])
        down = dart_length / math.hypot(*across)
        tip = (middle[0] + across[1] * down, middle[1] - across[0] * down)
        hip_point = (hip, -hip_depth)
        control = (hip - 0.45 * hip_depth * flare / drop, -0.55 * hip_depth)  # the side runs on without a corner
        return dart_in, tip, dart_out, side, control, hip_point

    drop = skirt_length - hip_depth
    raised = raise_side
    if side_length is not None:
        raised = solve(lambda r: length([points(r)[3], points(r)[4], points(r)[5]]) - side_length, 0.0, 4.0)
    dart_in, tip, dart_out, side, control, hip_point = points(raised)
    hem_side = (hip + flare, -skirt_length + 0.5 * flare * flare / drop + 0.6)
    return Outline((0, -skirt_length), [
        Side(hem_side, [(0.5 * hem_side[0], -skirt_length)], tag="left_hem"),
        Side(hip_point, tag="left_side"),
        Side(side, [control], tag="left_hip"),
        Side(dart_out, tag="left_waist", label="lower_interface"),
        Side(tip, tag="left_dart_out"),
        Side(dart_in, tag="left_dart_in"),
        Side((0, 0), tag="left_centre", label="lower_interface"),
    ])


def sew_skirt(garment, front, back):
    garment.sew_both(front, "left_side", back, "left_side")
    garment.sew_both(front, "left_hip", back, "left_hip")
    for panel in (front, back):
        garment.sew_both(panel, "left_dart_out", panel, "left_dart_in")


def draft_skirt(garment, b, prefix="", ease=0.0, skirt_length=58, flare=7, off=0.0):
    """An A-line skirt, its panels `off` farther from the body than those of one worn alone."""
    waist, hip = b["waist"] + b["waist_ease"] + ease, b["hip"] + 4 + ease
    depth = b["waist_y"] - b["hip_y"]
    front = skirt_half(waist / 4 + 0.5, 8.5, 2.2, 9.5, hip / 4 + 0.25, depth, skirt_length, flare, 1.2, None)
    back = skirt_half(waist / 4 - 0.5, 7.5, 3.6, 13.5, hip / 4 - 0.25, depth, skirt_length, flare, 1.2,
                      front.edge_length("left_hip"))
    names = f"{prefix}front", f"{prefix}back"
    garment.panel(names[0], whole(front), (0, b["waist_y"], b["front_z"] + 7 + off), label="leg")
    garment.panel(names[1], whole(back).turned(), (0, b["waist_y"], b["back_z"] - 8 - off), label="leg")
    sew_skirt(garment, *names)


def skirt(b):
    garment = Garment()
    draft_skirt(garment, b)
    return garment


def two_layer_skirt(b):
    """A skirt, and over it a shorter and wider one."""
    garment = Garment()
    draft_skirt(garment, b)
    draft_skirt(garment, b, prefix="over_", ease=3, skirt_length=46, flare=12, off=6.0)
    return garment


def pleated_skirt(b, count=8, skirt_length=45.0, band=4.0, angle=170.0):
    """Front and back of `count` knife pleats each on a waistband. Of a pleat a third is seen, a third lies under it
    and a third leads back; at the waist the last two are sewn to each other."""
    garment = Garment()
    seen = (b["waist"] + b["waist_ease"]) / (2 * count)
    wide, high = 1.5 * count * seen, skirt_length
    top, folds = [], []
    for k in range(count):
        at = [wide - (3 * k + part) * seen for part in (1, 2, 3)]
        top += [Side((x, 0), tag=f"{part}_{k}") for x, part in zip(at, ("seen", "under", "back"))]
        folds += [(at[0], angle), (at[1], -angle)]
    front = Outline((-wide, -high), [Side((wide, -high), tag="hem"), Side((wide, 0), tag="left_side"), *top,
                                     Side((-wide, -high), tag="right_side")])
    round_half = count * seen / 2
    waist = Outline((-round_half, 0), [
        *[Side((-round_half + (k + 1) * seen, 0), tag=f"seen_{count - 1 - k}") for k in range(count)],
        Side((round_half, band), tag="left_end"),
        Side((-round_half, band), tag="top", label="lower_interface"),
        Side((-round_half, 0), tag="right_end")])
    y = b["waist_y"] - band
    for half, z, turned in (("front", b["front_z"] + 7, False), ("back", b["back_z"] - 8, True)):
        for name, outline, drop in ((half, front, 1), (f"band_{half}", waist, 0)):
            garment.panel(name, outline.mirror().turned() if turned else outline, (0, y - drop, z), label="leg")
        garment.lines[half] = [{"vertices": [rounded((-x if turned else x, 0)), rounded((-x if turned else x, -high))],
                                "kind": "pleat", "angle": fold} for x, fold in folds]
        for k in range(count):
            garment.sew(half, f"seen_{k}", f"band_{half}", f"seen_{k}")
            garment.sew(half, f"under_{k}", half, f"back_{k}")
    garment.sew_both("front", "left_side", "back", "left_side")
    garment.sew_both("band_front", "left_end", "band_back", "left_end")
    return garment


# ---- trousers ----------------------------------------------------------------------------------------------------

def trouser_half(waist, dart, dart_at, dart_length, hip, fork, hem, waist_y, hip_y, crotch_y, top, lean, hip_length):
    """Left leg's front or back, hem at y = 0, centre line of the body at x = 0. `fork` is how far the crotch reaches
    past it; the centre seam leans by `lean` at the waist and its top is `top` above the waist. The side is raised at
    the waist until its part above the hip is `hip_length` long; not at all when that is None."""
    crotch = (-fork, crotch_y)
    crease = 0.5 * (hip - fork)
    centre = (lean, waist_y + top)
    # The centre seam is straight down to where the curve begins, a third of the way from crotch to hip.
    bend_y = crotch_y + 0.55 * (hip_y - crotch_y) + 2.0
    bend = (lean * (bend_y - hip_y) / (waist_y + top - hip_y) if lean else 0.0, bend_y)
    span = waist + dart
    control = (hip + 0.1, hip_y + 0.5 * (waist_y - hip_y))

    def side_at(raised):
        return (centre[0] + math.sqrt(span * span - (top - raised) ** 2), waist_y + raised)

    raised = 0.0
    if hip_length is not None:
        raised = solve(lambda r: length([(hip, hip_y), control, side_at(r)]) - hip_length, -1.0, 2.0)
    side = side_at(raised)
    dart_in = along(centre, side, dart_at)
    dart_out = along(centre, side, dart_at + dart)
    middle = along(centre, side, dart_at + dart / 2)
    across = ((side[0] - centre[0]) / span, (side[1] - centre[1]) / span)
    tip = (middle[0] + across[1] * dart_length, middle[1] - across[0] * dart_length)
    return Outline((crease - hem / 2, 0), [
        Side((crease + hem / 2, 0), tag="hem"),
        Side((hip, hip_y), tag="left_outseam"),
        Side(side, [control], tag="left_hip"),
        Side(dart_out, tag="waist_side", label="lower_interface"),
        Side(tip, tag="dart_out"),
        Side(dart_in, tag="dart_in"),
        Side(centre, tag="waist_centre", label="lower_interface"),
        Side(bend, tag="rise"),
        Side(crotch, [(bend[0] - 0.08 * fork, crotch_y + 0.25 * (bend_y - crotch_y)),
                      (-0.45 * fork, crotch_y)], tag="fork"),
        Side((crease - hem / 2, 0), [(crease - hem / 2 - 0.2 * fork, 0.55 * crotch_y)], tag="inseam"),
    ])


def trousers(b):
    garment = Garment()
    hem_y = 7.0
    waist, hip = b["waist"] + b["waist_ease"], b["hip"] + 5
    levels = (b["waist_y"] - hem_y, b["hip_y"] - hem_y, b["crotch_y"] - 1.5 - hem_y)
    front = trouser_half(waist / 4 + 0.5, 2.0, 8.5, 9.0, hip / 4 - 0.5, 0.055 * hip, 21, *levels, 0.0, 0.8, None)
    back = trouser_half(waist / 4 - 0.5, 3.6, 8.0, 12.5, hip / 4 + 0.5, 0.10 * hip, 23, *levels, 2.5, 3.6,
                        front.edge_length("left_hip"))
    for name, leg, z in (("f", front, b["front_z"] + 7), ("b", back, b["back_z"] - 8)):
        fork = 1.0 - min(v[0] for v in leg.starts())  # the two legs' crotches side by side
        left = leg if name == "f" else leg.turned()
        garment.panel(f"leg_{name}_l", left, (fork, hem_y, z), label="leg")
        garment.panel(f"leg_{name}_r", left.mirror(), (-fork, hem_y, z), label="leg")
    garment.sew_both("leg_f_l", "left_outseam", "leg_b_l", "left_outseam")
    garment.sew_both("leg_f_l", "left_hip", "leg_b_l", "left_hip")
    garment.sew_both("leg_f_l", "inseam", "leg_b_l", "inseam")
    for panel in ("leg_f_l", "leg_b_l"):
        garment.sew_both(panel, "dart_out", panel, "dart_in")
    for name in ("f", "b"):
        for tag in ("rise", "fork"):
            garment.sew(f"leg_{name}_l", tag, f"leg_{name}_r", tag)
    return garment


# ---- dress -------------------------------------------------------------------------------------------------------

def bodice_half(b, width, waist, centre, dart, dart_length, neck_height, neck_depth, underarm, bust_dart):
    """Left half of a sleeveless bodice, waist at y = 0. `bust_dart` is the width of a dart from the side toward the
    bust point, 0 for none; the side is cut in the same place without it, so that front and back can be sewn edge to
    edge."""
    side = (waist + dart, 0.0)
    pit = (width, underarm + bust_dart)
    neck = (b["neck_x"] + 2.0, neck_height)
    tip = (b["shoulder_x"] - 2.0, neck_height - (b["neck_y"] - b["shoulder_y"]) * 0.72)
    bust_y = 0.72 * underarm
    low = along(side, pit, bust_y)
    sides = [
        Side((centre, 0), tag="left_centre"),
        Side((centre + dart / 2, dart_length), tag="left_dart_in"),
        Side((centre + dart, 0), tag="left_dart_out"),
        Side(side, tag="left_waist"),
        Side(low, tag="left_side_low"),
    ]
    if bust_dart:
        high = along(side, pit, bust_y + bust_dart)
        middle = along(side, pit, bust_y + bust_dart / 2)
        inward = along((0, 0), (side[1] - pit[1], pit[0] - side[0]), 0.5 * width)
        sides += [Side(add(middle, inward), tag="left_bust_low"), Side(high, tag="left_bust_high")]
    sides += [
        Side(pit, tag="left_side_high"),
        Side(tip, [(0.72 * width, pit[1] + 0.8), (tip[0] - 1.0, tip[1] - 0.45 * (tip[1] - pit[1]))],
             tag="left_armhole", label="left_armhole"),
        Side(neck, tag="left_shoulder"),
        Side((0, neck_height - neck_depth),
             [(neck[0] - 0.8, neck[1] - 0.6 * neck_depth), (0.6 * neck[0], neck_height - neck_depth)],
             tag="left_collar", label="left_collar"),
    ]
    return Outline((0, 0), sides)


def dress(b):
    garment = Garment()
    chest, waist, hip = b["bust"] + 5, b["waist"] + 4, b["hip"] + 6
    underarm = b["armpit_y"] - 2.0 - b["waist_y"]
    front_waist, back_waist = waist / 4 + 0.75, waist / 4 - 0.75
    front_centre, back_centre = 7.0, 6.5
    front = bodice_half(b, chest / 4 + 1, front_waist, front_centre, 3.0, 11.5, b["front_over_bust"] - 0.8, 9.0,
                        underarm, 3.0)
    back = bodice_half(b, chest / 4 - 1, back_waist, back_centre, 2.6, 13.0, b["back_to_waist"] - 0.8, 4.0, underarm, 0)
    depth = b["waist_y"] - b["hip_y"]
    skirt_front = skirt_half(front_waist, front_centre, 2.2, 9.0, hip / 4 + 0.5, depth, 62, 10, 0.8, None)
    skirt_back = skirt_half(back_waist, back_centre, 3.4, 13.0, hip / 4 - 0.5, depth, 62, 10, 0.8,
                            skirt_front.edge_length("left_hip"))
    front_z, back_z = b["front_z"] + 8, b["back_z"] - 7
    # Bodice and skirt start a few centimetres apart, so that nothing touches.
    garment.panel("bodice_front", whole(front), (0, b["waist_y"] + 2, front_z))
    garment.panel("bodice_back", whole(back).turned(), (0, b["waist_y"] + 2, back_z))
    garment.panel("skirt_front", whole(skirt_front), (0, b["waist_y"] - 1, front_z), label="leg")
    garment.panel("skirt_back", whole(skirt_back).turned(), (0, b["waist_y"] - 1, back_z), label="leg")

    garment.sew_both("bodice_front", "left_shoulder", "bodice_back", "left_shoulder")
    garment.sew_both("bodice_front", "left_side_low", "bodice_back", "left_side_low")
    garment.sew_both("bodice_front", "left_side_high", "bodice_back", "left_side_high")
    garment.sew_both("bodice_front", "left_bust_low", "bodice_front", "left_bust_high")
    for half in ("front", "back"):
        garment.sew_both(f"bodice_{half}", "left_dart_in", f"bodice_{half}", "left_dart_out")
        garment.sew_both(f"bodice_{half}", "left_waist", f"skirt_{half}", "left_waist")
        garment.sew(f"bodice_{half}", "centre", f"skirt_{half}", "centre")
    sew_skirt(garment, "skirt_front", "skirt_back")
    return garment


GARMENTS = {"tee": (tee, "jersey"), "skirt": (skirt, "wool"), "trousers": (trousers, "linen"),
            "dress": (dress, "poplin"), "hooded_top": (hooded_top, "jersey"),
            "two_layer_skirt": (two_layer_skirt, "poplin"), "pleated_skirt": (pleated_skirt, "wool"),
            "shirt_and_jacket": (shirt_and_jacket, "jersey")}
OUTER = {"over_": "wool", "jacket_": "denim"}  # panels so named lie outside, and their fabric


def companion(garment, fabric):
    said = {"toile": 1, "fabric": fabric}
    panels = {name: {"fabric": cloth, "layer": 1} for name in garment.panels for word, cloth in OUTER.items()
              if name.startswith(word)}
    panels |= {name: {"lines": lines} for name, lines in garment.lines.items()}
    return dict(said, panels=panels) if panels else said


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    here = pathlib.Path(__file__).resolve().parent.parent
    parser.add_argument("--body", type=pathlib.Path, help="JSON file that overrides entries of BODY")
    parser.add_argument("--out", type=pathlib.Path, default=here / "examples")
    options = parser.parse_args()
    body = dict(BODY)
    if options.body:
        given = json.loads(options.body.read_text())
        unknown = sorted(set(given) - set(BODY))
        if unknown:
            parser.error(f"{options.body}: unknown measures {', '.join(unknown)}; known are {', '.join(BODY)}")
        body.update(given)
    options.out.mkdir(parents=True, exist_ok=True)
    for name, (draft, fabric) in GARMENTS.items():
        garment = draft(body)
        for ending, what in ((".json", garment.specification()), (".toile.json", companion(garment, fabric))):
            (options.out / f"{name}{ending}").write_text(json.dumps(what, indent=1) + "\n")


if __name__ == "__main__":
    main()

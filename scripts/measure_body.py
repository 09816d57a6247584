#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures a body for scripts/make_examples.py: girths, heights and places in centimetres, as JSON.

    scripts/measure_body.py body.obj > b.json
    scripts/make_examples.py --body b.json --out dir

The body is an OBJ file, closed, standing, y up and facing +z, in any of m, cm and mm, arms anywhere between hanging and
level. Girths are what a tape reads: the length round the convex hull of a section.
"""

import argparse
import json
import math
import pathlib

STEP = 0.5  # cm between sections


# ---- sections ----------------------------------------------------------------------------------------------------

def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    return tuple(c / math.hypot(*a) for c in a)


def read_obj(path):
    """Points in centimetres, feet at 0, and triangles."""
    points, triangles = [], []
    for line in path.read_text().splitlines():
        word, *rest = line.split() or [""]
        if word == "v":
            points.append(tuple(float(v) for v in rest[:3]))
        elif word == "f":
            corners = [int(c.split("/")[0]) for c in rest]
            corners = [c - 1 if c > 0 else len(points) + c for c in corners]
            triangles += [(corners[0], b, c) for b, c in zip(corners[1:], corners[2:])]
    if not triangles:
        raise SystemExit(f"{path}: no faces; an OBJ file of a closed body was expected")
    floor = min(p[1] for p in points)
    height = max(p[1] for p in points) - floor
    scale = next((s for s in (100, 1, 0.1) if 50 < height * s < 250), None)
    if scale is None:
        raise SystemExit(f"{path}: {height:g} high; a person of 0.5 to 2.5 m, y up, in m, cm or mm was expected")
    return [(scale * x, scale * (y - floor), scale * z) for x, y, z in points], triangles


def section(body, normal, offset):
    """Loops of the points at which the plane cuts the body."""
    points, triangles = body
    side = [dot(p, normal) - offset for p in points]
    at, step = {}, {}
    for t in triangles:
        cut = []
        for a, b in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0])):
            if (side[a] < 0) != (side[b] < 0):
                key, u = (min(a, b), max(a, b)), side[a] / (side[a] - side[b])
                at[key] = tuple(p + u * (q - p) for p, q in zip(points[a], points[b]))
                cut.append((side[a] < 0, key))
        if cut:
            cut.sort()
            step[cut[0][1]] = cut[1][1]
    loops = []
    while step:
        key = first = next(iter(step))
        loop = []
        while key in step:
            loop.append(at[key])
            key = step.pop(key)
        if key == first and len(loop) > 2:
            loops.append(loop)
    return loops


def area(loop):
    return 0.5 * abs(sum(p[0] * q[1] - p[1] * q[0] for p, q in zip(loop, loop[1:] + loop[:1])))


def hull(points):
    """Convex hull of plane points, counter-clockwise."""
    def half(ordered):
        chain = []
        for p in ordered:
            while len(chain) > 1 and ((chain[-1][0] - chain[-2][0]) * (p[1] - chain[-2][1])
                                      <= (chain[-1][1] - chain[-2][1]) * (p[0] - chain[-2][0])):
                chain.pop()
            chain.append(p)
        return chain[:-1]

    ordered = sorted(set(points))
    return half(ordered) + half(ordered[::-1])


def around(loop):
    return sum(math.dist(p, q) for p, q in zip(loop, loop[1:] + loop[:1]))


def mean(points):
    return tuple(sum(c) / len(points) for c in zip(*points))


class Level:
    """The torso at one height: the loop round the axis. `found` is false below the crotch."""

    def __init__(self, body, y, axis):
        self.y = y
        loops = [[(x - axis, z) for x, _, z in loop] for loop in section(body, (0, 1, 0), y)]
        loops = [loop for loop in loops if min(p[0] for p in loop) < 0 < max(p[0] for p in loop)]
        self.found = bool(loops)
        if self.found:
            loop = max(loops, key=area)
            self.girth = around(hull(loop))
            self.half_width = 0.5 * (max(p[0] for p in loop) - min(p[0] for p in loop))
            self.front, self.back = max(p[1] for p in loop), min(p[1] for p in loop)


# ---- the body ----------------------------------------------------------------------------------------------------

def torso(body):
    """Levels from crotch to neck, upward, and indices of hip, waist, bust and armpit."""
    height = max(p[1] for p in body[0])
    middle = max(section(body, (0, 1, 0), 0.58 * height), key=lambda loop: area([(x, z) for x, _, z in loop]))
    axis = 0.5 * (min(p[0] for p in middle) + max(p[0] for p in middle))
    levels = []
    y = 0.58 * height
    while y > 0.25 * height and (level := Level(body, y, axis)).found:
        levels.insert(0, level)
        y -= STEP
    if y <= 0.25 * height:
        raise SystemExit("the body does not stand on two legs")
    crotch_y = y + 0.5 * STEP
    y = 0.58 * height + STEP
    while y < 0.90 * height:
        levels.append(Level(body, y, axis))
        y += STEP

    def among(low, high):
        return [i for i, level in enumerate(levels) if low * height <= level.y <= high * height]

    girth = lambda i: levels[i].girth
    armpit = next((i for i in among(0.62, 0.88)
                   if levels[i + 1].half_width - levels[i].half_width > 0.005 * height), among(0.76, 1)[0])
    near_waist = min(among(0.57, 0.68), key=girth)
    hip = max(range(near_waist), key=girth)
    reach = round(0.02 * height / STEP)
    bust = next((i for i in range(armpit - 1, near_waist + reach, -1)
                 if levels[i].front == max(level.front for level in levels[i - reach:min(i + reach, armpit) + 1])),
                max(range(near_waist, armpit), key=girth))
    waist = min(range(hip, bust), key=girth)
    return levels, axis, crotch_y, hip, waist, bust, armpit


def at_half_width(levels, half_width):
    """Height at which the outline, seen from the front, narrows upward to a half width."""
    for high, low in zip(levels[::-1], levels[-2::-1]):
        if low.half_width >= half_width > high.half_width:
            u = (low.half_width - half_width) / (low.half_width - high.half_width)
            return low.y + u * (high.y - low.y)
    return levels[-1].y


def left_arm(body, tip, armpit):
    """A point of the upper arm's axis, its direction, and the largest girth that is clear of the torso."""
    hand = max(body[0])
    axis = tuple(h - t for h, t in zip(hand, tip))
    reach = math.hypot(*axis)
    point = tip
    for _ in range(4):
        axis = tuple(a / math.hypot(*axis) for a in axis)
        centres = []
        for share in (0.25, 0.30, 0.35, 0.40):
            on = tuple(p + share * reach * a for p, a in zip(tip, axis))
            loops = section(body, axis, dot(on, axis))
            centres.append(min((mean(loop) for loop in loops), key=lambda c: math.dist(c, on)))
        axis = tuple(b - a for a, b in zip(centres[0], centres[-1]))
        point = mean(centres)
    axis = tuple(a / math.hypot(*axis) for a in axis)
    across = unit(cross(axis, (0, 0, 1)))
    other = cross(axis, across)
    clear = max(dot(armpit, axis), dot(tip, axis)) + 2
    loops = section(body, axis, clear)
    on = tuple(p + (clear - dot(point, axis)) * a for p, a in zip(point, axis))
    loop = min(loops, key=lambda loop: math.dist(mean(loop), on))
    return point, axis, around(hull([(dot(p, across), dot(p, other)) for p in loop]))


def tape(body, x, low, high, front):
    """Length of a tape down from the neck to the waist, in a plane beside the middle, over all that stands out."""
    sign = 1 if front else -1
    outline = []
    for loop in section(body, (1, 0, 0), x):
        ring = [(sign * z, y) for _, y, z in loop]
        outline += [p for p in ring if low <= p[1] <= high]
        outline += [(p[0] + (low - p[1]) / (q[1] - p[1]) * (q[0] - p[0]), low)
                    for p, q in zip(ring, ring[1:] + ring[:1]) if (p[1] < low) != (q[1] < low)]
    top = max(outline, key=lambda p: p[1])
    bottom = max(p for p in outline if p[1] == low)
    outer = [p for p in outline if p[0] >= min(top[0], bottom[0])]
    chain = hull(outer + [(-999, low), (-999, top[1])])[1:-1]
    return sum(math.dist(p, q) for p, q in zip(chain, chain[1:]))


def waist_ease(levels, waist, sink=1.5, stretch=0.015):
    """With which a waist that gives a little under the garment's weight comes to rest `sink` below its place. Bodies
    widen little there: on some a centimetre of ease would let it sink by four."""
    below = levels[waist - round(sink / STEP)].girth
    return min(1, below - (1 + stretch) * levels[waist].girth)


def measure(body):
    levels, axis, crotch_y, hip, waist, bust, armpit = torso(body)
    below, above = levels[:armpit + 1], levels[armpit + 1:]
    neck_x = 1.6 * min(level.half_width for level in above)
    shoulder_x = 1.2 * levels[armpit].half_width
    neck_y, shoulder_y = at_half_width(above, neck_x), at_half_width(above, shoulder_x)
    # Hips stay as wide down to where the legs part; what is cut to them must narrow from their upper end on.
    hip_top = max(i for i in range(waist) if levels[i].girth >= 0.985 * levels[hip].girth)
    shoulder = min(above, key=lambda level: abs(level.y - shoulder_y))
    depth = 0.5 * (shoulder.front + shoulder.back)
    pit = levels[armpit]
    arm, along, upper_arm = left_arm(body, (axis + shoulder_x, shoulder_y, depth),
                                     (axis + pit.half_width, pit.y, 0.5 * (pit.front + pit.back)))
    tapes = [tape(body, axis + neck_x, levels[waist].y, neck_y + 0.5, front) for front in (True, False)]
    measures = {
        "bust": levels[bust].girth, "waist": levels[waist].girth, "hip": levels[hip].girth,
        "waist_ease": waist_ease(levels, waist),
        "bust_y": levels[bust].y, "waist_y": levels[waist].y, "hip_y": levels[hip_top].y, "crotch_y": crotch_y,
        "armpit_y": pit.y, "neck_x": neck_x, "neck_y": neck_y, "shoulder_x": shoulder_x, "shoulder_y": shoulder_y,
        "front_z": max(level.front for level in below), "back_z": min(level.back for level in below),
        "front_over_bust": tapes[0], "back_to_waist": tapes[1],
        "arm_x": arm[0] - axis, "arm_y": arm[1], "arm_z": arm[2],
        "arm_angle": math.degrees(math.atan2(-along[1], along[0])), "upper_arm": upper_arm,
    }
    return {name: round(value, 1) for name, value in measures.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("body", type=pathlib.Path, help="OBJ file")
    print(json.dumps(measure(read_obj(parser.parse_args().body)), indent=1))


if __name__ == "__main__":
    main()

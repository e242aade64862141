#!/usr/bin/env python3
"""Writes pair_loads.csv: force and torque on the first of two cuboids, with 30 working digits.

The charges J . n of the faces of the first cuboid are integrated in the field of the second, whose
closed form (arctangents and logarithms of its corners) is in any textbook. Faces are divided at
the projected edges of the second cuboid, where the field has its logarithms. Parts that do not touch it
are integrated by Gauss-Legendre rules, the others by tanh-sinh rules. No sum over 64 corners occurs.

Needs mpmath. Takes about half an hour.
"""

import csv
import sys
from pathlib import Path

import mpmath as mp

mp.mp.dps = 30
MU_0 = mp.mpf("1.25663706127e-6")
# Contact is the limit of a gap that closes.
GAP = mp.mpf(10) ** -24

CASES = [
    # tag, first: size, J, centre; second: size, J, centre
    ("apart", (2, 3, 1), (0.1, -0.05, 0.2), (0, 0, 0), (1, 1.5, 2.5), (-0.07, 0.15, 0.11), (3.25, 1.5, -2)),
    ("apart", (1, 1, 1), (0, 0, 1), (0, 0, 0), (1, 1, 1), (0, 0, 1), (0.25, 0.125, 1.5)),
    ("apart", (1, 2, 1), (1, 0, 0), (0, 0, 0), (1, 1, 1), (0, 1, 0), (-1.75, 0.5, 0.25)),
    ("apart", (4, 4, 0.25), (0.3, 0.1, 0.5), (1, 1, 0), (3, 2, 0.5), (0.1, 0.6, -0.4), (0.5, 2, 1.25)),
    ("far", (2, 3, 1), (0.1, -0.05, 0.2), (0, 0, 0), (1, 1.5, 2.5), (-0.07, 0.15, 0.11), (30, 10, -20)),
    ("far", (2, 3, 1), (0.1, -0.05, 0.2), (0, 0, 0), (1, 1.5, 2.5), (-0.07, 0.15, 0.11), (80, 10, -90)),
    ("far", (2, 3, 1), (0.1, -0.05, 0.2), (0, 0, 0), (1, 1.5, 2.5), (-0.07, 0.15, 0.11), (-800, 100, 900)),
    ("far", (2, 2, 2), (0, 0, 1), (0, 0, 0), (0.5, 1, 0.25), (0, 1, 0), (0, 128, 0)),
    ("beside", (3.25, 3.25, 1), (0.12, 0, 0), (0, 0, 0.5), (3.25, 1.75, 1), (0, 0.12, 0), (3.25, 0.75, 0.5)),
    ("stacked", (1, 1, 1), (0, 0, 1), (0, 0, 0), (1, 1, 1), (0, 0, 1), (0, 0, 1)),
    ("stacked", (2, 1, 1), (0.2, 0.1, 0.4), (0, 0, 0), (1, 1.5, 0.5), (-0.1, 0.3, 0.2), (0.25, 0.5, -0.75)),
    ("edge", (1, 1, 1), (0.3, 0.2, 0.4), (0, 0, 0), (1, 1, 1), (-0.1, 0.3, 0.2), (1, 1, 0)),
]


def corner(d):
    """Second derivatives of the potential of a corner: arctangents and logarithms."""
    x, y, z = d
    r = mp.sqrt(x * x + y * y + z * z)
    angle = [mp.atan2(y * z * mp.sign(x), abs(x) * r), mp.atan2(x * z * mp.sign(y), abs(y) * r),
             mp.atan2(x * y * mp.sign(z), abs(z) * r)]
    across = [y * y + z * z, z * z + x * x, x * x + y * y]
    log = [mp.sign(u) * mp.log((abs(u) + r) / mp.sqrt(s)) if u else mp.mpf(0) for u, s in zip(d, across)]
    return angle, log


def mu0_h(size, polarization, centre, point):
    total = [mp.mpf(0)] * 3
    for n in range(8):
        signs = [1 if n >> k & 1 else -1 for k in range(3)]
        d = [point[k] - centre[k] - signs[k] * size[k] / 2 for k in range(3)]
        angle, log = corner(d)
        sign = signs[0] * signs[1] * signs[2]
        for c in range(3):
            for a in range(3):
                if polarization[a]:
                    total[c] += sign * polarization[a] * (-angle[c] if a == c else log[3 - a - c])
    return [-t / (4 * mp.pi) for t in total]


def gauss(count):
    """Nodes and weights on [0, 1]."""
    rule = []
    for k in range(1, count + 1):
        # Newton's method from Tricomi's start.
        x = mp.cos(mp.pi * (k - mp.mpf(1) / 4) / (count + mp.mpf(1) / 2))
        for _ in range(8):
            p0, p1 = mp.mpf(1), x
            for n in range(2, count + 1):
                p0, p1 = p1, ((2 * n - 1) * x * p1 - (n - 1) * p0) / n
            slope = count * (x * p1 - p0) / (x * x - 1)
            x -= p1 / slope
        rule.append(((1 + x) / 2, 1 / ((1 - x * x) * slope**2)))
    return rule


def tanh_sinh(step, reach):
    rule = []
    for n in range(-reach, reach + 1):
        t = n * step
        u = mp.pi / 2 * mp.sinh(t)
        rule.append((1 / (1 + mp.exp(-2 * u)), step * mp.pi / 4 * mp.cosh(t) / mp.cosh(u) ** 2))
    return rule


def cuts(low, high, others):
    inner = sorted({o for o in others if low < o < high})
    return [low, *inner, high]


def load(first, second, rule):
    (size, polarization, centre), source = first, second
    force, torque = [mp.mpf(0)] * 3, [mp.mpf(0)] * 3
    for axis in range(3):
        for sign in (-1, 1):
            charge = sign * polarization[axis]
            if not charge:
                continue
            u, v = (axis + 1) % 3, (axis + 2) % 3
            parts = [
                cuts(centre[k] - size[k] / 2, centre[k] + size[k] / 2,
                     [source[2][k] - source[0][k] / 2, source[2][k] + source[0][k] / 2])
                for k in (u, v)
            ]
            for u0, u1 in zip(parts[0], parts[0][1:]):
                for v0, v1 in zip(parts[1], parts[1][1:]):
                    for tu, wu in rule:
                        for tv, wv in rule:
                            point = [mp.mpf(0)] * 3
                            point[axis] = centre[axis] + sign * size[axis] / 2
                            point[u] = u0 + (u1 - u0) * tu
                            point[v] = v0 + (v1 - v0) * tv
                            weight = charge * wu * wv * (u1 - u0) * (v1 - v0)
                            h = mu0_h(*source, point)
                            lever = [point[k] - centre[k] for k in range(3)]
                            for k in range(3):
                                p, q = (k + 1) % 3, (k + 2) % 3
                                force[k] += weight * h[k]
                                torque[k] += weight * (lever[p] * h[q] - lever[q] * h[p])
    return [f / MU_0 for f in force], [t / MU_0 for t in torque]


def exact(vector):
    return [mp.mpf(v) for v in vector]


def main():
    rules = {
        "apart": gauss(32),
        "far": gauss(12),
        "touching": tanh_sinh(mp.mpf(1) / 20, 67),
    }
    with open(Path(__file__).with_suffix(".csv"), "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        names = [f"{name}{n}_{k}" for n in (1, 2) for name in ("size", "j", "c") for k in "xyz"]
        writer.writerow(["tag", *names, *[f"f_{k}" for k in "xyz"], *[f"t_{k}" for k in "xyz"]])
        for tag, *numbers in CASES:
            first, second = [list(map(exact, numbers[n : n + 3])) for n in (0, 3)]
            inputs = [v for tile in (first, second) for vector in tile for v in vector]
            printed = [mp.nstr(v, 17) for v in inputs]
            if tag not in rules:
                # A gap along each axis of contact.
                for k in range(3):
                    apart = second[2][k] - first[2][k]
                    if abs(apart) == (first[0][k] + second[0][k]) / 2:
                        second[2][k] += GAP * mp.sign(apart)
            result = load(first, second, rules.get(tag, rules["touching"]))
            writer.writerow([tag, *printed, *[mp.nstr(v, 20) for part in result for v in part]])
            file.flush()
            print(tag, file=sys.stderr)


if __name__ == "__main__":
    main()

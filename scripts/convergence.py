#!/usr/bin/env python3
"""Draws how the standard error of renders falls with the number of passes, as an SVG.

    cargo build --release
    python scripts/convergence.py -o docs/images/convergence.svg

It needs numpy. The error is what a render says of itself (`errors` of --stats).
"""

import argparse
import math
import sys
from pathlib import Path

import renders

# Scene, size, and the passes of each integrator.
PANELS = [
    ("cornell-box/cornell-box.toml", "128x128", {"path": 512, "photon-map": 128, "auto": 128}),
    ("cornell-box/cornell-box-area.toml", "128x128", {"path": 512, "photon-map": 128, "auto": 128}),
]
COLOURS = {"path": "#2a6fbb", "photon-map": "#c2571a", "auto": "#1b8a5a"}

WIDTH, HEIGHT, LEFT, TOP, GAP = 320, 260, 60, 30, 30
PASSES, ERRORS = (2, 512), (0.005, 2)


def curve(options, scene, size, integrator, passes):
    options.scene = str(Path("scenes") / scene)
    _, statistics = renders.render(options, 0, size, passes, integrator)
    print(f"{scene} {integrator}: {statistics['relative_error']:.4f} after {passes} passes", file=sys.stderr)
    return [(point["passes"], point["relative_error"]) for point in statistics["errors"]]


def share(value, ends):
    """How far a value lies from one end to the other, on a logarithmic scale."""
    first, last = map(math.log, ends)
    return (math.log(value) - first) / (last - first)


def at(point, x0):
    passes, error = point
    return x0 + WIDTH * share(passes, PASSES), TOP + HEIGHT * (1 - share(error, ERRORS))


def line(points, x0, style):
    places = " ".join("{:.1f},{:.1f}".format(*at(point, x0)) for point in points)
    return f'<polyline points="{places}" fill="none" {style}/>'


def text(x, y, words, style=""):
    return f'<text x="{x:.1f}" y="{y:.1f}" {style}>{words}</text>'


def grid(x0, is_first):
    parts = []
    for power in range(-2, 1):
        parts.append(line([(PASSES[0], 10**power), (PASSES[1], 10**power)], x0, 'stroke="#e2e2e2"'))
        if is_first:
            y = at((PASSES[0], 10**power), x0)[1] + 4
            parts.append(text(x0 - 8, y, f"{100 * 10**power:g} %", 'text-anchor="end" class="tick"'))
    for passes in [2, 8, 32, 128, 512]:
        x, y = at((passes, ERRORS[0]), x0)
        parts.append(text(x, y + 16, str(passes), 'text-anchor="middle" class="tick"'))
    # What independent passes do.
    parts.append(line([(2, 0.05), (128, 0.05 / 8)], x0, 'stroke="#999" stroke-dasharray="3 4"'))
    return parts


def panel(x0, scene, curves, is_first):
    parts = grid(x0, is_first)
    parts.append(text(x0, TOP - 12, Path(scene).name, 'class="title"'))
    for name, points in curves.items():
        parts.append(line(points, x0, f'stroke="{COLOURS[name]}" stroke-width="2"'))
    for row, name in enumerate(curves):
        y = TOP + 10 + 17 * row
        parts.append(f'<path d="M{x0 + 210} {y - 4}h18" stroke="{COLOURS[name]}" stroke-width="2"/>')
        parts.append(text(x0 + 234, y, name))
    parts.append(text(x0 + WIDTH / 2, TOP + HEIGHT + 34, "passes", 'text-anchor="middle" class="tick"'))
    return parts


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", required=True)
    renders.arguments(parser)
    options = parser.parse_args()
    width = LEFT + len(PANELS) * (WIDTH + GAP)
    height = TOP + HEIGHT + 44
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="12">',
        "<style>text{fill:#333}.tick{fill:#666;font-size:11px}.title{font-weight:bold}</style>",
        f'<rect width="{width}" height="{height}" fill="#fff"/>',
    ]
    for number, (scene, size, budgets) in enumerate(PANELS):
        curves = {name: curve(options, scene, size, name, passes) for name, passes in budgets.items()}
        parts += panel(LEFT + number * (WIDTH + GAP), scene, curves, number == 0)
    Path(options.output).write_text("\n".join([*parts, "</svg>"]) + "\n")


if __name__ == "__main__":
    main()

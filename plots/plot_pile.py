#!/usr/bin/python3
"""Draws a pile with the line of its repose angle.

usage: plot_pile.py DIR

Reads DIR/pile.json and DIR/surface.csv (of the demo pile) and writes DIR/pile.png: for a pile in the plane its
particles, for a cone the mean height at each distance from the axis.
Exit codes: 0 done; 2 the folder holds no pile; 3 matplotlib is missing.
"""

import json
import os
import sys

from run_folder import EXIT_INPUT, need_pyplot, stop

plt = need_pyplot()
import numpy as np  # comes with it
from matplotlib.collections import EllipseCollection

GRAIN, EDGE, LINE, SURFACE = "#d9c7a3", "#7a6a4a", "#b0302a", "#3f7f93"


def ellipses(x, z, width, height, degrees, axes, colour, edge):
    axes.add_collection(EllipseCollection(width, height, degrees, units="xy", offsets=np.column_stack([x, z]),
                                          transOffset=axes.transData, facecolors=colour, edgecolors=edge, linewidths=0.3))


def draw_particles(pile, axes):
    particles = pile["particles"]
    smooth = np.array([p["ellipse"] for p in particles if "ellipse" in p])
    if len(smooth):
        a, b = pile["semi_axes_m"]
        n = len(smooth)
        ellipses(1e3 * smooth[:, 0], 1e3 * smooth[:, 1], np.full(n, 2e3 * a), np.full(n, 2e3 * b),
                 np.degrees(smooth[:, 2]), axes, GRAIN, EDGE)
    # Children twice, a rim and its filling .08 mm inside, so that a clump has one outline.
    discs = np.array([d for p in particles for d in p.get("discs", [])])
    if len(discs):
        for rim, colour in ((0, EDGE), (0.08, GRAIN)):
            width = 2e3 * discs[:, 2] - rim
            ellipses(1e3 * discs[:, 0], 1e3 * discs[:, 1], width, width, np.zeros(len(discs)), axes, colour, "none")


def main():
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    folder = sys.argv[1]
    try:
        with open(os.path.join(folder, "pile.json")) as file:
            pile = json.load(file)
        surface = np.genfromtxt(os.path.join(folder, "surface.csv"), delimiter=",", skip_header=2, ndmin=2)
    except OSError as error:
        stop(EXIT_INPUT, str(error))
    width, height = surface[-1, 0], 1.1 * surface[:, 1].max()
    figure, axes = plt.subplots(figsize=(12, min(12, max(1.2, 11 * height / width)) + 1.2))
    if pile["plane"]:
        draw_particles(pile, axes)
    axes.plot(1e3 * surface[:, 0], 1e3 * surface[:, 1], color=SURFACE, linewidth=0.8, label="surface")
    angle, line = pile["repose_angle_deg"], pile["line"]
    if angle is not None:
        x = np.array([line["from_m"], line["to_m"]])
        axes.plot(1e3 * x, 1e3 * (line["top_m"] - np.tan(np.radians(angle)) * x), color=LINE, linewidth=2,
                  label=f"least squares: {angle:.2f}°")
    axes.set_aspect("equal")
    axes.set_xlim(0, 1e3 * width)
    axes.set_ylim(0, 1e3 * height)
    axes.set_xlabel("x / mm" if pile["plane"] else "distance from the axis / mm")
    axes.set_ylabel("height / mm")
    axes.legend(frameon=False, loc="lower right", bbox_to_anchor=(1, 1), ncol=2)
    figure.tight_layout()
    figure.savefig(os.path.join(folder, "pile.png"), dpi=150)


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""Draws a tower's motion over time and the tower itself.

usage: plot_stack.py DIR

Reads DIR/result.json, DIR/samples.csv and DIR/poses.csv, writes DIR/velocity.png (mean speed, kinetic energy, drift and
tilt over time; Seelen et al. 2018, fig. 9, shows the first) and DIR/tower.png (the last poses, seen along y and x).
Needs Debian's python3-matplotlib. Exit codes: 0 drawn; 2 a file is missing or can't be read; 3 matplotlib is missing.
"""

import csv
import json
import os
import sys

from outline import hull
from run_folder import EXIT_INPUT, need_pyplot, stop

plt = need_pyplot()
from matplotlib.collections import PolyCollection  # once it is known to be there


def read_columns(path):
    """The columns of a CSV file by name."""
    try:
        with open(path, newline="") as file:
            rows = list(csv.DictReader(file))
    except OSError as error:
        stop(EXIT_INPUT, f"{path}: {error.strerror}")
    if not rows:
        stop(EXIT_INPUT, f"{path}: holds no rows")
    return {name: [float(row[name]) for row in rows] for name in rows[0]}


def title_of(result):
    state = "stands" if result["standing"] else f"fell at {result['fell_at_s']:.3g} s"
    return (f"{result['count']} cuboids, {result['rule']}, dt {result['dt_s']:.2g} s, "
            f"k_n {result['stiffness_n_per_m']:.2g} N/m: {state}")


def draw_motion(folder, result):
    samples = read_columns(os.path.join(folder, "samples.csv"))
    panels = [("mean_speed_m_per_s", "mean speed, m/s"), ("kinetic_energy_j", "kinetic energy, J"),
              ("drift_over_side", "drift / side"), ("tilt_rad", "tilt, rad")]
    figure, axes = plt.subplots(len(panels), 1, sharex=True, figsize=(8, 9))
    for axis, (name, label) in zip(axes, panels):
        axis.plot(samples["time_s"], samples[name], lw=0.8, color="#30638e")
        if max(samples[name]) > 0:
            axis.set_yscale("log")
        axis.set_ylabel(label)
        axis.grid(alpha=0.3)
    axes[0].set_title(title_of(result), fontsize=10)
    axes[-1].set_xlabel("time, s")
    figure.tight_layout()
    figure.savefig(os.path.join(folder, "velocity.png"), dpi=130)


def rotate(q, v):
    """The vector v turned by the unit quaternion q = (w, x, y, z)."""
    w, x, y, z = q
    t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])]
    return [v[0] + w * t[0] + y * t[2] - z * t[1], v[1] + w * t[1] + z * t[0] - x * t[2],
            v[2] + w * t[2] + x * t[1] - y * t[0]]


def draw_tower(folder, result):
    c = read_columns(os.path.join(folder, "poses.csv"))
    outlines = ([], [])
    for k in range(len(c["x_m"])):
        half = (c["half_x_m"][k], c["half_y_m"][k], c["half_z_m"][k])
        q = (c["qw"][k], c["qx"][k], c["qy"][k], c["qz"][k])
        place = (c["x_m"][k], c["y_m"][k], c["z_m"][k])
        corners = []
        for sx in (-1, 1):
            for sy in (-1, 1):
                for sz in (-1, 1):
                    turned = rotate(q, (sx * half[0], sy * half[1], sz * half[2]))
                    corners.append([1e3 * (a + b) for a, b in zip(turned, place)])
        for out, axis in zip(outlines, (0, 1)):
            out.append(hull([(p[axis], p[2]) for p in corners]))
    figure, axes = plt.subplots(1, 2, sharey=True, figsize=(6, 9))
    for axis, out, name in zip(axes, outlines, ("x, mm", "y, mm")):
        axis.add_collection(PolyCollection(out, facecolor="#e6c16b", edgecolor="#5b4a1f", lw=0.6))
        axis.autoscale_view()
        axis.axhline(0, color="#555", lw=1)
        axis.set_aspect("equal")
        axis.set_xlabel(name)
        axis.locator_params(axis="x", nbins=2)
        low, high = axis.get_xlim()
        if axis.get_ylim()[1] > 6 * (high - low):
            axis.set_xticks([0])  # more would lie on each other
    axes[0].set_ylabel("height, mm")
    figure.suptitle(title_of(result), fontsize=9)
    figure.tight_layout()
    figure.savefig(os.path.join(folder, "tower.png"), dpi=130)


def main():
    if len(sys.argv) != 2 or sys.argv[1] in ("-h", "--help"):
        print(__doc__)
        sys.exit(0 if len(sys.argv) == 2 else EXIT_INPUT)
    folder = sys.argv[1]
    try:
        with open(os.path.join(folder, "result.json")) as file:
            result = json.load(file)
    except (OSError, ValueError) as error:
        stop(EXIT_INPUT, f"{folder}/result.json: {error}")
    draw_motion(folder, result)
    draw_tower(folder, result)


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""Tables and plots of a study of piles (benchmarks/study_piles.py).

usage: plot_piles.py DIR [--markdown FILE] [--png FILE]

Reads DIR/N-*/result.json. Writes DIR/piles.md (mean, sample standard deviation and number of seeds for each number of
spheres and threshold of sleep) and DIR/piles.png: repose angle (of the middle of the slope, of the middle of the base,
of the triangle of a pile's height and area), porosity and coordination over the number of spheres, and the angle over
the shape factors (Markauskas et al. 2010, figs 12, 13, 15). Lines and marks of the paper are numbers its text gives:
ellipse 22.7 +- 1.8 deg, porosity .13 +- 4 %, coordination 3.90 +- 2.5 %; N = 3: 29.1 deg, porosity .25; N = 17: 23.3
deg, porosity .14.
Exit codes: 0 done; 2 nothing to read; 3 matplotlib is missing.
"""

import argparse
import glob
import json
import math
import os
import re
import statistics

from run_folder import EXIT_INPUT, need_pyplot, stop

QUANTITIES = ["repose_angle_deg", "base_angle_deg", "triangle_angle_deg", "porosity", "porosity_smooth", "coordination_particles", "coordination_spheres",
              "potential_contacts_per_particle", "wall_s"]
HEADS = ["repose angle, deg", "by the base, deg", "slope of the triangle, deg", "porosity", "porosity, smooth sections", "coordination, particles", "coordination, contacts",
         "potential contacts", "wall time, s"]
PAPER_ELLIPSE = {"repose_angle_deg": (22.7, 1.8), "porosity": (0.13, 0.0052), "coordination_particles": (3.90, 0.0975)}
PAPER_CLUMPS = {"repose_angle_deg": {3: 29.1, 17: 23.3}, "porosity": {3: 0.25, 17: 0.14}}
# Section area and perimeter of the chain over the ellipse's, a/b = 2.35 (docs/clumps.md).
AREA = {3: 0.8133, 5: 0.9148, 7: 0.9631, 9: 0.9793, 11: 0.9868, 13: 0.9908, 15: 0.9932, 17: 0.9948}
PERIMETER = {3: 1.3477, 5: 1.0361, 7: 1.0114, 9: 1.0056, 11: 1.0033, 13: 1.0022, 15: 1.0016, 17: 1.0012}


def load(folder):
    """{(count, sleep): {spheres: {quantity: [values]}}}"""
    groups = {}
    for path in sorted(glob.glob(os.path.join(folder, "N-*", "result.json"))):
        match = re.fullmatch(r"N-(\d+)_sleep-(.+)_count-(\d+)_seed-(\d+)", os.path.basename(os.path.dirname(path)))
        if not match:
            continue
        with open(path) as file:
            result = json.load(file)
        cell = groups.setdefault((int(match[3]), match[2]), {}).setdefault(int(match[1]), {q: [] for q in QUANTITIES})
        for quantity in QUANTITIES:
            if result.get(quantity) is not None:
                cell[quantity].append(result[quantity])
    if not groups:
        stop(EXIT_INPUT, f"{folder}: holds no results")
    return groups


def summary(values):
    if not values:
        return "-"
    if len(values) == 1:
        return f"{values[0]:.4g}"
    return f"{statistics.mean(values):.4g} ± {statistics.stdev(values):.2g}"


def write_table(groups, path):
    lines = []
    for (count, sleep), cells in sorted(groups.items()):
        lines.append(f"{count} particles, sleep below {sleep} m g d\n")
        lines.append("| N | runs | " + " | ".join(HEADS) + " |\n|" + "---|" * (len(HEADS) + 2))
        for spheres, cell in sorted(cells.items(), key=lambda item: item[0] or math.inf):
            name = str(spheres) if spheres else "ellipsoid"
            lines.append(f"| {name} | {len(cell['wall_s'])} | " + " | ".join(summary(cell[q]) for q in QUANTITIES) + " |")
        lines.append("")
    text = "\n".join(lines)
    with open(path, "w") as file:
        file.write(text)
    print(text)


def error_bars(axis, cells, quantity, key, label, style):
    points = [(key(n), cell[quantity]) for n, cell in sorted(cells.items()) if n and cell[quantity]]
    points = [(x, values) for x, values in points if x is not None]
    if points:
        axis.errorbar([x for x, _ in points], [statistics.mean(v) for _, v in points],
                      [statistics.stdev(v) if len(v) > 1 else 0 for _, v in points], fmt=style, capsize=3, label=label)


def draw_over_spheres(axis, cells, quantities, title):
    for quantity, label, style in quantities:
        error_bars(axis, cells, quantity, lambda n: n, label, style)
        if quantity in PAPER_CLUMPS:
            known = PAPER_CLUMPS[quantity]
            axis.plot(list(known), list(known.values()), "x", color="#777777", label=f"paper, {label}")
    first = quantities[0][0]
    smooth = cells.get(0, {}).get(first, [])
    if smooth:
        mean, spread = statistics.mean(smooth), statistics.stdev(smooth) if len(smooth) > 1 else 0
        axis.axhline(mean, color="#b0302a", linewidth=1, label="ellipsoid")
        axis.axhspan(mean - spread, mean + spread, color="#b0302a", alpha=0.15)
    if first in PAPER_ELLIPSE:
        mean, spread = PAPER_ELLIPSE[first]
        axis.axhspan(mean - spread, mean + spread, color="#777777", alpha=0.2, label="paper, ellipse")
    axis.set_xlabel("spheres")
    axis.set_title(title)
    axis.legend(frameon=False, fontsize=7)


def draw_over_factors(axis, cells):
    smooth = cells.get(0, {}).get("repose_angle_deg", [])
    base = statistics.mean(smooth) if smooth else PAPER_ELLIPSE["repose_angle_deg"][0]
    relative = {n: {"rel": [v / base for v in cell["repose_angle_deg"]]} for n, cell in cells.items()}
    error_bars(axis, relative, "rel", lambda n: 1 - AREA[n] if n in AREA else None, "over the area factor", "o-")
    error_bars(axis, relative, "rel", lambda n: PERIMETER[n] - 1 if n in PERIMETER else None, "over the perimeter factor",
               "s--")
    axis.set_xscale("log")
    axis.set_xlabel("shape factor")
    axis.set_title("repose angle over the ellipsoid's")
    axis.legend(frameon=False, fontsize=7)


def draw(groups, path):
    plt = need_pyplot()
    figure, rows = plt.subplots(len(groups), 4, figsize=(18, 4.2 * len(groups)), squeeze=False)
    for axes, ((count, sleep), cells) in zip(rows, sorted(groups.items())):
        note = f"{count} particles, sleep {sleep}"
        draw_over_spheres(axes[0], cells, [("repose_angle_deg", "middle of the slope", "o-"),
                                           ("base_angle_deg", "middle of the base", "^:"),
                                           ("triangle_angle_deg", "triangle of height and area", "s--")],
                          f"repose angle, deg ({note})")
        draw_over_spheres(axes[1], cells, [("porosity", "sections of the spheres", "o-"),
                                           ("porosity_smooth", "smooth sections", "s--")], "porosity in the plane")
        draw_over_spheres(axes[2], cells, [("coordination_particles", "particles", "o-"),
                                           ("coordination_spheres", "contacts", "s--")], "coordination")
        draw_over_factors(axes[3], cells)
    figure.tight_layout()
    figure.savefig(path, dpi=130)


def main():
    parser = argparse.ArgumentParser(description="Tables and plots of a study of piles.")
    parser.add_argument("folder")
    parser.add_argument("--markdown")
    parser.add_argument("--png")
    options = parser.parse_args()
    groups = load(options.folder)
    write_table(groups, options.markdown or os.path.join(options.folder, "piles.md"))
    draw(groups, options.png or os.path.join(options.folder, "piles.png"))


if __name__ == "__main__":
    main()

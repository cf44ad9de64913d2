#!/usr/bin/python3
"""Plot of chains of spheres against their ellipsoids (Markauskas et al. 2010, fig. 5), from what benchmarks/chains wrote.

usage: plot_chains.py CSV [--png FILE]

Draws section area, section perimeter and volume, each over the ellipsoid's, over the number of spheres, one line per
aspect ratio; grey: one per cent, and the numbers of spheres with which the paper's text reaches it at an aspect ratio of
2.35 (area 13, volume 15). Writes chains.png beside the CSV, or FILE.
Exit codes: 0 done; 2 nothing to read; 3 matplotlib is missing.
"""

import argparse
import csv
import os

from run_folder import EXIT_INPUT, need_pyplot, stop

PANELS = [("area", "area of the section", 13), ("perimeter", "perimeter of the section", None), ("volume", "volume", 15)]


def load(path):
    if not os.path.exists(path):
        stop(EXIT_INPUT, f"{path}: no such file")
    lines = {}
    with open(path) as file:
        for row in csv.DictReader(file):
            lines.setdefault(float(row["aspect"]), []).append({key: float(value) for key, value in row.items()})
    if not lines:
        stop(EXIT_INPUT, f"{path}: holds no chains")
    return lines


def draw(lines, path):
    plt = need_pyplot()
    figure, axes = plt.subplots(1, len(PANELS), figsize=(15, 4.2))
    for axis, (key, title, paper) in zip(axes, PANELS):
        axis.axhspan(0.99, 1.01, color="#bbbbbb", alpha=0.5, linewidth=0, label="1 %")
        for aspect, rows in sorted(lines.items()):
            chains = [row for row in rows if row["spheres"] > 3]
            (line,) = axis.plot([row["spheres"] for row in chains], [row[key] for row in chains], "o-", markersize=3,
                                label=f"a/b = {aspect:g}")
            special = [row for row in rows if row["spheres"] == 3 and row[key] < 1.6]
            axis.plot([3] * len(special), [row[key] for row in special], "x", color=line.get_color())
        if paper:
            axis.plot([paper], [0.99], "v", color="#444444", label=f"paper: 1 % with {paper} at 2.35")
        axis.set_xscale("log")
        axis.set_xticks([3, 5, 9, 17, 33, 55], [3, 5, 9, 17, 33, 55])
        axis.minorticks_off()
        axis.set_xlabel("spheres (crosses: the special chain of 3)")
        axis.set_title(f"{title}, chain over ellipsoid")
        axis.legend(frameon=False, fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=80)


def main():
    parser = argparse.ArgumentParser(description="Plot of chains of spheres against their ellipsoids.")
    parser.add_argument("csv")
    parser.add_argument("--png")
    options = parser.parse_args()
    draw(load(options.csv), options.png or os.path.splitext(options.csv)[0] + ".png")


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""Plot of what clumps and ellipsoids cost beside spheres (Markauskas et al. 2010, figs 17, 18).

usage: plot_efficiency.py DIR [--png FILE]

Reads DIR/efficiency.json (benchmarks/study_efficiency.py). Writes DIR/efficiency.png or FILE: time over that of spheres,
and pairs looked at per step, over the number of spheres of a clump, with the numbers of the paper's text (1.58, 3.3 and
22 for 1, 3 and 17 spheres, 4.1 for ellipses in two dimensions).
Exit codes: 0 done; 2 nothing to read; 3 matplotlib is missing.
"""

import argparse
import os

from run_folder import need_pyplot, read_study

PAPER = {1: 1.58, 3: 3.3, 17: 22}
PAPER_ELLIPSE = 4.1


def main():
    parser = argparse.ArgumentParser(description="Plot of what clumps and ellipsoids cost beside spheres.")
    parser.add_argument("folder")
    parser.add_argument("--png")
    options = parser.parse_args()
    rows = {row["case"]: row for row in read_study(options.folder, "efficiency")}
    clumps = sorted((int(case), row) for case, row in rows.items() if case.isdigit())
    plt = need_pyplot()
    figure, (cost, pairs) = plt.subplots(1, 2, figsize=(11, 4.2))
    base = rows["sphere"]["user_s"]
    cost.plot([n for n, _ in clumps], [row["user_s"] / base for _, row in clumps], "o-", label="clumps")
    cost.axhline(rows["ellipsoid"]["user_s"] / base, color="#b0302a", label="ellipsoid, in space")
    cost.plot(list(PAPER), list(PAPER.values()), "x", color="#777777", label="paper, clumps")
    cost.axhline(PAPER_ELLIPSE, color="#777777", linestyle=":", label="paper, ellipses in the plane")
    cost.set_yscale("log")
    cost.set_yticks([1, 2, 4, 8, 16], [1, 2, 4, 8, 16])
    cost.minorticks_off()
    cost.set_title("processor's time over that of spheres")
    pairs.plot([n for n, _ in clumps], [row["pairs_looked_at_per_step"] for _, row in clumps], "o-", label="clumps")
    pairs.axhline(rows["ellipsoid"]["pairs_looked_at_per_step"], color="#b0302a", label="ellipsoid")
    pairs.axhline(rows["sphere"]["pairs_looked_at_per_step"], color="#3a7a3a", label="spheres")
    pairs.set_title("pairs looked at per step, 1000 particles")
    for axis in (cost, pairs):
        axis.set_xlabel("spheres of a clump")
        axis.legend(frameon=False, fontsize=8)
    figure.tight_layout()
    figure.savefig(options.png or os.path.join(options.folder, "efficiency.png"), dpi=80)


if __name__ == "__main__":
    main()

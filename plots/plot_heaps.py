#!/usr/bin/python3
"""Plot of the heaps that one rock makes as its hull, as clumps and as spheres.

usage: plot_heaps.py DIR [--png FILE]

Reads DIR/rock.json and the surfaces of the heaps, DIR/*_heap_*/surface.csv (benchmarks/study_rock.py). Writes
DIR/heaps.png or FILE: the height over the distance from the axis, mean over the seeds, and the repose angles, each seed
a dot.
Exit codes: 0 done; 2 nothing to read; 3 matplotlib is missing.
"""

import argparse
import glob
import os

from run_folder import EXIT_INPUT, Table, need_pyplot, read_study, stop


def read_surface(path):
    """Heights by distance, mm; distances in hundredths of a millimetre, to be equal where they are."""
    table = Table(path)
    return {round(1e5 * r): 1e3 * z for r, z in zip(table.columns["distance_m"], table.columns["height_m"])}


def main():
    parser = argparse.ArgumentParser(description="Plot of the heaps that one rock makes as hull, clumps and spheres.")
    parser.add_argument("folder")
    parser.add_argument("--png")
    options = parser.parse_args()
    cases = read_study(options.folder, "rock")
    plt = need_pyplot()
    figure, (heaps, angles) = plt.subplots(1, 2, figsize=(11, 3.8), width_ratios=(2, 1))
    for k, case in enumerate(cases):
        name = case["case"].removeprefix("clump of ")
        surfaces = [read_surface(each) for each in glob.glob(os.path.join(options.folder, f"{name}_heap_*/surface.csv"))]
        if not surfaces:
            stop(EXIT_INPUT, f"{options.folder}: no surface of {case['case']}")
        shared = sorted(set.intersection(*(set(surface) for surface in surfaces)))
        means = [sum(surface[at] for surface in surfaces) / len(surfaces) for at in shared]
        last = next((i for i, height in enumerate(means) if height < 0.1 * max(means)), len(means))
        heaps.plot([at / 100 for at in shared[:last]], means[:last], color=f"C{k}", label=case["case"])
        angles.plot([k] * len(case["repose_angle_deg"]), case["repose_angle_deg"], "o", color=f"C{k}")
    heaps.set_aspect("equal")
    heaps.set_xlabel("distance from the axis, mm")
    heaps.set_ylabel("height, mm")
    heaps.legend(frameon=False, fontsize=8)
    angles.set_xticks(range(len(cases)), [case["case"].replace("clump of", "clump\n") for case in cases], fontsize=8)
    angles.set_ylabel("repose angle, degrees")
    figure.tight_layout()
    figure.savefig(options.png or os.path.join(options.folder, "heaps.png"), dpi=80)


if __name__ == "__main__":
    main()

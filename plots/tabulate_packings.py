#!/usr/bin/python3
"""Prints a Markdown table of packings from their result.json, one row per folder.

usage: tabulate_packings.py DIR [DIR ...]

Exit codes: 0 printed; 2 a folder without a readable result.json.
"""

import os
import sys

from run_folder import EXIT_INPUT, RunFolder, stop

HEADER = ["packing", "particles", "height / length", "overall", "near wall", "core", "coordination", "largest overlap",
          "uncertified", "fallbacks", "missed by Bullet", "simulated s", "step s", "wall s"]


def show(value, form):
    return "-" if value is None else format(value, form)


def quantity(result, name):
    return result.get("quantities", {}).get(name, {}).get("value")


def row(folder):
    result = RunFolder(folder).result
    if not result:
        stop(EXIT_INPUT, f"{folder} holds no result.json")
    solid, contacts = result["solid_fraction"], result["contacts"]
    height, length = result["filling_height_m"], quantity(result, "longest_length_m")
    return [os.path.basename(os.path.normpath(folder)), str(result["particles"]),
            show(height / length if height and length else None, ".2f"), show(solid["overall"], ".3f"),
            show(solid["near_wall"], ".3f"), show(solid["core"], ".3f"), show(result["coordination_number"], ".2f"),
            show(100 * result["max_overlap_over_size"], ".2f") + " %", str(contacts["uncertified"]),
            str(contacts["fallbacks"]), str(contacts["missed"]), show(result["simulated_s"], ".3f"),
            show(result["dt_s"], ".2e"), show(result["wall_s"], ".0f")]


def main():
    if len(sys.argv) < 2:
        stop(EXIT_INPUT, "give the folders of the packings")
    rows = [HEADER, ["---"] * len(HEADER)] + [row(folder) for folder in sys.argv[1:]]
    for cells in rows:
        print("| " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()

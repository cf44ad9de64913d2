#!/usr/bin/python3
"""Tables and plots of a study of towers (benchmarks/study_stacks.py).

usage: plot_stacks.py DIR [--markdown FILE] [--png FILE]

Reads every DIR/*.json. Writes one Markdown table per kind of run (stdout or FILE), and a picture of which tower stood, rule
by rule and height by height, of the runs with the most common start, step and stiffness (DIR/stacks.png or FILE).
Exit codes: 0 done; 2 nothing to read; 3 matplotlib is missing.
"""

import argparse
import glob
import json
import math
import os

from run_folder import EXIT_INPUT, need_pyplot, stop

RULES = ["witness", "manifold", "face_centroid", "pressure_centroid", "patch", "foundation", "stiff_patch", "bullet"]
HEAD = ("| rule | N | dt, s | k_n, N/m | perturbation | start | stands | drift/side | tilt, rad | kinetic energy, J | trend, 1/s "
        "| layer force error | ns/contact |\n|" + "---|" * 13)


def load(folder):
    runs = []
    for path in sorted(glob.glob(os.path.join(folder, "*.json"))):
        with open(path) as file:
            runs.append(json.load(file))
    if not runs:
        stop(EXIT_INPUT, f"{folder}: holds no results")
    return runs


def label(run):
    if run["rule"] == "stiff_patch":
        return f"stiff_patch, sharpness {run['sharpness']}"
    if run["rule"] == "face_centroid":
        return f"face_centroid, slab {run['slab']:g}"
    return run["rule"]


def row(run):
    state = f"{run['simulated_s']:.3g} s" if run["standing"] else f"fell at {run['fell_at_s']:.3g} s"
    cells = [label(run), str(run["count"]), f"{run['dt_s']:.3g}", f"{run['stiffness_n_per_m']:.3g}",
             f"{run['perturbation']:g}", run["start"], state, f"{run['max_drift_over_side']:.2g}",
             f"{run['max_tilt_rad']:.2g}", f"{run['kinetic_energy_j']:.2g}", f"{run['kinetic_energy_trend_per_s']:+.2g}",
             f"{run['worst_interlayer_error']:.1g}", f"{run['ns_per_contact']:.0f}"]
    return "| " + " | ".join(cells) + " |"


def draw(runs, path):
    """A cell per rule and height: how far the tower drifted, or when it fell."""
    plt = need_pyplot()
    # One start, step and stiffness for all, those of most runs.
    keys = ("perturbation", "start", "dt_s", "stiffness_n_per_m")
    choices = [tuple(run[key] for key in keys) for run in runs]
    common = max(set(choices), key=choices.count)
    runs = [run for run, choice in zip(runs, choices) if choice == common]
    names = list(dict.fromkeys(label(run) for run in runs))
    heights = sorted({run["count"] for run in runs})
    figure, axis = plt.subplots(figsize=(2.6 + 1.1 * len(heights), 1 + 0.34 * len(names)))
    for run in runs:
        x, y = heights.index(run["count"]), names.index(label(run))
        exponent = max(-6.0, min(0.0, math.log10(max(run["max_drift_over_side"], 1e-18))))
        color = plt.cm.YlGn(0.75 + exponent / 8) if run["standing"] else "#c8553d"
        text = f"{run['max_drift_over_side']:.1g}" if run["standing"] else f"{run['fell_at_s']:.2g} s"
        axis.add_patch(plt.Rectangle((x - 0.48, y - 0.45), 0.96, 0.9, color=color))
        dark = not run["standing"] or exponent > -2
        axis.text(x, y, text, ha="center", va="center", fontsize=8, color="white" if dark else "black")
    axis.set_xlim(-0.5, len(heights) - 0.5)
    axis.set_ylim(len(names) - 0.5, -0.5)
    axis.set_xticks(range(len(heights)), [str(height) for height in heights])
    axis.set_yticks(range(len(names)), names, fontsize=8)
    axis.set_xlabel("cuboids")
    axis.set_title("green: drift over the side; red: when it fell", fontsize=9)
    axis.tick_params(length=0)
    for side in axis.spines.values():
        side.set_visible(False)
    figure.tight_layout()
    figure.savefig(path, dpi=130)


def main():
    parser = argparse.ArgumentParser(description="Tables and plots of a study of towers.")
    parser.add_argument("dir")
    parser.add_argument("--markdown")
    parser.add_argument("--png")
    options = parser.parse_args()
    runs = load(options.dir)
    key = lambda run: (RULES.index(run["rule"]), run["slab"] if run["rule"] == "face_centroid" else 0,
                       run["sharpness"] if run["rule"] == "stiff_patch" else 0, run["count"],
                       run["stiffness_n_per_m"], run["start"], run["perturbation"], run["dt_s"])
    text = "\n".join([HEAD] + [row(run) for run in sorted(runs, key=key)]) + "\n"
    if options.markdown:
        with open(options.markdown, "w") as file:
            file.write(text)
    else:
        print(text, end="")
    draw(sorted(runs, key=key), options.png or os.path.join(options.dir, "stacks.png"))


if __name__ == "__main__":
    main()

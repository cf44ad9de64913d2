#!/usr/bin/python3
"""Tables and plots of a study of towers (benchmarks/study_stacks.py).

usage: plot_stacks.py DIR [--markdown FILE] [--png FILE]

Reads every DIR/*.json. Writes one Markdown table per kind of run (stdout or FILE), and a plot of which tower stood, rule
by rule and height by height (DIR/stacks.png or FILE). Exit codes: 0 done; 2 nothing to read; 3 matplotlib is missing.
"""

import argparse
import glob
import json
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
    plt = need_pyplot()
    figure, axis = plt.subplots(figsize=(8, 5))
    names = sorted({label(run) for run in runs}, key=lambda name: (RULES.index(name.split(",")[0]), name))
    for index, name in enumerate(names):
        of_rule = sorted((run for run in runs if label(run) == name), key=lambda run: run["count"])
        stood = [run for run in of_rule if run["standing"]]
        fell = [run for run in of_rule if not run["standing"]]
        color = plt.cm.tab10(index % 10)
        axis.loglog([run["count"] for run in stood], [max(run["max_drift_over_side"], 1e-18) for run in stood], "o",
                    color=color, label=name)
        axis.loglog([run["count"] for run in fell], [1] * len(fell), "x", ms=9, color=color)
    axis.set_xlabel("cuboids")
    axis.set_ylabel("largest drift over the side; x: fell")
    axis.grid(alpha=0.3)
    axis.legend(fontsize=7)
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
    draw(runs, options.png or os.path.join(options.dir, "stacks.png"))


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""Tables, work-precision plot and pictures of a comparison of contacts (the demo compare_contacts).

usage: plot_contacts.py DIR [DIR ...] [--out FOLDER]

Reads contacts.json and states/ of every DIR (a comparison may have been shared out among several). Writes into FOLDER
(the first DIR):
  contacts.md                 which engine does what theory says, its error, and its run time
  contacts_work.png           error against run time, scene by scene
  contacts_pictures.png       how the scenes end, under four engines
Needs Debian's python3-matplotlib. Exit codes: 0 drawn; 2 nothing to read; 3 matplotlib is missing.
"""

import argparse
import csv
import json
import math
import os

from outline import hull
from run_folder import EXIT_INPUT, need_pyplot, stop

plt = need_pyplot()
from matplotlib.collections import PolyCollection  # once it is known to be there

RULES = ["witness", "manifold", "face_centroid", "pressure_centroid", "patch", "foundation", "stiff_patch"]
COLOURS = dict(zip(RULES, ["#999999", "#8c564b", "#e377c2", "#ff7f0e", "#2ca02c", "#1f77b4", "#d62728"]))

# Bullet's columns of the table, and the pictures: settings that a row must have.
BULLET = [("1/60 s, 10", 1 / 60, 10), ("1/240 s, 10", 1 / 240, 10), ("1/240 s, 50", 1 / 240, 50),
          ("1/1000 s, 10", 1e-3, 10), ("1/1000 s, 50", 1e-3, 50)]
SIZES = [("1 m", {"unit_m": 1, "scaled": False}), ("3 mm", {"unit_m": 0.003, "scaled": False}),
         ("3 mm as one unit", {"unit_m": 0.003, "scaled": True})]


def load(folders):
    """Scenes and rows of all folders, and where each row's state lies."""
    scenes, rows = [], {}
    for folder in folders:
        try:
            with open(os.path.join(folder, "contacts.json"), encoding="utf-8") as file:
                data = json.load(file)
        except (OSError, ValueError) as error:
            stop(EXIT_INPUT, f"{folder}/contacts.json: {error}")
        scenes = data["scenes"]
        for row in data["rows"]:
            row["state"] = os.path.join(folder, row["state"])
            rows[row["key"]] = row
    return scenes, list(rows.values())


def close(a, b):
    return a is not None and b is not None and abs(a - b) <= 1e-6 * abs(b)


def find(rows, scene, **wanted):
    """The first row of the scene that has all the settings wanted; of several the one with the smallest step."""
    found = [row for row in rows if row["scene"] == scene and
             all(close(row[name], value) if isinstance(value, float) else row[name] == value
                 for name, value in wanted.items())]
    return min(found, key=lambda row: row["dt_s"]) if found else None


def verdict(row):
    if row is None:
        return ""
    text = "yes" if row["as_theory"] else "**no**"
    return text if row["error"] is None else f"{text} {row['error']:.1e}"


def run_time(row):
    return "" if row is None else f"{row['run_s_per_simulated_s']:.2g}"


def table(head, scenes, columns, cell):
    """Markdown: a line per scene, a column per setting; columns without a single row are left out."""
    columns = [(name, pick) for name, pick in columns if any(pick(scene["name"]) for scene in scenes)]
    lines = ["| " + head + " | " + " | ".join(name for name, _ in columns) + " |", "|---" * (len(columns) + 1) + "|"]
    for scene in scenes:
        cells = [cell(pick(scene["name"])) for _, pick in columns]
        if any(cells):
            lines.append("| " + scene["name"] + " | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def bullet_columns(rows, size):
    return [(name, lambda scene, dt=dt, n=n: find(rows, scene, engine="bullet", dt_s=dt, iterations=n, **size))
            for name, dt, n in BULLET]


def granular_columns(rows, unit, softness):
    return [(rule, lambda scene, rule=rule: find(rows, scene, rule=rule, unit_m=unit, softness=softness))
            for rule in RULES]


def list_scenes(scenes):
    def cell(text):
        return text.replace("|", "\\|")
    return "| scene | what theory says | known from | error |\n|---|---|---|---|\n" + "".join(
        f"| {s['name']} | {cell(s['theory'])} | {cell(s['source'])} | {s['error']} |\n" for s in scenes)


def write_tables(scenes, rows, path):
    parts = [list_scenes(scenes)]
    for name, size in SIZES:
        columns = bullet_columns(rows, size)
        parts.append(f"Bullet, a = {name}; step, iterations:\n\n" + table("scene", scenes, columns, verdict))
        parts.append(f"Bullet, a = {name}, run time per simulated second, s:\n\n" + table("scene", scenes, columns, run_time))
    for unit in sorted({row["unit_m"] for row in rows if row["engine"] == "granular"}):
        for softness in sorted({row["softness"] for row in rows if row["engine"] == "granular"}, reverse=True):
            columns = granular_columns(rows, unit, softness)
            if not any(pick(s["name"]) for _, pick in columns for s in scenes):
                continue
            what = f"granular, a = {unit:g} m, softness {softness:g}"
            parts.append(f"{what}:\n\n" + table("scene", scenes, columns, verdict))
            parts.append(f"{what}, run time per simulated second, s:\n\n" + table("scene", scenes, columns, run_time))
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(parts))


def draw_work(scenes, rows, path):
    """Error against run time per sqrt(a/g), in which a scene is the same at every size. Bullet: a line over steps and both
    sizes; rules: a line over softness."""
    def cost(row):
        return row["run_s_per_simulated_s"] * math.sqrt(row["unit_m"] / 9.81)
    chosen = [s for s in scenes if any(r["scene"] == s["name"] and r["error"] for r in rows)]
    across = 3
    figure, axes = plt.subplots(-(-len(chosen) // across), across, figsize=(11, 2.9 * -(-len(chosen) // across)),
                                squeeze=False)
    for axis in axes.flat[len(chosen):]:
        axis.set_visible(False)
    for axis, scene in zip(axes.flat, chosen):
        own = [r for r in rows if r["scene"] == scene["name"] and r["error"] and not r["scaled"]
               and (r["engine"] == "bullet" or close(r["unit_m"], 0.003))]
        series = [(f"Bullet, {n} iterations", "#000000" if n == 10 else "#666666", "s",
                   [r for r in own if r["iterations"] == n]) for n in (10, 50)]
        # Of one softness the row with the smallest step.
        finest = {(r["rule"], r["softness"]): r for r in sorted(own, key=lambda r: -r["dt_s"])}
        series += [(rule, COLOURS[rule], "o", [r for (name, _), r in finest.items() if name == rule]) for rule in RULES]
        for name, colour, marker, points in series:
            points = sorted(points, key=cost)
            x, y = [cost(r) for r in points], [max(r["error"], 1e-12) for r in points]
            axis.loglog(x, y, "-", color=colour, lw=0.8, alpha=0.6)
            axis.loglog(x, y, marker, color=colour, ms=5, fillstyle="none", label=name)
            good = [(a, b) for a, b, r in zip(x, y, points) if r["as_theory"]]
            axis.loglog([a for a, _ in good], [b for _, b in good], marker, color=colour, ms=5)
        axis.set_title(scene["name"], fontsize=9)
        axis.tick_params(labelsize=7)
        axis.grid(alpha=0.3)
    for axis in axes[:, 0]:
        axis.set_ylabel("error", fontsize=8)
    figure.suptitle("error against run time per sqrt(a/g), s (filled: as theory says)", fontsize=10)
    handles, labels = axes.flat[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", fontsize=8, ncol=9, columnspacing=1)
    figure.tight_layout(rect=(0, 0.03, 1, 1))
    figure.savefig(path, dpi=85)


def read_state(path):
    """Corners of each body: a list of lists of (x, y, z)."""
    bodies = {}
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            bodies.setdefault(int(row["body"]), []).append((float(row["x"]), float(row["y"]), float(row["z"])))
    return list(bodies.values())


PICTURES = [("Bullet, 1 m, 1/60 s, 10 it.", {"engine": "bullet", "unit_m": 1, "dt_s": 1 / 60, "iterations": 10}),
            ("Bullet, 1 m, 1/1000 s, 50 it.", {"engine": "bullet", "unit_m": 1, "dt_s": 1e-3, "iterations": 50}),
            ("patch", {"rule": "patch"}), ("stiff_patch", {"rule": "stiff_patch"})]
# Scene and what its panel shows, in a.
FRAMES = [("tower", (-11, 11, 0, 21)), ("brick_wall", (-1, 9, 0, 5.5)), ("arch_1.1", (-7, 7, 0, 6.5)),
          ("overhang_0.98", (-4.5, 4.5, -4, 3.5)), ("dominoes", (-1, 20, 0, 3)), ("poured_cubes", (-7.5, 7.5, -3, 9))]


def draw_panel(axis, bodies, oblique):
    """Bodies seen along y, or obliquely with those behind first."""
    def project(p):
        return (p[0] - 0.35 * p[1], p[2] - 0.3 * p[1]) if oblique else (p[0], p[2])
    bodies = sorted(bodies, key=lambda corners: -sum(p[1] for p in corners) / len(corners)
                    + (0.3 * sum(p[2] for p in corners) / len(corners) if oblique else 0))
    axis.add_collection(PolyCollection([hull([project(p) for p in corners]) for corners in bodies],
                                       facecolor="#e6c16b", edgecolor="#5b4a1f", lw=0.4))


def draw_pictures(rows, path):
    width = 11
    heights = [width / len(PICTURES) * min(1, (f[3] - f[2]) / (f[1] - f[0])) + 0.3 for _, f in FRAMES]
    figure, axes = plt.subplots(len(FRAMES), len(PICTURES), figsize=(width, sum(heights)),
                                gridspec_kw={"height_ratios": heights})
    for line, (scene, frame) in zip(axes, FRAMES):
        for axis, (name, wanted) in zip(line, PICTURES):
            found = [r for r in [find(rows, scene, **wanted, **extra) for extra in
                                 ([{}] if "engine" in wanted else [{"softness": 1e-5}, {"softness": 1e-4}])] if r]
            axis.set_xticks([])
            axis.set_yticks([])
            axis.set_aspect("equal")
            axis.set_xlim(frame[0], frame[1])
            axis.set_ylim(frame[2], frame[3])
            if not found or not os.path.exists(found[0]["state"]):
                axis.set_visible(False)
                continue
            draw_panel(axis, read_state(found[0]["state"]), scene == "poured_cubes")
            good = found[0]["as_theory"]
            axis.set_title(f"{scene}: {name}", fontsize=7, color="#1a6b1a" if good else "#b01010")
    figure.tight_layout(pad=0.4)
    figure.savefig(path, dpi=75)


def main():
    parser = argparse.ArgumentParser(description="Tables and plots of a comparison of contacts.")
    parser.add_argument("dirs", nargs="+")
    parser.add_argument("--out")
    options = parser.parse_args()
    out = options.out or options.dirs[0]
    os.makedirs(out, exist_ok=True)
    scenes, rows = load(options.dirs)
    if not rows:
        stop(EXIT_INPUT, "no rows to draw")
    write_tables(scenes, rows, os.path.join(out, "contacts.md"))
    draw_work(scenes, rows, os.path.join(out, "contacts_work.png"))
    draw_pictures(rows, os.path.join(out, "contacts_pictures.png"))


if __name__ == "__main__":
    main()

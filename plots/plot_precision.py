#!/usr/bin/python3
"""Tables and log-log plots of error against run time, from what benchmarks/study_precision.py wrote.

usage: plot_precision.py DIR [--markdown FILE] [--images FOLDER]

Reads DIR/rotations.csv, DIR/impacts.csv and DIR/beds/*/result.json, each if it is there. Writes tables (stdout or FILE)
and precision_rotations.png, precision_impacts.png and precision_beds.png (FOLDER or DIR).
Exit codes: 0 done; 2 nothing to read; 3 matplotlib is missing.
"""

import argparse
import csv
import glob
import json
import math
import os

from run_folder import EXIT_INPUT, need_pyplot, stop

DPI = 80


def read_csv(path):
    if not os.path.exists(path):
        return []
    with open(path) as file:
        return list(csv.DictReader(file))


def read_beds(folder):
    beds = []
    for path in sorted(glob.glob(os.path.join(folder, "beds", "*", "result.json"))):
        timing = os.path.join(os.path.dirname(path), "processor.json")
        if os.path.exists(timing):
            with open(path) as first, open(timing) as second:
                beds.append({**json.load(first), **json.load(second)})
    return beds


def grouped(rows, *keys):
    groups = {}
    for row in rows:
        groups.setdefault(tuple(row[key] for key in keys), []).append(row)
    return groups


def order(pairs):
    """Order of convergence between the two smallest steps: pairs (step, error), None where it means nothing."""
    (coarse, above), (fine, below) = sorted(pairs)[1], sorted(pairs)[0]
    return math.log(above / below) / math.log(coarse / fine) if above > 0 and below > 0 else None


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def nearest(rows, key, wanted):
    return min(rows, key=lambda row: abs(math.log(float(row[key]) / wanted)))


def tabulate_rotations(rows):
    turns = (0.5, 0.06, 0.008)
    head = ["top", "scheme", "torques per step", "ns per step", "order"] + [f"error at \\|w\\| dt = {t:g}" for t in turns]
    lines = []
    for (top, scheme), group in grouped(rows, "top", "scheme").items():
        rate = order([(float(row["dt_s"]), float(row["orientation_error_rad"])) for row in group])
        at = [nearest(group, "turn_per_step_rad", turn) for turn in turns]
        lines.append([top, scheme, group[0]["torques_per_step"], f"{float(group[0]['ns_per_step']):.0f}", f"{rate:.2f}"]
                     + [f"{float(row['orientation_error_rad']):.2g}" for row in at])
    return table(head, lines)


def tabulate_impacts(rows):
    steps = sorted({float(row["steps_per_contact"]) for row in rows})
    head = ["case", "rule", "k_n, N/m"] + [f"t_c/{s:g}" for s in steps]
    lines = []
    for (case, rule, stiffness), group in grouped(rows, "case", "rule", "stiffness_n_per_m").items():
        by_step = {float(row["steps_per_contact"]): row for row in group}
        lines.append([case, rule, f"{float(stiffness):.0e}" if float(stiffness) else "-"]
                     + [f"{float(by_step[s]['error']):.1e}" for s in steps])
    return table(head, lines)


def mean_and_spread(values):
    values = [value for value in values if value is not None]
    if not values:
        return "-"
    mean = sum(values) / len(values)
    if len(values) < 2:
        return f"{mean:.4g}"
    spread = math.sqrt(sum((v - mean) ** 2 for v in values) / (len(values) - 1) / len(values))
    return f"{mean:.4g} ± {spread:.1g}"


def measures(bed):
    return {"solid fraction": bed["solid_fraction"]["overall"], "coordination": bed["coordination_number"],
            "largest overlap": bed["max_overlap_over_size"],
            "ledger residual": abs(bed["energy"]["residual_relative"] or 0) or None,
            "processor, s": None if bed.get("resumed") else bed["processor_s"]}


def tabulate_beds(beds):
    names = list(measures(next(b for b in beds if "energy" in b)))
    keys = ("rule", "scheme", "stiffness_n_per_m", "steps_per_contact")
    lines = []
    for (rule, scheme, stiffness, steps), group in sorted(grouped(beds, *keys).items()):
        point = [rule, scheme, f"{stiffness:.0e}", f"t_c/{steps}"]
        done = [measures(bed) for bed in group if "energy" in bed]
        if not done:
            lines.append(point + ["0", "refused"] + [""] * len(names))
            continue
        rest = sum(bed["outcome"] == "rested" for bed in group)
        lines.append(point + [f"{rest} of {len(done)}"]
                     + [mean_and_spread([one[name] for one in done]) for name in names])
    return table(["rule", "scheme", "k_n, N/m", "step", "at rest"] + names, lines)


def draw_rotations(plt, rows, path):
    tops = list(dict.fromkeys(row["top"] for row in rows))
    figure, axes = plt.subplots(1, len(tops), figsize=(4 * len(tops), 4.2), sharey=True)
    for axis, top in zip(axes, tops):
        for (scheme,), group in grouped([row for row in rows if row["top"] == top], "scheme").items():
            axis.loglog([float(row["run_s_per_s"]) for row in group],
                        [max(float(row["orientation_error_rad"]), 1e-9) for row in group], ".-", ms=4, lw=1, label=scheme)
        axis.set_title(top)
        axis.set_xlabel("processor time per unit of time")
        axis.grid(alpha=0.3)
    axes[0].set_ylabel("error of the orientation, rad")
    axes[0].legend(fontsize=6)
    save(figure, path)


def draw_impacts(plt, rows, path):
    cases = list(dict.fromkeys(row["case"] for row in rows))
    columns = (len(cases) + 1) // 2
    figure, axes = plt.subplots(2, columns, figsize=(3.6 * columns, 6.4))
    for axis, case in zip(axes.flat, cases):
        for (rule, stiffness), group in grouped([row for row in rows if row["case"] == case], "rule",
                                                "stiffness_n_per_m").items():
            if float(stiffness) not in (0, 1e6, 1e9, 1e5):
                continue
            label = f"{rule}, {float(stiffness):.0e}" if rule != "-" else None
            axis.loglog([float(row["processor_s"]) for row in group],
                        [max(float(row["error"]), 1e-9) for row in group], ".-", ms=4, lw=1, label=label)
        axis.set_title(case, fontsize=8)
        axis.grid(alpha=0.3)
        axis.set_xlabel("processor time, s", fontsize=7)
        if any(row["rule"] != "-" for row in rows if row["case"] == case):
            axis.legend(fontsize=4)
    axes.flat[0].set_ylabel("error")
    save(figure, path)


def draw_beds(plt, beds, path):
    beds = [bed for bed in beds if "energy" in bed and not bed.get("resumed")
            and (bed["rule"], bed["scheme"]) == ("patch", "seelen")]
    names = list(measures(beds[0]))[:4]
    figure, axes = plt.subplots(1, len(names), figsize=(4 * len(names), 3.8))
    for axis, name in zip(axes, names):
        # Errors span decades; what should not change at all is shown as it is.
        draw = axis.loglog if name in ("largest overlap", "ledger residual") else axis.semilogx
        for (stiffness,), group in sorted(grouped(beds, "stiffness_n_per_m").items()):
            points = [(bed["processor_s"], measures(bed)[name]) for bed in group]
            points = [p for p in points if p[1] is not None]
            draw(*zip(*points), ".", label=f"k_n = {stiffness:.0e}")
        axis.set_xlabel("processor time, s")
        axis.set_title(name)
        axis.grid(alpha=0.3)
    axes[0].legend(fontsize=7)
    save(figure, path)


def save(figure, path):
    figure.tight_layout()
    figure.savefig(path, dpi=DPI)


def main():
    parser = argparse.ArgumentParser(description="Tables and plots of error against run time.")
    parser.add_argument("dir")
    parser.add_argument("--markdown")
    parser.add_argument("--images")
    options = parser.parse_args()
    parts = [("rotations", read_csv(os.path.join(options.dir, "rotations.csv")), tabulate_rotations, draw_rotations),
             ("impacts", read_csv(os.path.join(options.dir, "impacts.csv")), tabulate_impacts, draw_impacts),
             ("beds", read_beds(options.dir), tabulate_beds, draw_beds)]
    parts = [part for part in parts if part[1]]
    if not parts:
        stop(EXIT_INPUT, f"{options.dir}: holds no results")
    plt = need_pyplot()
    text = ""
    for name, rows, tabulate, draw in parts:
        text += f"### {name}\n\n" + tabulate(rows) + "\n"
        draw(plt, rows, os.path.join(options.images or options.dir, f"precision_{name}.png"))
    if options.markdown:
        with open(options.markdown, "w") as file:
            file.write(text)
    else:
        print(text, end="")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""What each thing that a run leaves out saves: whole steps with everything left out, against the same without that one.

usage: study_skips.py --scenes build/release/benchmarks/scenes [--out DIR] [--rounds N]

Both ways in turn, N rounds (default 5), the fastest counts; microseconds of processor time per particle and step, one thread.
Writes DIR/skips.csv and DIR/skips.md. What sleep saves is measured by study_sleep.py, on whole beds with their results.
"""

import argparse
import csv
import json
import os
import subprocess
import sys

DENSE = {
    "spheres": ["--count", "1000", "--steps", "400", "--relax", "400"],
    "ellipsoids": ["--count", "500", "--steps", "400", "--relax", "400"],
    "cubes": ["--count", "500", "--steps", "300", "--relax", "400"],
    "rocks20": ["--count", "500", "--steps", "100", "--relax", "300"],
    "cylinders": ["--count", "500", "--steps", "100", "--relax", "300"],
    "clumps17": ["--count", "500", "--steps", "300", "--relax", "400"],
}
FALL = {"free_fall": ["--count", "1000", "--steps", "2000", "--relax", "100"]}
FALLS = {**FALL, "free_fall_cubes": ["--count", "1000", "--steps", "2000", "--relax", "100"]}
STIRRED = ["--count", "10000", "--steps", "500", "--relax", "200"]

NAMES = ["broad_phase", "gjk", "epa", "orientation", "flight"]


def without(*names):
    return ["--skip", ",".join(name for name in NAMES if name not in names)]


# What is left out, the scenes on which it counts, the options of `scenes` with it and without. Who falls alone is
# stepped, but for the row of flight.
STEPPED = without("flight")
ROWS = [
    ("broad phase", DENSE, [], without("broad_phase")),
    ("broad phase", FALL, STEPPED, without("broad_phase", "flight")),
    ("looks at pairs proven apart", DENSE, [], without("gjk")),
    ("searches for the feature", {k: DENSE[k] for k in ("ellipsoids", "cubes", "rocks20", "cylinders")}, [], without("epa")),
    ("all three", DENSE, [], without("broad_phase", "gjk", "epa")),
    ("orientation of balls", {"spheres": DENSE["spheres"]}, [], without("orientation")),
    ("orientation of balls", FALL, STEPPED, without("orientation", "flight")),
    ("flight", FALLS, [], STEPPED),
    ("clipping, by the rule witness", {k: DENSE[k] for k in ("cubes", "rocks20", "cylinders")}, ["--rule", "witness"], []),
    ("energy ledger", DENSE, [], ["--energy"]),
    ("work one by one", DENSE, [], ["--no-batches"]),
    ("work one by one", FALLS, STEPPED, [*STEPPED, "--no-batches"]),
]


def measure(program, words):
    done = subprocess.run([program, "--repeats", "1", *words], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{program} {' '.join(words)}: exit code {done.returncode}\n{done.stderr}")
    answer = json.loads(done.stdout)
    return 1e6 / answer["particle_steps_per_s"], answer["particles"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", required=True)
    parser.add_argument("--out", default="out/skips")
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    os.makedirs(options.out, exist_ok=True)

    rows = []
    for name, scenes, less, more in ROWS:
        for scene, size in scenes.items():
            common = ["--scene", scene, *size]
            times = [[measure(options.scenes, common + way)[0] for way in (less, more)] for _ in range(options.rounds)]
            rows.append([name, scene, min(t[0] for t in times), min(t[1] for t in times)])
            print(f"{name}, {scene}: {rows[-1][2]:.4g} us with it left out, {rows[-1][3]:.4g} without", flush=True)
    # A bed that sleeps: the same hundred spheres above it and alone, per step.
    times = []
    for _ in range(options.rounds):
        per_step = []
        for scene in ("stirred", "stirred_alone"):
            time, particles = measure(options.scenes, ["--scene", scene, *STIRRED])
            per_step.append(time * particles)
        times.append(per_step)
    stirred, alone = (min(t[k] for t in times) for k in (0, 1))

    with open(os.path.join(options.out, "skips.csv"), "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["left_out", "scene", "us_per_particle_step", "us_per_particle_step_otherwise"])
        writer.writerows(rows)
        writer.writerow(["a bed asleep", "stirred", stirred / 100, alone / 100])
    text = "| left out | " + " | ".join([*DENSE, *FALLS]) + " |\n|---|" + "---|" * (len(DENSE) + len(FALLS)) + "\n"
    for name in dict.fromkeys(row[0] for row in ROWS):
        cells = []
        for scene in [*DENSE, *FALLS]:
            found = [row for row in rows if row[0] == name and row[1] == scene]
            cells.append(f"{found[0][2]:.3f} / {found[0][3]:.3f}" if found else "")
        text += f"| {name} | " + " | ".join(cells) + " |\n"
    text += (f"\nA hundred spheres above a bed of 10 000 asleep: {stirred:.2f} us per step; alone: {alone:.2f} us "
             f"({stirred / alone:.2f} times).\n")
    with open(os.path.join(options.out, "skips.md"), "w") as file:
        file.write(text)
    print("\n" + text)


if __name__ == "__main__":
    main()

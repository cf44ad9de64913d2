#!/usr/bin/python3
"""Error against run time: rotations, single impacts and whole beds.

usage: study_precision.py --build build/release --out DIR [--part rotations|impacts|beds|all] [--count N] [--seeds S]

DIR/rotations.csv and DIR/impacts.csv come from the benchmarks of the same name; DIR/beds/<name>/result.json from the
demo packing, one run per step (fraction of the contact time), stiffness, rule, rotation scheme and seed. What is there
is not done again, so that a study that was stopped goes on where it was; a bed that was interrupted is resumed from its
checkpoint. The time of a run is the processor's (DIR/beds/<name>/processor.json); of a resumed one it is that of the
last part, and says so. plots/plot_precision.py makes tables and plots.
Exit codes: 0 all done; 1 a run failed.
"""

import argparse
import json
import math
import os
import subprocess
import sys

from timed_run import timed_run

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SCENE = os.path.join(ROOT, "demos", "scenes", "cuboids.toml")
HALF = 1.5e-3  # half a side of a cube, m
DENSITY = 2500  # kg/m^3
RESTITUTION = 0.8
FRACTIONS = (10, 20, 40, 80, 200)  # steps per contact time
STIFFNESSES = (1e3, 1e4, 1e5, 1e6)  # N/m
RULES = ("witness", "manifold", "face_centroid", "pressure_centroid", "patch", "stiff_patch", "foundation")


def contact_time(stiffness):
    """S 14 for two equal cubes, s."""
    reduced = DENSITY * (2 * HALF) ** 3 / 2
    return math.sqrt(reduced * (math.pi ** 2 + math.log(RESTITUTION) ** 2) / stiffness)


def run_benchmark(options, name):
    target = os.path.join(options.out, name + ".csv")
    if os.path.exists(target):
        return True
    partial = target + ".partial"
    done = subprocess.run([os.path.join(options.build, "benchmarks", name), "--csv", partial])
    if done.returncode == 0:
        os.replace(partial, target)
    return done.returncode == 0


def beds(options):
    """The runs: over the step at k_n = 1e4, over the stiffness at 1/40 of the contact time, over rules and rotation
    schemes at k_n = 1e4 and 1/80, which every rule's bound allows."""
    points = [(steps, 1e4, "patch", "seelen") for steps in FRACTIONS]
    points += [(40, k, "patch", "seelen") for k in STIFFNESSES]
    points += [(80, 1e4, rule, "seelen") for rule in RULES] + [(80, 1e4, "patch", "spiral")]
    return [(*point, seed) for seed in range(1, options.seeds + 1) for point in dict.fromkeys(points)]


def run_bed(options, steps, stiffness, rule, scheme, seed):
    name = f"n{options.count}_tc{steps}_k{stiffness:.0e}_{rule}_{scheme}_seed{seed}"
    folder = os.path.join(options.out, "beds", name)
    result, timing = os.path.join(folder, "result.json"), os.path.join(folder, "processor.json")
    if os.path.exists(result) and os.path.exists(timing):
        return True
    packing = os.path.join(options.build, "demos", "packing")
    words = [packing, "--resume", folder]
    resumed = os.path.exists(os.path.join(folder, "checkpoint.h5"))
    if not resumed:
        words = [packing, SCENE, "--out", folder, "--seed", str(seed), "--threads", "1"]
        chosen = {"vessel.radius": "9mm", "insertion.count": options.count, "insertion.rate": 3000,
                  "model.point_rule": rule, "model.integrator": scheme, "contact_default.stiffness": stiffness,
                  "time.step": contact_time(stiffness) / steps,
                  "output.energy": "true", "output.plots": "false", "output.picture": "false",
                  "time.max_time": options.time}
        for key, value in chosen.items():
            words += ["--set", f"{key}={value}"]
    environment = dict(os.environ, OMP_NUM_THREADS="1")
    done = timed_run(words, environment)
    # A bed that isn't at rest in time, and a step above the bound, are answers too.
    if done.code == 1 and "time.step" in done.last_line():
        os.makedirs(folder, exist_ok=True)
        with open(result, "w") as file:
            json.dump({"outcome": "refused: " + done.last_line()}, file)
    elif done.code not in (0, 3, 4):
        print(f"{name}: exit code {done.code}: {done.last_line()}", file=sys.stderr, flush=True)
        return False
    with open(timing, "w") as file:
        json.dump({"steps_per_contact": steps, "stiffness_n_per_m": stiffness, "rule": rule, "scheme": scheme,
                   "seed": seed, "count": options.count, "resumed": resumed, "processor_s": done.user + done.system}, file)
    print(f"{name}: exit code {done.code}", flush=True)
    return True


def main():
    parser = argparse.ArgumentParser(description="Error against run time.")
    parser.add_argument("--build", required=True, help="folder of the build")
    parser.add_argument("--out", required=True, help="folder of the results")
    parser.add_argument("--part", default="all", choices=["rotations", "impacts", "beds", "all"])
    parser.add_argument("--count", type=int, default=200, help="cubes of a bed")
    parser.add_argument("--seeds", type=int, default=3, help="beds per point")
    parser.add_argument("--time", type=float, default=1.0, help="simulated at most, s")
    options = parser.parse_args()
    os.makedirs(options.out, exist_ok=True)
    good = True
    for name in ("rotations", "impacts"):
        if options.part in (name, "all"):
            good = run_benchmark(options, name) and good
    if options.part in ("beds", "all"):
        for point in beds(options):
            good = run_bed(options, *point) and good
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()

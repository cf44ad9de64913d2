#!/usr/bin/python3
"""Runs towers over rules, heights, time steps, stiffnesses and perturbations, one after the other.

usage: study_stacks.py --stack build/release/demos/stack --out DIR [--time T] [--jobs N]
       [--set rules|slab|sharpness|steps|stiffness|perturbations|starts|all]

Each run writes DIR/<name>.json and keeps its checkpoints in DIR/<name>.checkpoints until it is done. A run whose file
is there is not done again, and one that was stopped is resumed, so a study that was stopped goes on where it was. A tower that falls ends its run. plots/plot_stacks.py makes tables and plots of the folder.
Exit codes: 0 all runs done; 1 a run could not be made.
"""

import argparse
import concurrent.futures
import os
import shutil
import subprocess
import sys

RULES = ["witness", "manifold", "face_centroid", "pressure_centroid", "patch", "stiff_patch", "foundation"]


def sets(name):
    """The runs of a set: dictionaries of options of the demo stack."""
    if name == "rules":
        # Every rule at its own safe step and the paper's parameters.
        return [{"rule": rule, "count": count, "perturb": 1e-6, "dt": 2e-6}
                for count in (10, 20, 50, 100) for rule in RULES]
    if name == "slab":
        return [{"rule": "face_centroid", "slab": slab, "count": 10, "perturb": 1e-6, "dt": 2e-6}
                for slab in (1, 0.1, 0.01)]
    if name == "sharpness":
        return [{"rule": "stiff_patch", "sharpness": p, "count": 100, "perturb": 1e-6, "dt": 2e-6}
                for p in (1, 4, 12, 16, 20, 24, 48)]
    if name == "steps":
        return [{"rule": rule, "count": 20, "perturb": 1e-6, "dt": dt}
                for rule in ("patch", "stiff_patch") for dt in (1e-6, 2e-6, 4e-6, 8e-6)]
    if name == "stiffness":
        return [{"rule": rule, "count": 50, "perturb": 1e-6, "kn": kn, "fraction": 0.5}
                for rule in ("patch", "stiff_patch") for kn in (1e4, 1e5)]
    if name == "perturbations":
        return [{"rule": rule, "count": 20, "perturb": p, "dt": 4e-6} for rule in RULES for p in (0, 1e-12, 1e-6, 1e-3)]
    if name == "starts":
        return [{"rule": "stiff_patch", "count": 100, "perturb": p, "dt": 4e-6, "drop": drop}
                for drop in (False, True) for p in (0, 1e-12, 1e-6, 1e-3)]
    raise SystemExit(f"study_stacks.py: no set \"{name}\"")


ALL = ["rules", "slab", "sharpness", "steps", "stiffness", "perturbations", "starts"]


def name_of(run):
    return "_".join(f"{key}-{value}" for key, value in run.items())


def make(run, options):
    target = os.path.join(options.out, name_of(run) + ".json")
    if os.path.exists(target):
        return True
    kept = os.path.join(options.out, name_of(run) + ".checkpoints")
    words = [options.stack, "--time", str(options.time), "--json", target]
    if os.path.exists(os.path.join(kept, "checkpoint.h5")):
        words += ["--resume", kept]
    else:
        words += ["--skip", "--sample", "0.01", "--checkpoints", kept]
        for key, value in run.items():
            if value is True:
                words.append(f"--{key}")
            elif value is not False:
                words += [f"--{key}", str(value)]
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode != 0:
        # A step above the bound is an answer too.
        print(f"{name_of(run)}: {done.stderr.strip()}", file=sys.stderr, flush=True)
        return "is above" in done.stderr
    shutil.rmtree(kept, ignore_errors=True)
    print(f"{name_of(run)}: {done.stdout.splitlines()[0]}", flush=True)
    return True


def main():
    parser = argparse.ArgumentParser(description="Runs towers over rules, heights, steps, stiffnesses and starts.")
    parser.add_argument("--stack", required=True, help="the demo")
    parser.add_argument("--out", required=True, help="folder of the results")
    parser.add_argument("--set", default="all", choices=ALL + ["all"])
    parser.add_argument("--time", type=float, default=10, help="simulated, s")
    parser.add_argument("--jobs", type=int, default=1, help="runs at once")
    options = parser.parse_args()
    os.makedirs(options.out, exist_ok=True)
    runs = {name_of(run): run for name in (ALL if options.set == "all" else [options.set]) for run in sets(name)}
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        good = list(pool.map(lambda run: make(run, options), runs.values()))
    sys.exit(0 if all(good) else 1)


if __name__ == "__main__":
    main()

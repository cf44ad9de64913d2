#!/usr/bin/python3
"""Runs piles of ellipsoids and of clumps of N spheres over seeds, and tabulates and plots them.

usage: study_piles.py --pile build/release/demos/pile --out DIR [--spheres 0,3,5,7,9,13,17] [--seeds 1,2,3]
       [--count 1000] [--sleep 0] [--jobs N] [--report-only] [further options of pile after --]

N = 0 is the smooth ellipsoid. Each run has its folder DIR/N-<N>_sleep-<E>_count-<C>_seed-<S>: a run with a result.json
is not done again, one with a checkpoint goes on from there, so that a study that was stopped goes on where it was.
Every run is one thread; --jobs of them at once (default: all cores). Then DIR/piles.md (mean and spread) and
DIR/piles.png (repose angle, porosity and coordination over N, and the angle over the shape factors: the figures 12, 13
and 15 of Markauskas et al. 2010, with their numbers where the paper gives them) are written from whatever is there.
Exit codes: 0 all runs done; 1 a run could not be made.
"""

import argparse
import concurrent.futures
import json
import os
import subprocess
import sys

PLOTS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "plots", "plot_piles.py")


def folder_of(options, spheres, seed):
    return os.path.join(options.out, f"N-{spheres}_sleep-{options.sleep}_count-{options.count}_seed-{seed}")


def make(options, spheres, seed):
    folder = folder_of(options, spheres, seed)
    if os.path.exists(os.path.join(folder, "result.json")):
        return True
    if os.path.exists(os.path.join(folder, "checkpoint.h5")):
        words = [options.pile, "--resume", folder]
    else:
        words = [options.pile, "--out", folder, "--count", str(options.count), "--seed", str(seed), "--sleep", options.sleep]
        words += ["--shape", "clump", "--spheres", str(spheres)] if spheres else ["--shape", "ellipsoid"]
        words += options.rest
    os.makedirs(folder, exist_ok=True)
    # The progress of each run is in its folder; the line here says what came of it.
    with open(os.path.join(folder, "progress.log"), "a") as log:
        done = subprocess.run(words + ["--threads", "1"], stdout=subprocess.PIPE, stderr=log, text=True)
    name = os.path.basename(folder)
    if done.returncode != 0:
        print(f"{name}: exit code {done.returncode}, see {folder}/progress.log", file=sys.stderr, flush=True)
        return False
    line = next((text for text in done.stdout.splitlines() if text.startswith("pile:")), "")
    print(f"{name}: {line}", flush=True)
    return True


def main():
    parser = argparse.ArgumentParser(description="Runs piles over numbers of spheres and seeds.")
    parser.add_argument("--pile", default="build/release/demos/pile", help="the demo")
    parser.add_argument("--out", required=True, help="folder of the study")
    parser.add_argument("--spheres", default="0,3,5,7,9,13,17", help="numbers of spheres; 0: the smooth ellipsoid")
    parser.add_argument("--seeds", default="1,2,3")
    parser.add_argument("--count", type=int, default=1000, help="particles of a pile")
    parser.add_argument("--sleep", default="0", help="threshold of sleep over m g d; 0: none sleeps, which takes some five times as long")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="runs at once")
    parser.add_argument("--report-only", action="store_true", help="run nothing, tabulate what is there")
    parser.add_argument("rest", nargs="*", help="further options of pile, after --")
    options = parser.parse_args()
    os.makedirs(options.out, exist_ok=True)
    good = [True]
    if not options.report_only:
        # Seed by seed, so that every N has its first result early.
        runs = [(int(n), int(s)) for s in options.seeds.split(",") for n in options.spheres.split(",")]
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            good = list(pool.map(lambda run: make(options, *run), runs))
    subprocess.run([sys.executable, PLOTS, options.out], check=False)
    sys.exit(0 if all(good) else 1)


if __name__ == "__main__":
    main()

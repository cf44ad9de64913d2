#!/usr/bin/python3
"""What sleeping and other choices change in a bed, and what they save: the same pour without them and with them.

usage: study_sleep.py SCENE --out DIR [--packing build/release/demos/packing] [--set KEY=VALUE ...] [--seeds 1,2,3]
       [--cases none,default,wake=0.3,energy=1e-5] [--parallel 1]

A case is none (nobody sleeps), default (bodies at rest do), or one key of [settle] with its value; + adds any other key
of the scene, as in none+time.step=1e-6. Each run leaves DIR/<case>_<seed>; what is there is not
done again. Writes DIR/sleep.json and DIR/sleep.md: solid fraction and coordination of each case as mean and standard
deviation over the seeds, and the mean user time of a run, so that other work on the machine counts little.
Exit codes: 0 done; 1 a run failed.
"""

import argparse
import json
import os
import statistics
import sys
from concurrent.futures import ThreadPoolExecutor

from timed_run import timed_run

OVERRIDES = {"none": ["settle.kind=none"], "default": ["settle.kind=sleep"]}


def run(case, seed, options):
    folder = os.path.join(options.out, f"{case.replace('=', '_')}_{seed}")
    timing = os.path.join(folder, "time.json")
    if not os.path.exists(timing):
        sleep, *others = case.split("+")
        overrides = OVERRIDES.get(sleep, ["settle.kind=sleep", "settle." + sleep]) + others
        command = [options.packing, options.scene, "--out", folder, "--threads", "1", "--seed", str(seed)]
        for each in overrides + options.set + ["output.picture=false", "output.plots=false", "output.stl=false", "output.glb=false"]:
            command += ["--set", each]
        done = timed_run(command)
        if done.code != 0:
            raise RuntimeError(f"{folder}: exit code {done.code}: {done.last_line()}")
        with open(timing, "w") as file:
            json.dump({"user_s": done.user}, file)
    with open(timing) as file:
        seconds = json.load(file)["user_s"]
    with open(os.path.join(folder, "result.json")) as file:
        result = json.load(file)
    print(f"{case}, seed {seed}: {result['solid_fraction']['overall']:.4f}, {seconds:.0f} s", flush=True)
    return {"case": case, "seed": seed, "solid_fraction": result["solid_fraction"]["overall"],
            "coordination": result["coordination_number"], "largest_overlap": result["max_overlap_over_size"],
            "fallen": result["counters"]["bodies_fallen_asleep"], "user_s": seconds}


def spread(values, form):
    deviation = f" ± {statistics.stdev(values):{form}}" if len(values) > 1 else ""
    return f"{statistics.mean(values):{form}}{deviation}"


def main():
    parser = argparse.ArgumentParser(description="What sleeping changes and saves.")
    parser.add_argument("scene")
    parser.add_argument("--out", required=True)
    parser.add_argument("--packing", default="build/release/demos/packing")
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("--seeds", default="1,2,3")
    parser.add_argument("--cases", default="none,default,wake=0.3,energy=1e-5")
    parser.add_argument("--parallel", type=int, default=1)
    options = parser.parse_args()
    os.makedirs(options.out, exist_ok=True)
    cases = options.cases.split(",")
    wanted = [(case, int(seed)) for case in cases for seed in options.seeds.split(",")]
    try:
        with ThreadPoolExecutor(options.parallel) as pool:
            rows = list(pool.map(lambda each: run(*each, options), wanted))
    except RuntimeError as error:
        print(f"study_sleep.py: {error}", file=sys.stderr)
        sys.exit(1)
    with open(os.path.join(options.out, "sleep.json"), "w") as file:
        json.dump(rows, file, indent=1)
    with open(os.path.join(options.out, "sleep.md"), "w") as file:
        file.write("| settle | runs | solid fraction | coordination | largest overlap | user time, s |\n|---|---|---|---|---|---|\n")
        for case in cases:
            of = [row for row in rows if row["case"] == case]
            file.write(f"| {case} | {len(of)} | {spread([r['solid_fraction'] for r in of], '.4f')} | "
                       f"{spread([r['coordination'] for r in of], '.2f')} | {100 * max(r['largest_overlap'] for r in of):.2f} % | "
                       f"{statistics.mean(r['user_s'] for r in of):.0f} |\n")


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""Other codes on the scenes of benchmarks/scenes, in turn with it on this machine, and the ratios.

usage: peers.py PEERS --out DIR [--scenes build/release/benchmarks/scenes] [--cases spheres,cubes,...] [--rounds 3]

PEERS is a folder with one folder per code, each with a run.sh SCENE N STEPS [key=value ...] that ends with a line
"peer=<name> scene=<scene> n=<N> steps=<S> wall_s=<t> particle_steps_per_s=<v> contacts=<c>", and common/ with the packed cubes.
A code that is not installed is named and left out (yade, lmp and liggghts are looked for on PATH, ROCKABLE is an environment
variable). Every round runs ours and each peer once, all pinned to the processor of PIN (default "taskset -c 1"), so that what
else the machine does meets all of them alike.
Writes DIR/peers.csv (every run) and DIR/peers.md (medians over the rounds and ours over theirs).
Exit codes: 0 done; 1 a run failed; 2 no peer is installed.
"""

import argparse
import csv
import json
import os
import shutil
import statistics
import subprocess
import sys

# Case: arguments of ours, and of each peer.
CASES = {
    "spheres": (["--scene", "spheres", "--count", "10000", "--dt", "1e-6"],
                {code: ["spheres", "10000", "1000", "settle=15000"] for code in ("lammps", "liggghts", "yade")}),
    "cubes": (["--poses", "{peers}/common/cubes_packed_1000.txt"],
              {"yade": ["cubes", "1000", "25", "phase=dense"], "rockable": ["cubes", "1000", "2000", "phase=dense"],
               "lammps": ["cubes", "200", "300", "settle=10"]}),
    "ellipsoids": (["--scene", "ellipsoids", "--count", "1000"], {"yade": ["ellipsoid_ls", "100", "200", "settle=4000"]}),
    "clumps5": (["--scene", "clumps5", "--count", "1000"],
                {code: ["clumps", "1000", "1500", "k=5", "settle=30000"] for code in ("lammps", "liggghts", "yade")}),
    "clumps17": (["--scene", "clumps17", "--count", "1000"],
                 {code: ["clumps", "1000", "1500", "k=17", "settle=30000"] for code in ("lammps", "liggghts", "yade")}),
}

PROGRAMS = {"yade": "yade", "lammps": "lmp", "liggghts": "liggghts"}


def is_installed(code):
    if code == "rockable":
        return bool(os.environ.get("ROCKABLE"))
    return shutil.which(PROGRAMS[code]) is not None


def told_by(command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(command)}: exit code {done.returncode}: {done.stdout.strip()[-300:]}")
    return done.stdout


def run_ours(arguments, options):
    path = os.path.join(options.out, "ours.json")
    pin = os.environ.get("PIN", "taskset -c 1").split()
    told_by(pin + [options.scenes] + [each.format(peers=options.peers) for each in arguments] + ["--json", path])
    with open(path) as file:
        figures = json.load(file)
    return figures["particles"], figures["particle_steps_per_s"], figures["contacts"]


def run_peer(code, arguments, options):
    told = told_by([os.path.join(options.peers, code, "run.sh")] + arguments)
    lines = [line for line in told.splitlines() if line.startswith("peer=")]
    if not lines:
        raise RuntimeError(f"{code} {' '.join(arguments)}: no line of figures: {told.strip()[-300:]}")
    figures = dict(part.split("=", 1) for part in lines[-1].split())
    return int(figures["n"]), float(figures["particle_steps_per_s"]), float(figures["contacts"])


def write_table(rows, path):
    with open(path, "w") as file:
        file.write("| case | code | particles | contacts | particle-steps/s | ours over theirs |\n|---|---|---|---|---|---|\n")
        medians = {}
        for row in rows:
            medians.setdefault((row["case"], row["code"]), []).append(row["particle_steps_per_s"])
        for (case, code), speeds in medians.items():
            of = next(row for row in rows if (row["case"], row["code"]) == (case, code))
            speed = statistics.median(speeds)
            ratio = "" if code == "ours" else f"{statistics.median(medians[case, 'ours']) / speed:.2f}"
            file.write(f"| {case} | {code} | {of['particles']} | {of['contacts']:.0f} | {speed:.3g} | {ratio} |\n")


def main():
    parser = argparse.ArgumentParser(description="Other codes on the same scenes, in turn.")
    parser.add_argument("peers")
    parser.add_argument("--out", required=True)
    parser.add_argument("--scenes", default="build/release/benchmarks/scenes")
    parser.add_argument("--cases", default=",".join(CASES))
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    cases = options.cases.split(",")
    unknown = [case for case in cases if case not in CASES]
    if unknown:
        parser.error(f"unknown case {unknown[0]}; known: {', '.join(CASES)}")
    codes = {code for case in cases for code in CASES[case][1]}
    missing = sorted(code for code in codes if not is_installed(code))
    if missing:
        print("not installed: " + ", ".join(missing))
    if len(missing) == len(codes):
        sys.exit(2)
    os.makedirs(options.out, exist_ok=True)
    rows = []
    try:
        for case in cases:
            ours, peers = CASES[case]
            present = {code: arguments for code, arguments in peers.items() if code not in missing}
            for round_number in range(options.rounds if present else 0):
                for code in ["ours"] + list(present):
                    figures = run_ours(ours, options) if code == "ours" else run_peer(code, present[code], options)
                    rows.append(dict(zip(("case", "round", "code", "particles", "particle_steps_per_s", "contacts"),
                                         (case, round_number, code) + figures)))
                    print(f"{case}, round {round_number}: {code}: {figures[1]:.3g} particle-steps/s", flush=True)
    except RuntimeError as error:
        print(f"peers.py: {error}", file=sys.stderr)
        sys.exit(1)
    with open(os.path.join(options.out, "peers.csv"), "w", newline="") as file:
        table = csv.DictWriter(file, rows[0].keys())
        table.writeheader()
        table.writerows(rows)
    write_table(rows, os.path.join(options.out, "peers.md"))


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""The same cubes fall into the same box with this library, at several settings, and with plain Bullet: the bed that comes of it,
beside the processor's time.

usage: study_engines.py --program build/release/benchmarks/settled_beds [--out DIR] [--seeds S] [--jobs N]

One run per row of SETTINGS and seed, each in DIR/<row>_<seed>.json: what is there is not done again. Writes DIR/engines.md (means over
the seeds) and, where matplotlib is there, DIR/engines.png: solid fraction and overlap over time.
Exit codes: 0 done; 1 a run failed.
"""

import argparse
import concurrent.futures
import json
import os
import statistics
import subprocess
import sys

SETTINGS = {  # name: options
    "k_n 1e4, dt 8e-6": ["--dt", "8e-6"],
    "k_n 1e4, dt 4e-6": ["--dt", "4e-6"],
    "k_n 1e4, dt 2e-6": ["--dt", "2e-6"],
    "k_n 1e5, dt 2.5e-6": ["--dt", "2.5e-6", "--stiffness", "1e5"],
    "k_n 1e4, dt 4e-6, stiff_patch": ["--dt", "4e-6", "--rule", "stiff_patch"],
    "k_n 1e4, dt 4e-6, witness": ["--dt", "4e-6", "--rule", "witness"],
}
SETTINGS.update({f"Bullet in {name}, dt {dt}, {n} iterations":
                 ["--engine", "bullet", "--units", units, "--dt", dt, "--iterations", str(n)]
                 for name, units in (("metres", "1"), ("millimetres", "1000"))
                 for dt, n in (("4e-3", 10), ("1e-3", 10), ("2.5e-4", 10), ("2.5e-4", 50), ("6e-5", 10), ("6e-5", 50))})
COLUMNS = {"processor_s": "processor, s", "solid_fraction": "solid fraction", "contacts": "contacts",
           "largest_overlap_over_side": "largest overlap / side", "mean_overlap_over_side": "mean overlap / side",
           "kinetic_over_mgd": "kinetic energy, m g d each"}


def run(options, name, seed):
    path = os.path.join(options.out, f"{name.replace(' ', '_').replace(',', '')}_{seed}.json")
    if not os.path.exists(path):
        done = subprocess.run([options.program, *SETTINGS[name], "--seed", str(seed), "--json", path + ".part"],
                              stdout=subprocess.DEVNULL, env=dict(os.environ, OMP_NUM_THREADS="1"))
        if done.returncode != 0:
            print(f"{name}, seed {seed}: exit code {done.returncode}", file=sys.stderr)
            return None
        os.replace(path + ".part", path)
    with open(path) as file:
        return json.load(file)


def mean_text(values):
    text = f"{statistics.mean(values):.3g}"
    return text + (f" ± {statistics.stdev(values):.1g}" if len(values) > 1 else "")


def plot(results, path):
    try:
        import matplotlib
    except ModuleNotFoundError:
        print("matplotlib is missing: no plot (apt-get install python3-matplotlib)", file=sys.stderr)
        return
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, panels = plt.subplots(1, 2, figsize=(10, 4))
    kinds = [("this library", "o", lambda n: "Bullet" not in n), ("Bullet, metres", "s", lambda n: "in metres" in n),
             ("Bullet, millimetres", "^", lambda n: "millimetres" in n)]
    for panel, key in zip(panels, ("solid_fraction", "mean_overlap_over_side")):
        for label, marker, belongs in kinds:
            names = [n for n in results if belongs(n) and results[n]]
            panel.errorbar([statistics.mean(r["processor_s"] for r in results[n]) for n in names],
                           [statistics.mean(r[key] for r in results[n]) for n in names],
                           [statistics.pstdev(r[key] for r in results[n]) for n in names], fmt=marker, capsize=2, label=label)
        panel.set_xscale("log")
        panel.set_xlabel("processor's time, s")
        panel.set_ylabel(COLUMNS[key])
    panels[1].set_yscale("log")
    panels[0].legend()
    figure.tight_layout()
    figure.savefig(path, dpi=110)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--out", default="out/engines")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    os.makedirs(options.out, exist_ok=True)

    results = {name: [] for name in SETTINGS}
    good = True
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        runs = {(name, seed): pool.submit(run, options, name, seed)
                for seed in range(1, options.seeds + 1) for name in SETTINGS}
        for (name, seed), future in runs.items():
            answer = future.result()
            good = good and answer is not None
            if answer:
                results[name].append(answer)
                print(f"{name}, seed {seed}: {answer['processor_s']:.1f} s, fraction {answer['solid_fraction']:.3f}", flush=True)
    lines = ["| settings | " + " | ".join(COLUMNS.values()) + " |", "|---|" + "---|" * len(COLUMNS)]
    for name, answers in results.items():
        if answers:
            lines.append(f"| {name} | " + " | ".join(mean_text([a[key] for a in answers]) for key in COLUMNS) + " |")
    with open(os.path.join(options.out, "engines.md"), "w") as file:
        file.write("\n".join(lines) + "\n")
    print("\n".join(lines))
    plot(results, os.path.join(options.out, "engines.png"))
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()

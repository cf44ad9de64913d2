#!/usr/bin/python3
"""What clumps of N spheres and the exact ellipsoid cost beside spheres (Markauskas et al. 2010, figs 16 to 18).

usage: study_efficiency.py --packing build/release/demos/packing --out DIR [--spheres 1,3,5,7,9,13,17] [--count 1000]
       [--time 0.5] [--speed 0.01] [--dt 2e-6] [--threads 1]

The case: a box of 30 x 30 mm (for 1000 particles; its base grows with their number) is filled at random and comes to
rest; then one of its side walls moves inwards with --speed m/s until --time s, which is what is timed. The paper gives
neither box nor speed. Particles: the ellipsoid of semi-axes 2.7 and 1.15 mm, chains of N spheres in its place with its
mass and inertia, and, for reference, spheres of its volume; N = 1 is such a sphere as a clump. All in space, with the
paper's materials, law and time step for all. The spheres of reference follow their orientation, as the others do; "ball"
are the same spheres when nobody follows how they lie, which is the default for what is round, N = 1 too.

Each case leaves DIR/<case>/bed and DIR/<case>/pressed; what is there is not done again. Writes DIR/efficiency.json and
DIR/efficiency.md: time of the steps, over that of spheres; per particle and step; potential contacts from contact steps
(plots/plot_efficiency.py draws them).
Time is that of the process on its cores (user), so that other work on the machine counts little.
Exit codes: 0 done; 1 a run failed.
"""

import argparse
import json
import os
import sys

from timed_run import timed_run

A, B, MASS = 2.7e-3, 1.15e-3, 2e-5
VOLUME = 4.0 / 3 * 3.141592653589793 * A * B * B
RADIUS = (A * B * B) ** (1 / 3)


def particles(case, count):
    if case in ("sphere", "ball"):
        shape = f'shape = "sphere"\nradius = {RADIUS}\n'
    elif case == "1":
        shape = f'shape = "clump"\nradii = [{RADIUS}]\ncentres = [[0, 0, 0]]\n'
    elif case == "ellipsoid":
        shape = f'shape = "ellipsoid"\nsemi_axes = [{A}, {B}, {B}]\n'
    else:
        shape = (f'shape = "clump"\nconstruction = "ellipsoid"\nhalf_length = {A}\nhalf_width = {B}\nspheres = {case}\n'
                 'mass = "smooth"\n')
    return "[[particles]]\n" + shape + (f"count = {count}\n" if count else "")


def scene(case, options, bed):
    side = 0.03 * (options.count / 1000) ** (1 / 3)
    skip = 'skip = ["broad_phase", "gjk", "epa", "sleep"]\n' if case == "sphere" else ""
    text = f'name = "efficiency"\n{skip}seed = 1\nthreads = {options.threads}\n[vessel]\nkind = "box"\nsize = [{side}, {side}, 1]\n'
    if bed:
        text += (f'[[wall]]\nkind = "plane"\nname = "piston"\npoint = [{-side / 2}, 0, 0]\nnormal = [1, 0, 0]\n'
                 f"velocity = [{options.speed}, 0, 0]\nstop = {options.time}\n")
    text += ('[model]\nlaw = "hertz"\npoint_rule = "witness"\n[[material]]\nname = "grain"\n'
             f"density = {MASS / VOLUME}\nyoung_modulus = 183e6\npoisson_ratio = 0.2\n"
             "[contact_default]\nfriction = 0.3\n")
    # Pouring is not timed: strong dashpots bring the bed to rest soon. (Softer grains would pour faster, but a bed that
    # stiffens where it lies flies apart.)
    text += f"damping_normal = {100 if bed else 3000}\ndamping_tangential = {100 if bed else 3000}\n"
    text += f"[time]\noverlap = {0.005 if bed else 0.03}\ncontacts = 6\n"
    if bed:
        text += f"step = {options.dt}\nmax_time = {options.time}\n"
    text += particles(case, 0 if bed else options.count)
    text += f'[insertion]\nkind = "bed"\nfile = "{bed}"\nmax_overlap = 0.05\n' if bed else '[insertion]\nkind = "batches"\nbatch = 200\n'
    text += "[rest]\nenergy = 1e-3\ntime = 0.005\nmax_time = 0.5\n"
    text += "[output]\nstl = false\nglb = false\nplots = false\npicture = false\n[limits]\non_trouble = \"continue\"\n"
    return text


def run(packing, folder, text, good):
    """User time of the run, s; None if it was made before. good: exit codes."""
    if os.path.exists(os.path.join(folder, "result.json")):
        return None
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, "scene.toml"), "w") as file:
        file.write(text)
    done = timed_run([packing, os.path.join(folder, "scene.toml"), "--out", folder])
    if done.code not in good:
        raise RuntimeError(f"{folder}: exit code {done.code}: {done.last_line()}")
    return done.user


def measure(case, options):
    folder = os.path.join(options.out, case)
    bed, pressed, memory = (os.path.join(folder, name) for name in ("bed", "pressed", "time.json"))
    run(options.packing, bed, scene(case, options, None), (0,))
    seconds = run(options.packing, pressed, scene(case, options, os.path.abspath(bed)), (0, 3))  # 3: out of time
    if seconds is not None:
        with open(memory, "w") as file:
            json.dump({"user_s": seconds}, file)
    with open(memory) as file:
        seconds = json.load(file)["user_s"]
    with open(os.path.join(pressed, "result.json")) as file:
        result = json.load(file)
    if result["simulated_s"] < options.time * (1 - 1e-9):
        raise RuntimeError(f"{pressed}: {result['outcome']}")
    for note in result["notes"]:
        print(f"{case}: {note}", flush=True)
    return {"case": case, "user_s": seconds, "steps": result["steps"], "particles": result["particles"],
            "us_per_particle_step": 1e6 * seconds / (result["steps"] * result["particles"]),
            "largest_overlap": result["max_overlap_over_size"],
            "contacts_per_particle": result["counters"]["contact_steps"] / (result["steps"] * result["particles"]),
            "pairs_looked_at_per_step": (result["contacts"]["warm"] + result["contacts"]["cold"]) / result["steps"]}


def main():
    parser = argparse.ArgumentParser(description="Cost of clumps and ellipsoids beside spheres.")
    parser.add_argument("--packing", default="build/release/demos/packing")
    parser.add_argument("--out", required=True)
    parser.add_argument("--spheres", default="1,3,5,7,9,13,17")
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--time", type=float, default=0.5)
    parser.add_argument("--speed", type=float, default=0.01)
    parser.add_argument("--dt", type=float, default=2e-6)
    parser.add_argument("--threads", type=int, default=1)
    options = parser.parse_args()
    rows = []
    for case in ["sphere", "ball", "ellipsoid"] + options.spheres.split(","):
        try:
            rows.append(measure(case, options))
        except RuntimeError as error:
            print(f"study_efficiency.py: {error}", file=sys.stderr)
            sys.exit(1)
        print(f"{case}: {rows[-1]['user_s']:.1f} s, {rows[-1]['user_s'] / rows[0]['user_s']:.2f} of spheres", flush=True)
    with open(os.path.join(options.out, "efficiency.json"), "w") as file:
        json.dump(rows, file, indent=1)
    with open(os.path.join(options.out, "efficiency.md"), "w") as file:
        file.write("| particle | user time, s | over spheres | us per particle-step | contacts per particle | "
                   "pairs looked at per step | largest overlap |\n|---|---|---|---|---|---|---|\n")
        for row in rows:
            file.write(f"| {row['case']} | {row['user_s']:.1f} | {row['user_s'] / rows[0]['user_s']:.2f} | "
                       f"{row['us_per_particle_step']:.3f} | {row['contacts_per_particle']:.2f} | "
                       f"{row['pairs_looked_at_per_step']:.0f} | {100 * row['largest_overlap']:.2f} % |\n")


if __name__ == "__main__":
    main()

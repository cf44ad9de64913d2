#!/usr/bin/python3
"""One scanned rock as its hull, as clumps of spheres and as a sphere: the same bed and the same heap with each.

usage: study_rock.py MESH --out DIR [--demos build/release/demos] [--unit m] [--diameter 5e-3] [--vertices 60]
       [--spheres 10,50,200] [--bed 300] [--heap 400] [--friction 0.5] [--seeds 1,2,3] [--jobs 1]

All have the volume and the density of the rock's hull scaled to that equal-volume diameter (a clump has the volume of
the mesh), and the same contact parameters: law linear, k_n 1e4 N/m, e .5, no tension. The bed: --bed particles poured
into a cylinder of radius five diameters, asleep where calm; the heap: --heap particles one by one through a hopper, an
orifice of six diameters, five above a floor with a rim of twelve diameters across and half a one high, more than it
holds, so that the rest rolls away; nobody asleep (sleepers don't feel what shakes a slope). It ends at rest, or 1.5 s
after the last particle: spheres on a floor roll on.

Each run leaves DIR/<case>_<bed or heap>_<seed>; what is there is not done again, what was interrupted goes on. Writes
DIR/rock.json and DIR/rock.md: solid fraction, coordination and repose angle as mean and standard deviation over the
seeds, and the processor's time of a run, over that of spheres.
Exit codes: 0 done; 1 a run failed.
"""

import argparse
import json
import math
import os
import statistics
import sys
from concurrent.futures import ThreadPoolExecutor

from timed_run import timed_run


def particles(case, options):
    """The group's shape in a scene."""
    if case == "sphere":
        return f'shape = "sphere"\nradius = {options.diameter / 2}\n'
    text = f'shape = "mesh"\nunit = "{options.unit}"\nfiles = ["{os.path.abspath(options.mesh)}"]\n'
    if case == "hull":
        text += f'max_vertices = {options.vertices}\n'
    else:
        text += f'use = "clump"\nspheres = {case}\n'
    return text


def size(case, options):
    if case == "sphere":
        return ""
    return f'[particles.size]\nas = "diameter"\nvalue = {options.diameter}\n'


COMMON = """seed = {seed}
[[material]]
name = "rock"
density = "2500 kg/m^3"
[contact_default]
stiffness = "1e4 N/m"
restitution = 0.5
restitution_tangential = 0.5
friction = {friction}
[model]
point_rule = "patch"
tension = false
[output]
stl = false
glb = false
checkpoint_every = 60
picture = false
"""


def bed_scene(case, seed, options):
    return (f'name = "bed of {case}"\n' + COMMON.format(seed=seed, friction=options.friction) +
            '[settle]\nkind = "sleep"\n'
            f'[vessel]\nkind = "cylinder"\nradius = {5 * options.diameter}\n'
            f'[[particles]]\n{particles(case, options)}{size(case, options)}'
            f'[insertion]\nkind = "rain"\ncount = {options.bed}\nrate = 1000\n')


def turned(path, profile, around=48):
    """Writes the closed surface that a closed profile of (radius, z), m, makes about the z axis: OBJ, m."""
    with open(path, "w") as file:
        for radius, z in profile:
            for k in range(around):
                angle = 2 * math.pi * k / around
                file.write(f"v {radius * math.cos(angle)} {radius * math.sin(angle)} {z}\n")
        for ring in range(len(profile)):
            up = (ring + 1) % len(profile) * around - ring * around
            for k in range(around):
                a, b = ring * around + k + 1, ring * around + (k + 1) % around + 1
                file.write(f"f {a} {a + up} {b}\nf {b} {a + up} {b + up}\n")


def hopper_and_rim(folder, options):
    """A funnel at 60 degrees under a shaft, open at both ends, and a rim that holds the heap's lowest grains, for on a
    smooth floor they roll away. All walls are a diameter thick. Returns the height of the shaft's top, m."""
    d = options.diameter
    narrow, wide, outlet = 3 * d, 5 * d, 5 * d
    joint = outlet + math.sqrt(3) * (wide - narrow)
    top = joint + 12 * d
    turned(os.path.join(folder, "hopper.obj"),
           [(narrow, outlet), (wide, joint), (wide, top), (wide + d, top), (wide + d, joint), (narrow + d, outlet)])
    turned(os.path.join(folder, "rim.obj"), [(6 * d, -d), (6 * d, 0.5 * d), (7 * d, 0.5 * d), (7 * d, -d)])
    return top


def heap_scene(case, seed, options, top):
    d = options.diameter
    return (f'name = "heap of {case}"\n' + COMMON.format(seed=seed, friction=options.friction) +
            '[rest]\nmax_time = 1.5\n[vessel]\nkind = "none"\n'
            '[[wall]]\nkind = "plane"\nname = "floor"\nnormal = [0, 0, 1]\n'
            '[[wall]]\nkind = "mesh"\nname = "hopper"\nfile = "hopper.obj"\nunit = "m"\n'
            '[[wall]]\nkind = "mesh"\nname = "rim"\nfile = "rim.obj"\nunit = "m"\n'
            f'[[particles]]\n{particles(case, options)}count = {options.heap}\n{size(case, options)}'
            f'[insertion]\nkind = "drop"\nrate = 200\nfrom = [{-3 * d}, {-3 * d}, {top - 4 * d}]\n'
            f'to = [{3 * d}, {3 * d}, {top}]\nturn = "any"\n')


def run(case, kind, seed, options):
    """The result of a run and the processor's time of its last part, s."""
    folder = os.path.join(options.out, f"{case}_{kind}_{seed}")
    result, timing = os.path.join(folder, "result.json"), os.path.join(folder, "time.json")
    if not (os.path.exists(result) and os.path.exists(timing)):
        program = os.path.join(options.demos, "packing" if kind == "bed" else "pile")
        scene = os.path.join(folder, "scene.toml")
        if os.path.exists(os.path.join(folder, "checkpoint.h5")):
            command = [program, "--resume", folder]
        else:
            os.makedirs(folder, exist_ok=True)
            with open(scene, "w") as file:
                file.write(bed_scene(case, seed, options) if kind == "bed" else
                           heap_scene(case, seed, options, hopper_and_rim(folder, options)))
            command = [program] + ([scene] if kind == "bed" else ["--scene", scene, "--no-picture"]) + ["--out", folder]
        done = timed_run(command + ["--threads", "1"] if "--resume" not in command else command)
        # A bed or heap that isn't at rest in time is an answer too, and says so.
        if done.code not in (0, 3):
            raise RuntimeError(f"{folder}: exit code {done.code}: {done.last_line()}")
        with open(timing, "w") as file:
            json.dump({"processor_s": done.user + done.system, "resumed": "--resume" in command}, file)
    with open(timing) as file:
        seconds = json.load(file)["processor_s"]
    with open(result) as file:
        found = json.load(file)
    print(f"{case}, {kind}, seed {seed}: {found['outcome']}, {seconds:.0f} s", flush=True)
    return found, seconds


def spread(values):
    values = [v for v in values if v is not None]
    if not values:
        return "-"
    deviation = f" ± {statistics.stdev(values):.3g}" if len(values) > 1 else ""
    return f"{statistics.mean(values):.4g}{deviation}"


def main():
    parser = argparse.ArgumentParser(description="One rock as hull, clumps and sphere.")
    parser.add_argument("mesh")
    parser.add_argument("--out", required=True)
    parser.add_argument("--demos", default="build/release/demos")
    parser.add_argument("--unit", default="m", help="of the mesh")
    parser.add_argument("--diameter", type=float, default=5e-3, help="of the sphere of equal volume, m")
    parser.add_argument("--vertices", type=int, default=60, help="of the hull")
    parser.add_argument("--spheres", default="10,50,200", help="of the clumps")
    parser.add_argument("--bed", type=int, default=300, help="particles of a bed")
    parser.add_argument("--heap", type=int, default=500, help="particles of a heap")
    parser.add_argument("--friction", type=float, default=0.5)
    parser.add_argument("--seeds", default="1,2,3")
    parser.add_argument("--jobs", type=int, default=1, help="runs at once")
    options = parser.parse_args()
    cases, seeds = ["sphere", "hull"] + options.spheres.split(","), [int(s) for s in options.seeds.split(",")]
    todo = [(case, kind, seed) for seed in seeds for case in cases for kind in ("bed", "heap")]
    os.makedirs(options.out, exist_ok=True)
    try:
        with ThreadPoolExecutor(options.jobs) as pool:
            found = dict(zip(todo, pool.map(lambda each: run(*each, options), todo)))
    except RuntimeError as error:
        print(f"study_rock.py: {error}", file=sys.stderr)
        sys.exit(1)

    rows = []
    for case in cases:
        beds, heaps = ([found[case, kind, seed] for seed in seeds] for kind in ("bed", "heap"))
        rows.append({"case": case if case in ("sphere", "hull") else f"clump of {case}",
                     "solid_fraction": [r["solid_fraction"]["overall"] for r, _ in beds],
                     "coordination": [r["coordination_number"] for r, _ in beds],
                     "repose_angle_deg": [r["repose_angle_deg"] for r, _ in heaps],
                     "largest_overlap": max(r["max_overlap_over_size"] for r, _ in beds + heaps),
                     "bed_s": [s for _, s in beds], "heap_s": [s for _, s in heaps],
                     "us_per_contact": [1e6 * s / max(1, r["counters"]["contact_steps"]) for r, s in beds]})
    with open(os.path.join(options.out, "rock.json"), "w") as file:
        json.dump(rows, file, indent=1)
    with open(os.path.join(options.out, "rock.md"), "w") as file:
        file.write("| particle | solid fraction | coordination | repose angle, deg | largest overlap | bed, s | over spheres | "
                   "heap, s | us per contact |\n|" + "---|" * 9 + "\n")
        base = statistics.mean(rows[0]["bed_s"])
        for row in rows:
            file.write(f"| {row['case']} | {spread(row['solid_fraction'])} | {spread(row['coordination'])} | "
                       f"{spread(row['repose_angle_deg'])} | {100 * row['largest_overlap']:.2f} % | "
                       f"{statistics.mean(row['bed_s']):.0f} | {statistics.mean(row['bed_s']) / base:.1f} | "
                       f"{statistics.mean(row['heap_s']):.0f} | {statistics.mean(row['us_per_contact']):.2f} |\n")


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""The kernels in lanes against what the machine gives: which of its limits each one meets first.

usage: roofline.py --builds build/release/benchmarks [--out DIR]

Counts the instructions of the kernels that work on a register full of contacts at a time, in the disassembly of
`scenes` (objdump): their code has hardly a branch, so that what is written down is nearly what is done (what is written
for the last, part full register, and for what is rare, is counted too). A loop counts as often as the table below says
that it is run. Arithmetic on whole registers, divisions, square roots and
shuffles; bytes loaded and stored. Runs `machine` for the machine's throughput of each, and `scenes` for the time of a
contact in the whole step, and prints, per contact, the least time that each limit allows. Writes DIR/roofline.md as well.
Exit codes: 0 done; 1 a program failed; 2 a kernel is not in the disassembly (another compiler, another instruction set).
"""

import argparse
import collections
import json
import os
import re
import subprocess
import sys

# Kernels of a scene: functions (by the demangled name), how often a register full of contacts runs through them (of
# looks at features: the share of contacts that have such a feature in the scene), and through a loop within them.
BOTH_WAYS = [(r"granular::BriefBatch::load\(\)", 1), (r"granular::BriefBatch::store\(", 1),
             (r"granular::ContactLanes::Party::put\(", 2)]
LINEAR_LAW = [(r"granular::applyLinearLawInLanes\(", 1), (r"granular::pressAndRub\(granular::LawOptions", 1)]
PLACE = [(r"^granular::findPress\(", 1), (r"^granular::placePress\(", 1)]


def look(kind, function):
    return rf"^granular::{kind}Look<double __vector\(\d\)> granular::{function}<"


SCENES = {
    "spheres": (["--scene", "spheres", "--count", "1000"],
                {"finding": [(r"\(anonymous namespace\)::SphereLooks::place\(", 1)], "in and out": BOTH_WAYS, "law": LINEAR_LAW}),
    "ellipsoids": (["--scene", "ellipsoids", "--count", "500"],
                   {"finding": [(r"EllipsoidLooks::findRegister\(", 1),
                                (r"NewtonAnswer<double __vector\(\d\)> granular::takeTwoSteps", 1)],
                    "in and out": BOTH_WAYS, "law": LINEAR_LAW}),
    # An edge of one across one of the other, or a corner in a face. Overlaps that reach over an edge go by cells, which
    # are not counted.
    "cubes": (["--scene", "cubes", "--count", "500"],
              {"finding": [(look("Edge", "lookAtEdges"), .64), (look("Face", "lookAtFace"), .36)],
               "overlap": [(r"^granular::beginOverlap\(granular::EdgeLook", .64),
                           (r"^granular::beginOverlap\(granular::FaceLook", .36),
                           (r"endAnyOverlap<granular::EdgeLook", .64), (r"endAnyOverlap<granular::FaceLook", .36)],
               "law": LINEAR_LAW}),
    "rocks20": (["--scene", "rocks20", "--count", "500"],
                {"finding": [(look("Crossing", "lookAtCrossing"), .64), (look("Tip", "lookAtTip"), .36, 4.3)],
                 "overlap": [(r"^granular::integrateOverlap\(granular::CrossingLook", .64),
                             (r"^granular::integrateOverlap\(granular::TipLook", .36, 5.6), *PLACE],
                 "law": LINEAR_LAW}),
    # A side across a side, a rim on a side (by two steps of Newton's method), a rim in a cap. Two caps are clipped one by one.
    "cylinders": (["--scene", "cylinders", "--count", "500"],
                  {"finding": [(look("Lane", "lookAtSides"), .32), (look("Lane", "lookAtRimOnSide"), .39, 2),
                               (look("Lane", "lookAtRimInCap"), .25)],
                   "overlap": [(r"^granular::integrateStrip\(", .9), *PLACE], "law": LINEAR_LAW}),
}
ARITHMETIC = re.compile(r"v(add|sub|mul|max|min|cmp\w*|blendm|and|andn|or|xor|rndscale)pd|vcmp\w+pd")
SHUFFLE = re.compile(r"v(shuf|perm|unpck|insert|extract|align|broadcast|movddup)\w*")
WIDTH = {"z": 64, "y": 32, "x": 16}


def read_functions(program):
    """Instructions of each function, by its demangled name: (address, words)."""
    text = subprocess.run(["objdump", "-d", "-C", "--no-show-raw-insn", program], capture_output=True, text=True,
                          check=True).stdout
    functions, lines = {}, None
    for line in text.splitlines():
        head = re.fullmatch(r"[0-9a-f]+ <(.*)>:", line)
        if head:
            lines = functions.setdefault(head[1], [])
        elif lines is not None and "\t" in line:
            lines.append((int(line.split(":")[0], 16), line.split("\t")[-1].strip()))
    return functions


def find_loops(lines):
    """From where to where the jumps backwards reach, by addresses."""
    jumps = [(re.match(r"j\w+ +([0-9a-f]+) <", words), address) for address, words in lines]
    first = lines[0][0] if lines else 0
    return [(int(jump[1], 16), address) for jump, address in jumps if jump and first <= int(jump[1], 16) <= address]


def count(lines, trips):
    counts = collections.Counter()
    loops = find_loops(lines)
    for address, line in lines:
        runs = trips if any(begin <= address <= end for begin, end in loops) else 1
        name, _, operands = line.partition(" ")
        registers = re.findall(r"%([xyz])mm", operands)
        if not registers:
            continue
        whole = "z" in registers or not name.endswith("sd")
        if ARITHMETIC.match(name):
            counts["arithmetic"] += runs * whole
        elif name.startswith("vdivpd"):
            counts["divisions"] += runs
        elif name.startswith("vsqrtpd"):
            counts["roots"] += runs
        elif SHUFFLE.match(name):
            counts["shuffles"] += runs
        if "(" in operands:
            # AT&T order: a store's last operand is the memory.
            stores = operands.rstrip().split("{")[0].endswith(")")
            width = 8 if name.endswith("sd") else WIDTH[max(registers, key="xyz".index)]
            counts["stored"] += runs * width * stores
            counts["loaded"] += runs * width * (not stores)
    return counts


def kernel_counts(functions, parts):
    total = collections.Counter()
    for pattern, times, *trips in parts:
        names = [name for name in functions if re.search(pattern, name) and ".cold" not in name]
        if not names:
            print(f"roofline.py: no function {pattern} in the disassembly", file=sys.stderr)
            sys.exit(2)
        for name in names:
            for key, value in count(functions[name], *(trips or [1])).items():
                total[key] += times * value
    return total


def main():
    parser = argparse.ArgumentParser(description="Kernels against the limits of the machine.")
    parser.add_argument("--builds", default="build/release/benchmarks")
    parser.add_argument("--out")
    options = parser.parse_args()
    scenes = os.path.join(options.builds, "scenes")
    functions = read_functions(scenes)
    try:
        machine = json.loads(subprocess.run([os.path.join(options.builds, "machine")], capture_output=True, text=True,
                                            check=True).stdout)
        times = {name: json.loads(subprocess.run([scenes, *words, "--steps", "500", "--relax", "500", "--repeats", "4"],
                                                 capture_output=True, text=True, check=True).stdout)["us_per_contact"]
                 for name, (words, _) in SCENES.items()}
    except subprocess.CalledProcessError as error:
        print(f"roofline.py: {error}: {error.stderr}", file=sys.stderr)
        sys.exit(1)
    lanes = machine["numbers_per_register"]
    lines = [f"numbers per register: {lanes}; per ns: {machine['add_or_multiply_per_ns']:.1f} registers added or multiplied, "
             f"{machine['divide_per_ns']:.2f} divided, {machine['root_per_ns']:.2f} rooted, {machine['load_per_ns']:.1f} loaded, "
             f"{machine['store_per_ns']:.1f} stored; y = a x + y over 16 kB, 512 kB, 8 MB, 256 MB: "
             + ", ".join(f"{machine[f'stream_{size}_bytes_per_ns']:.0f}" for size in ("16_kB", "512_kB", "8_MB", "256_MB"))
             + " bytes per ns", "",
             "| kernel, per contact | flops | divisions and roots | shuffles | bytes loaded | stored | "
             "ns of arithmetic | of divisions and roots | of loads and stores |", "|" + "---|" * 9]
    for scene, (_, kernels) in SCENES.items():
        whole = collections.Counter()
        for kernel, parts in list(kernels.items()) + [("together", None)]:
            c = whole if parts is None else kernel_counts(functions, parts)
            if parts is not None:
                whole.update(c)
            register = 8 * lanes
            bounds = (c["arithmetic"] / machine["add_or_multiply_per_ns"],
                      c["divisions"] / machine["divide_per_ns"] + c["roots"] / machine["root_per_ns"],
                      c["loaded"] / register / machine["load_per_ns"] + c["stored"] / register / machine["store_per_ns"])
            lines.append(f"| {scene}, {kernel} | {c['arithmetic']:.0f} | "
                         f"{c['divisions'] + c['roots']:.0f} | {c['shuffles'] / lanes:.1f} | {c['loaded'] / lanes:.0f} | "
                         f"{c['stored'] / lanes:.0f} | " + " | ".join(f"{b / lanes:.2f}" for b in bounds) + " |")
        lines.append(f"| {scene}, measured, whole step | | | | | | {1000 * times[scene]:.1f} | | |")
    text = "\n".join(lines) + "\n"
    print(text, end="")
    if options.out:
        os.makedirs(options.out, exist_ok=True)
        with open(os.path.join(options.out, "roofline.md"), "w") as file:
            file.write(text)


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""Renders a frame of a bed (VTK XML PolyData) as a picture.

usage: render_bed.py DIR [--frame last|N] [--out PNG] [--color auto|shape|speed|id|height] [--cut] [--size WxH]

Reads DIR/particles.pvd (or the particles*.vtp in DIR or DIR/frames) and, for the vessel's outline, DIR/result.json.
--cut takes the particles between the axis and the viewer away. Needs Debian's python3-vtk9 and, without a display, xvfb
and xauth: the script then starts itself again under xvfb-run.
Exit codes: 0 drawn; 2 no such folder or frame, or a file that cannot be read or written; 3 a tool is missing.
"""

import argparse
import glob
import math
import os
import re
import shutil
import sys
import xml.etree.ElementTree as ElementTree

from run_folder import EXIT_INPUT, EXIT_TOOL, RunFolder, stop

# Muted colours that keep apart from each other and from the grey of the vessel.
PALETTE = ["#d08a5f", "#7aa3c7", "#e6c16b", "#8ab58f", "#b98aa6", "#a3a6cc", "#dfa99b", "#74b0b0", "#c9b68b", "#9c8a7c"]


def read_options():
    parser = argparse.ArgumentParser(description="Renders a frame of a bed as a picture.")
    parser.add_argument("dir", help="folder of a run")
    parser.add_argument("--frame", default="last", help="number of the frame, from 0, or last (default)")
    parser.add_argument("--out", help="the picture (default: DIR/bed.png)")
    parser.add_argument("--color", choices=("auto", "shape", "speed", "id", "height"), default="auto",
                        help="auto: by shape when there are 2 to 10 of them, otherwise by particle")
    parser.add_argument("--cut", action="store_true", help="take the particles in front of the axis away")
    parser.add_argument("--size", default="1600x1200", help="pixels, as 1600x1200")
    options = parser.parse_args()
    size = re.fullmatch(r"(\d{2,5})x(\d{2,5})", options.size)
    if not size:
        stop(EXIT_INPUT, f'--size "{options.size}": two numbers of pixels are needed, as 1600x1200')
    options.size = int(size[1]), int(size[2])
    if options.frame != "last" and not options.frame.isdigit():
        stop(EXIT_INPUT, f'--frame "{options.frame}": a number from 0, or last')
    return options


def ensure_display():
    """VTK ends the process without a display: start again under one that needs no screen."""
    if os.environ.get("DISPLAY"):
        return
    if not shutil.which("xvfb-run") or not shutil.which("xauth"):
        stop(EXIT_TOOL, "no display, and xvfb-run or xauth is missing. Install them with: apt-get install xvfb xauth")
    os.execvp("xvfb-run", ["xvfb-run", "-a", sys.executable, *sys.argv])


def find_frame(folder, frame):
    """The .vtp file of a frame: from the collection, or by the order of the files' names."""
    files = []
    for base in (folder, os.path.join(folder, "frames")):
        collection = os.path.join(base, "particles.pvd")
        if not files and os.path.exists(collection):
            try:
                root = ElementTree.parse(collection).getroot()
                entries = sorted(root.iter("DataSet"), key=lambda entry: float(entry.get("timestep", 0)))
            except (OSError, ValueError, ElementTree.ParseError) as error:
                stop(EXIT_INPUT, f"{collection}: {error}")
            files = [os.path.join(base, entry.get("file", "")) for entry in entries]
        if not files:
            files = sorted(glob.glob(os.path.join(base, "particles*.vtp")))
    if not files:
        stop(EXIT_INPUT, f"{folder} holds no frames (particles.pvd or particles*.vtp)")
    number = len(files) - 1 if frame == "last" else int(frame)
    if number >= len(files):
        stop(EXIT_INPUT, f"--frame {number}: {folder} holds frames 0 to {len(files) - 1}")
    if not os.path.exists(files[number]):
        stop(EXIT_INPUT, f"{files[number]} is named by the collection but is not there")
    return files[number]


def find_vessel(run):
    """The vessel as the analysis describes it in result.json: kind and measures in m, or None."""
    value = {name: run.number("quantities", "vessel_" + name + "_m", "value")
             for name in ("radius", "axis_x", "axis_y", "floor", "lo_x", "lo_y", "hi_x", "hi_y")}
    if not math.isnan(value["radius"]):
        return "cylinder", value
    if not math.isnan(value["lo_x"]):
        return "box", value
    return None, value


def main():
    options = read_options()
    run = RunFolder(options.dir)
    path = find_frame(options.dir, options.frame)
    ensure_display()
    try:
        from bed_picture import draw_bed
    except ImportError as error:
        stop(EXIT_TOOL, f"VTK for Python is missing ({error}). Install it with: apt-get install python3-vtk9 python3-numpy")
    out = options.out or os.path.join(options.dir, "bed.png")
    folder = os.path.dirname(os.path.abspath(out))
    if not os.path.isdir(folder) or not os.access(folder, os.W_OK):
        stop(EXIT_INPUT, f"{out} cannot be written")
    message = draw_bed(path, find_vessel(run), run.title(), options, out, PALETTE)
    if message:
        stop(EXIT_INPUT, message)
    print(out)


if __name__ == "__main__":
    main()

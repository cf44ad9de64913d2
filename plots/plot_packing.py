#!/usr/bin/python3
"""Draws the profiles of a packing from its CSV tables, one PNG each.

usage: plot_packing.py DIR [--out DIR]

Reads DIR/*.csv and DIR/result.json; writes into DIR unless told otherwise. A table that the run did not write is left out.
Exit codes: 0 drawn; 2 no such folder, no tables, or a file that cannot be read or written; 3 matplotlib is missing.
"""

import argparse
import math
import os

from run_folder import EXIT_INPUT, RunFolder, need_pyplot, stop

plt = need_pyplot()

BLUE, ORANGE, GREEN, GREY = "#0b5fa5", "#d1610a", "#2a8a57", "#8a9099"
LENGTH = "unit lengths"

plt.rcParams.update({
    "figure.dpi": 100, "savefig.dpi": 160, "font.size": 11, "axes.titlesize": 12, "axes.grid": True,
    "grid.color": "#e3e6ea", "grid.linewidth": 0.8, "axes.axisbelow": True, "axes.edgecolor": "#6b7178",
    "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False, "lines.linewidth": 1.8,
})


def start(run, panels=1, size=(9, 5.6)):
    """A figure with the run's name above it."""
    figure, axes = plt.subplots(1, panels, figsize=size, constrained_layout=True, squeeze=False)
    figure.set_constrained_layout_pads(w_pad=0.12, h_pad=0.12)
    figure.suptitle(run.title(), fontsize=13, fontweight="bold", x=0.01, ha="left")
    return figure, list(axes[0])


def label(axis, title, x, y):
    axis.set_title(title, loc="left")
    axis.set_xlabel(x)
    axis.set_ylabel(y)


def draw_legend(axis, **where):
    if axis.get_legend_handles_labels()[1]:
        axis.legend(**where)


def known(values):
    return [value for value in values if not math.isnan(value)]


def plot_radial_porosity(run, table):
    figure, (axis,) = start(run)
    x = table["distance_unit_lengths"]
    whole = table["porosity_all_heights"]
    if table["porosity"] == whole:
        axis.plot(x, whole, color=BLUE, lw=2.2, label="floor to filling height")
    else:
        axis.plot(x, whole, color=GREY, lw=1.2, label="floor to filling height")
        axis.plot(x, table["porosity"], color=BLUE, lw=2.2, label="two lengths off floor and top")
    if "porosity_de_klerk" in table:
        axis.plot(x, table["porosity_de_klerk"], color=ORANGE, ls="--", label="de Klerk (2003), equal spheres")
    core = run.number("solid_fraction", "core")
    if not math.isnan(core):
        axis.axhline(1 - core, color=GREEN, ls=":", label=f"core: {1 - core:.3f}")
    axis.set(xlim=(0, max(x)), ylim=(0, 1))
    label(axis, "Radial porosity", f"distance from the side wall / {LENGTH}", "porosity")
    draw_legend(axis, loc="upper right")
    return figure


def plot_axial_porosity(run, table):
    figure, (axis,) = start(run, size=(6, 7.5))
    height = [1e3 * h for h in table["height_m"]]
    axis.plot(table["porosity"], height, color=BLUE)
    filling = 1e3 * run.number("filling_height_m")
    if not math.isnan(filling):
        axis.axhline(filling, color=ORANGE, ls="--", label=f"filling height: {filling:.1f} mm")
    overall = run.number("solid_fraction", "overall")
    if not math.isnan(overall):
        axis.axvline(1 - overall, color=GREEN, ls=":", label=f"overall porosity: {1 - overall:.3f}")
    axis.set(xlim=(0, 1), ylim=(0, max(height)))
    label(axis, "Axial porosity", "porosity of horizontal discs", "height above the floor / mm")
    draw_legend(axis, loc="center right")
    return figure


def draw_order(axis, table, columns, errors=True):
    x = table["distance_unit_lengths"]
    for (name, text), color in zip(columns, (BLUE, ORANGE, GREY)):
        if errors and name + "_error" in table:
            axis.errorbar(x, table[name], yerr=table[name + "_error"], color=color, marker="o", ms=4, capsize=2, label=text)
        else:
            axis.plot(x, table[name], color=color, marker="o", ms=4, ls="-" if color != GREY else "--", label=text)
    axis.axhline(0, color="#333333", lw=0.8)
    axis.set_xlim(0, None)


def frame_order(axes):
    """One scale for panels side by side, never so narrow that noise looks like order."""
    low = min(axis.get_ylim()[0] for axis in axes)
    high = max(axis.get_ylim()[1] for axis in axes)
    for axis in axes:
        axis.set_ylim(min(low, -0.1), max(high, 0.1))


def plot_order_radial(run, table):
    sums = run.table("order_cumulative")
    figure, axes = start(run, 2 if sums else 1, (12, 5.2) if sums else (9, 5.6))
    columns = [("s2_r", r"$S_{2,r}$ (nematic)"), ("s4_r", r"$S_{4,r}$ (orthogonal)"), ("s2_z", r"$S_{2,z}$ (to the vertical)")]
    draw_order(axes[0], table, columns)
    label(axes[0], "Order to the radius, by annular bin", f"distance from the side wall / {LENGTH}", "order parameter")
    draw_legend(axes[0], loc="best")
    if sums:
        draw_order(axes[1], sums, columns[:2])
        label(axes[1], "The same, cumulative from the wall", f"up to this distance from the side wall / {LENGTH}", "order parameter")
        draw_legend(axes[1], loc="best")
    frame_order(axes)
    return figure


def plot_order_plane(run, table):
    figure, axes = start(run, 2, (12, 5.2))
    for axis, s, text in zip(axes, ("s2", "s4"), (r"$S_{2,\alpha}$ (nematic)", r"$S_{4,\alpha}$ (orthogonal)")):
        for region, name, color in (("near_wall", "near the wall", BLUE), ("core", "core", ORANGE), ("all", "all particles", GREY)):
            values = table[f"{s}_{region}"]
            if known(values):
                count = max(known(table[f"particles_{region}"]), default=0)
                axis.plot(table["alpha_deg"], values, color=color, marker="o", ms=3.5, label=f"{name} ({count:.0f})")
        axis.axhline(0, color="#333333", lw=0.8)
        axis.set(xlim=(0, 90), xticks=range(0, 91, 15))
        label(axis, text + " in the plane of the wall", r"angle $\alpha$: 0° azimuthal, 90° vertical", "order parameter")
        draw_legend(axis, loc="best")
    frame_order(axes)
    return figure


def plot_coordination(run, table):
    figure, (axis,) = start(run)
    z = table["neighbours"]
    axis.bar([k - 0.2 for k in z], table["share"], width=0.38, color=BLUE, label="all particles")
    axis.bar([k + 0.2 for k in z], table["share_off_walls"], width=0.38, color=ORANGE, label="particles that touch no wall")
    mean = run.number("coordination_number")
    if not math.isnan(mean):
        axis.axvline(mean, color="#333333", ls="--", lw=1.2, label=f"mean of all: {mean:.2f}")
    axis.set_xticks([int(k) for k in z])
    axis.grid(axis="x", visible=False)
    axis.set_ylim(0, 1.25 * max(known(table["share"]) + known(table["share_off_walls"]) + [0.01]))
    label(axis, "Coordination number", "touching particles (walls not counted)", "share of particles")
    draw_legend(axis, loc="upper right")
    return figure


def plot_pair_distribution(run, table):
    figure, (axis,) = start(run)
    axis.plot(table["r_unit_lengths"], table["g"], color=BLUE)
    axis.axhline(1, color=GREY, ls="--", lw=1, label="no structure")
    axis.set(xlim=(0, None), ylim=(0, None))
    label(axis, "Pair distribution of the centres", f"distance / {LENGTH}", "g(r)")
    draw_legend(axis, loc="upper right")
    return figure


def plot_forces(run, table):
    figure, (axis,) = start(run)
    # The last bin holds everything above: not a density.
    x = table["force_over_mean"][:-1]
    for name, text, color, marker in (("density_particles", "between particles", BLUE, "o"), ("density_walls", "with walls", ORANGE, "s")):
        points = [(a, b) for a, b in zip(x, table[name][:-1]) if b > 0]
        if points:
            axis.plot(*zip(*points), color=color, marker=marker, ms=5, ls="none", label=text)
    axis.plot(x, [math.exp(-a) for a in x], color=GREY, ls="--", lw=1.2, label=r"$e^{-f/\langle f\rangle}$")
    axis.set_yscale("log")
    axis.set(xlim=(0, None), ylim=(1e-4, 3))
    label(axis, "Normal forces", r"normal force over its mean, $f/\langle f\rangle$", "probability density")
    draw_legend(axis, loc="upper right")
    return figure


PLOTS = {
    "radial_porosity": plot_radial_porosity,
    "axial_porosity": plot_axial_porosity,
    "order_radial": plot_order_radial,
    "order_plane": plot_order_plane,
    "coordination": plot_coordination,
    "pair_distribution": plot_pair_distribution,
    "forces": plot_forces,
}


def main():
    parser = argparse.ArgumentParser(description="Draws the profiles of a packing from its CSV tables, one PNG each.")
    parser.add_argument("dir", help="folder of a run, with *.csv and result.json")
    parser.add_argument("--out", help="where the pictures go (default: the run's folder)")
    options = parser.parse_args()
    run = RunFolder(options.dir)
    out = options.out or options.dir
    drawn = 0
    try:
        os.makedirs(out, exist_ok=True)
        for name, plot in PLOTS.items():
            table = run.table(name)
            if table is None:
                continue
            figure = plot(run, table)
            path = os.path.join(out, name + ".png")
            figure.savefig(path)
            plt.close(figure)
            print(path)
            drawn += 1
    except OSError as error:
        stop(EXIT_INPUT, f"{out}: {error.strerror or error}")
    if drawn == 0:
        stop(EXIT_INPUT, f"{options.dir} holds none of the tables {', '.join(PLOTS)} (.csv)")


if __name__ == "__main__":
    main()

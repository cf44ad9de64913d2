#!/usr/bin/python3
"""Prints CSV tables of the demo `collisions` as markdown: one row per pair, one column per value of another key.

usage: tabulate_collisions.py CSV --columns KEY[,KEY...] [--figure KEY] [--where KEY=VALUE ...]

--columns: keys whose values become columns, such as law or ensemble,law
--figure: what is shown, e.g. residual_spring_energy_percent (default), total_energy_error_worst_percent
Exit codes: 0 printed; 2 a file or key that is not there.
"""

import argparse
import csv
import sys


def show(value):
    """A column's name: numbers in six digits."""
    try:
        return f"{float(value):.6g}"
    except ValueError:
        return value


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("csv")
    parser.add_argument("--columns", required=True)
    parser.add_argument("--figure", default="residual_spring_energy_percent")
    parser.add_argument("--where", action="append", default=[])
    options = parser.parse_args()
    keys = options.columns.split(",")
    try:
        with open(options.csv, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        for condition in options.where:
            key, value = condition.split("=", 1)
            rows = [row for row in rows if row[key] == value]
        cells = {(row["pair"], tuple(show(row[key]) for key in keys)): float(row[options.figure]) for row in rows}
    except (OSError, KeyError, ValueError) as error:
        print(f"tabulate_collisions: {options.csv}: {error}", file=sys.stderr)
        return 2
    pairs = list(dict.fromkeys(pair for pair, _ in cells))
    columns = list(dict.fromkeys(column for _, column in cells))
    print("| pair | " + " | ".join(", ".join(column) for column in columns) + " |")
    print("|---" * (len(columns) + 1) + "|")
    for pair in pairs:
        print(f"| {pair} | " + " | ".join(f"{cells[pair, column]:.2g}" for column in columns) + " |")
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""Reads the folder that a run writes: result.json, the CSV tables and the VTK frames.

CSV: an optional first line "# definition", a line of column names, then numbers; an empty cell is undefined (NaN).
Trouble ends the program with one message and a documented exit code, never with a stack trace.
"""

import csv
import json
import math
import os
import sys

EXIT_INPUT = 2  # what was asked for is not there or cannot be read
EXIT_TOOL = 3  # a tool is missing


def stop(code, message):
    """Ends the program with a message."""
    print(f"{os.path.basename(sys.argv[0])}: {message}", file=sys.stderr)
    sys.exit(code)


def need_pyplot():
    """matplotlib.pyplot, which draws into files alone. Ends the program where it is missing."""
    try:
        import matplotlib

        matplotlib.use("Agg")
        import matplotlib.pyplot as plt
    except ImportError as error:
        stop(EXIT_TOOL, f"matplotlib is missing ({error}). Install it with: apt-get install python3-matplotlib")
    return plt


def read_study(folder, name):
    """What a study wrote into its folder as name.json. Ends the program where there is no such file."""
    path = os.path.join(folder, f"{name}.json")
    if not os.path.exists(path):
        stop(EXIT_INPUT, f"{path}: no such file")
    with open(path, encoding="utf-8") as file:
        return json.load(file)


class Table:
    """A CSV table: columns by name."""

    def __init__(self, path):
        self.path = path
        self.definition = ""
        with open(path, newline="", encoding="utf-8") as file:
            lines = file.read().splitlines()
        while lines and lines[0].startswith("#"):
            self.definition += lines.pop(0)[1:].strip()
        rows = list(csv.reader(lines))
        self.names = [name.strip() for name in rows[0]] if rows else []
        self.columns = {name: [] for name in self.names}
        for number, row in enumerate(rows[1:], 2):
            if len(row) != len(self.names):
                stop(EXIT_INPUT, f"{path}: row {number} has {len(row)} cells, not {len(self.names)}")
            for name, cell in zip(self.names, row):
                self.columns[name].append(self.number(cell, number, name))

    def number(self, cell, row, name):
        try:
            return float(cell) if cell.strip() else math.nan
        except ValueError:
            stop(EXIT_INPUT, f'{self.path}: row {row}, column {name}: "{cell}" is not a number')

    def __contains__(self, name):
        return name in self.columns

    def __getitem__(self, name):
        if name not in self.columns:
            stop(EXIT_INPUT, f'{self.path}: no column "{name}"; it has {", ".join(self.names)}')
        return self.columns[name]

    def __len__(self):
        return len(self.columns[self.names[0]]) if self.names else 0


class RunFolder:
    """The files of one run."""

    def __init__(self, path):
        if not os.path.isdir(path):
            stop(EXIT_INPUT, f"{path} is not a folder")
        self.path = path
        self.result = self.read_result()

    def read_result(self):
        path = os.path.join(self.path, "result.json")
        if not os.path.exists(path):
            return {}
        try:
            with open(path, encoding="utf-8") as file:
                result = json.load(file)
        except (OSError, ValueError) as error:
            stop(EXIT_INPUT, f"{path}: {error}")
        if not isinstance(result, dict):
            stop(EXIT_INPUT, f"{path}: not a JSON object")
        return result

    def table(self, name):
        """The table of that name, or None when the run did not write it or it is empty."""
        path = os.path.join(self.path, name + ".csv")
        if not os.path.exists(path):
            return None
        try:
            table = Table(path)
        except (OSError, UnicodeDecodeError, csv.Error) as error:
            stop(EXIT_INPUT, f"{path}: {error}")
        return table if len(table) else None

    def number(self, *keys):
        """A number of result.json by its path of keys; NaN when it is null or not there."""
        value = self.result
        for key in keys:
            value = value.get(key) if isinstance(value, dict) else None
        return float(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else math.nan

    def title(self):
        """What the run is called, and how big it is."""
        name = self.result.get("name") or self.result.get("scene") or os.path.basename(os.path.abspath(self.path))
        name = os.path.splitext(os.path.basename(str(name)))[0]
        count = self.number("particles")
        return name if math.isnan(count) else f"{name}, {count:.0f} particles"

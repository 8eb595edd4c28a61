#!/usr/bin/env python3
"""Lays the path of cncsim beside that of LinuxCNC's interpreter, move by move.

  tests/bench/compare_with_rs274.py CNCSIM [FOLDER]

FOLDER: programs; default ../shared/corpus/gcode beside the checkout. Needs rs274 of the Debian
package linuxcnc-uspace. Both start at 0 without offsets, with the same tools. Both outputs are
reduced to absolute moves in mm and compared to 0.0001 of the program's unit, for rs274 prints four
decimals. docs/canonical.md explains what differs.
"""
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile

INCH = 25.4
TIME_LIMIT = 60  # s
# mm; those of the corpus's compensated programs (INDEX.md), then 3 mm
DIAMETERS = {1: 1.5875, 2: 3.175, 3: 6.35, 4: 25.4}
TOOLS = range(1, 100)
PLANES = {"XY": (0, 1, 2), "XZ": (2, 0, 1), "YZ": (1, 2, 0)}
CALL = re.compile(r"([A-Z_0-9]+)\((.*)\)\s*$")


class Move:
    """kind, end of six axes in mm and degrees; of an arc also centre, plane and turns."""

    def __init__(self, kind, end, tolerance, plane=None, centre=None, turns=0):
        self.kind, self.end, self.tolerance = kind, end, tolerance
        self.plane, self.centre, self.turns = plane, centre, turns

    def __str__(self):
        text = self.kind + " " + " ".join("%.4f" % value for value in self.end)
        if self.centre:
            text += " around %.4f %.4f, %d turns in %s" % (*self.centre, self.turns, self.plane)
        return text

    def differs_from(self, other):
        if (self.kind, self.plane, self.turns) != (other.kind, other.plane, other.turns):
            return True
        pairs = list(zip(self.end, other.end))
        if self.centre:
            pairs += zip(self.centre, other.centre)
        tolerance = max(self.tolerance, other.tolerance)
        return any(abs(one - another) > tolerance for one, another in pairs)


def calls(text):
    for line in text.splitlines():
        match = CALL.search(line)
        if match:
            # rs274 leaves out some of the commas.
            yield match.group(1), match.group(2).replace(",", " ").split()


def numbers(arguments):
    return [float(argument) for argument in arguments]


def arc_end(plane, values):
    """End and centre of ARC_FEED; values: two ends, two centres, turns, third end, A, B, C."""
    first, second, third = PLANES[plane]
    end = [0.0] * 3 + values[6:9]
    end[first], end[second], end[third] = values[0], values[1], values[5]
    return end, (values[2], values[3])


def our_moves(text):
    kinds = {"STRAIGHT_TRAVERSE": "rapid", "STRAIGHT_FEED": "feed", "STRAIGHT_PROBE": "probe",
             "SPINDLE_SYNC_FEED": "thread"}
    plane = "XY"
    for name, arguments in calls(text):
        if name == "SELECT_PLANE":
            plane = arguments[0][-2:]
        elif name in kinds:
            yield Move(kinds[name], numbers(arguments[:6]), 0.0)
        elif name == "ARC_FEED":
            values = numbers(arguments)
            end, centre = arc_end(plane, values)
            yield Move("arc", end, 0.0, plane, centre, round(values[4]))


class LinuxCnc:
    """What its canonical calls say so far: units, offsets and rotation are calls of their own."""

    def __init__(self):
        self.unit, self.plane, self.angle = 1.0, "XY", 0.0
        self.work, self.g92, self.length = [0.0] * 6, [0.0] * 6, [0.0] * 6

    def scaled(self, values):
        return [value * self.unit for value in values[:3]] + list(values[3:6])

    def machine(self, values):
        """tool length, G92, rotation, work offset: in the order of LinuxCNC's canon."""
        x, y, *rest = [sum(parts) for parts in zip(self.scaled(values), self.g92, self.length)]
        cosine, sine = math.cos(self.angle), math.sin(self.angle)
        turned = [x * cosine - y * sine, x * sine + y * cosine, *rest]
        return [sum(parts) for parts in zip(turned, self.work)]

    def moves(self, text):
        kinds = {"STRAIGHT_TRAVERSE": "rapid", "STRAIGHT_FEED": "feed", "STRAIGHT_PROBE": "probe",
                 "SPINDLE_SYNC_FEED": "thread", "RIGID_TAP": "thread"}
        for name, arguments in calls(text):
            if name == "USE_LENGTH_UNITS":
                self.unit = INCH if "INCH" in arguments[0] else 1.0
            elif name == "SELECT_PLANE":
                self.plane = arguments[0][-2:]
            elif name == "SET_G5X_OFFSET":
                self.work = self.scaled(numbers(arguments[1:7]))
            elif name == "SET_G92_OFFSET":
                self.g92 = self.scaled(numbers(arguments[:6]))
            elif name == "SET_XY_ROTATION":
                self.angle = math.radians(float(arguments[0]))
            elif name == "USE_TOOL_LENGTH_OFFSET":
                self.length = self.scaled(numbers(arguments[:6]))
            elif name in kinds:
                values = numbers(arguments[:6])
                values += [0.0] * (6 - len(values))
                yield Move(kinds[name], self.machine(values), 1e-4 * self.unit)
            elif name == "ARC_FEED":
                yield self.arc(numbers(arguments))

    def arc(self, values):
        end, centre = arc_end(self.plane, values)
        first, second, _ = PLANES[self.plane]
        point = list(end)
        point[first], point[second] = centre
        moved = self.machine(point)
        return Move("arc", self.machine(end), 1e-4 * self.unit, self.plane,
                    (moved[first], moved[second]), round(values[4]))


def without_standstill(moves):
    """Straight moves to where the machine is already: one interpreter says them, the other not."""
    kept, position = [], [0.0] * 6
    for move in moves:
        here = max(abs(one - another) for one, another in zip(move.end, position))
        if move.kind == "arc" or here > 1e-4 * INCH:
            kept.append(move)
            position = move.end
    return kept


def align(one, another):
    """How many moves differ, and the first two that do. An entry move or a corner that the other side
    makes with more moves does not make everything behind it different."""
    look_ahead = [(a, b) for total in range(1, 7) for a in range(total + 1) for b in [total - a]]
    different, first = 0, None
    i = j = 0
    while i < len(one) or j < len(another):
        if i < len(one) and j < len(another) and not one[i].differs_from(another[j]):
            i, j = i + 1, j + 1
            continue
        if first is None:
            first = [str(moves[k]) if k < len(moves) else "nothing"
                     for moves, k in ((one, i), (another, j))]
        ours, theirs = next(((a, b) for a, b in look_ahead
                             if i + a < len(one) and j + b < len(another)
                             and not one[i + a].differs_from(another[j + b])),
                            (len(one) - i, len(another) - j))
        different += max(ours, theirs)
        i, j = i + ours, j + theirs
    return different, first


def run_rs274(program, folder):
    """Canonical text, and why the program was refused."""
    for name in ("out", "parameters.var"):
        open(os.path.join(folder, name), "w").close()
    command = ["rs274", "-g", "-n", "2", "-t", os.path.join(folder, "tool.tbl"),
               "-v", os.path.join(folder, "parameters.var"), program, os.path.join(folder, "out")]
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace",
                              timeout=TIME_LIMIT, env={**os.environ, "HOME": folder})
    except subprocess.TimeoutExpired:
        return "", "runs longer than %d s" % TIME_LIMIT
    with open(os.path.join(folder, "out"), errors="replace") as out:
        text = out.read()
    # Accepted: the moves before it are printed.
    if done.returncode == 0 or "no percent sign or program end" in done.stderr:
        return text, None
    lines = [line for line in done.stderr.splitlines() if line.strip() and line != "executing"]
    return text, " / ".join(lines[-2:])


def run_cncsim(cncsim, program, folder):
    canon = os.path.join(folder, "canon")
    command = [cncsim, "check", program, "--canon", canon, "--max-errors", "1",
               "--parameters", os.path.join(folder, "parameters.txt"),
               "--tools", os.path.join(folder, "tools.txt")]
    done = subprocess.run(command, capture_output=True, text=True, errors="replace",
                          timeout=TIME_LIMIT)
    with open(canon, errors="replace") as file:
        text = file.read()
    if done.returncode == 0:
        return text, None
    return text, (done.stdout + done.stderr).splitlines()[0]


def write_tools(folder):
    with open(os.path.join(folder, "tool.tbl"), "w") as theirs, \
            open(os.path.join(folder, "tools.txt"), "w") as ours:
        for tool in TOOLS:
            diameter = DIAMETERS.get(tool, 3.0)
            theirs.write("T%d P%d Z0 D%.10f\n" % (tool, tool, diameter / INCH))
            ours.write("%d 0 0 %.6f 9\n" % (tool, diameter))
    open(os.path.join(folder, "parameters.txt"), "w").close()


def outcome(cncsim, program, folder):
    theirs, their_refusal = run_rs274(program, folder)
    ours, our_refusal = run_cncsim(cncsim, program, folder)
    if their_refusal and our_refusal:
        return "both refuse", "rs274: %s; cncsim: %s" % (their_refusal, our_refusal)
    if their_refusal:
        return "rs274 refuses", their_refusal
    if our_refusal:
        return "cncsim refuses", our_refusal
    one = without_standstill(our_moves(ours))
    another = without_standstill(LinuxCnc().moves(theirs))
    different, first = align(one, another)
    if different:
        return "DIFFERS", "%d of %d moves; first %s; rs274: %s" % (different, len(one), *first)
    return "same", "%d moves" % len(one)


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    house = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    corpus = sys.argv[2] if len(sys.argv) == 3 else os.path.join(house, "../shared/corpus/gcode")
    if not shutil.which("rs274"):
        print("rs274 is not installed (Debian package linuxcnc-uspace): nothing to compare with.")
        return
    if not os.path.isdir(corpus):
        print("There is no %s: nothing to compare." % corpus)
        return
    counts = {}
    with tempfile.TemporaryDirectory() as folder:
        write_tools(folder)
        for name in sorted(os.listdir(corpus), key=str.lower):
            if name.endswith(".expected.txt"):
                continue
            kind, text = outcome(sys.argv[1], os.path.join(corpus, name), folder)
            counts[kind] = counts.get(kind, 0) + 1
            print("%-45s %-15s %s" % (name, kind, text), flush=True)
    print(", ".join("%s: %d" % row for row in sorted(counts.items())))


if __name__ == "__main__":
    main()

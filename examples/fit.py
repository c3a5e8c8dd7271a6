#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Finds five numbers of a cloth from the tracks of twelve of its points: 2 s at 30 frames a second, each coordinate wrong by
1 mm. The tracks are made here, so that the answer is known.

    python fit.py                    # from a factor of 3 off
    python fit.py --repeats 100      # from 18 % off, with other noise each time: how often is it within 3 standard errors?"""
import argparse
import csv
import os
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

import weft

TRUE = {"cloth.springs.stretch.stiffness": 80.0, "cloth.springs.shear.stiffness": 30.0, "cloth.springs.bend.stiffness": 1.0,
        "cloth.springs.stretch.damping": 0.05, "forces.damping": 1e-3}
SHEET = {
    "weft": 1, "name": "tracked",
    "cloth": {"grid": {"rows": 15, "cols": 20, "spacing": 0.05}, "density": 0.2, "velocity": [0, 0, 0.6],
              "springs": {"stretch": {"stiffness": 80.0, "damping": 0.05}, "shear": {"stiffness": 30.0},
                          "bend": {"stiffness": 1.0}},
              "pins": ["top-left", "top-right"]},
    "forces": {"damping": 1e-3},
    "stepper": {"plugin": "gsl", "method": "rkf45", "rtol": 1e-5, "atol": 1e-5},
    "run": {"duration": 2.0, "fps": 30},
}
POINTS = [(row, col) for row in (4, 9, 14) for col in (0, 6, 13, 19)]


def tracks(folder: Path):
    """Time, row, col and position of each point in each frame but the first."""
    run = weft.run(SHEET, folder / "true", {"stepper.rtol": 1e-8, "stepper.atol": 1e-8})
    return [(time, row, col, run.positions[k, row, col]) for k, time in enumerate(run.times) if k for row, col in POINTS]


def fit(folder: Path, seen, seed: int, factor: float):
    """Of noise and of a start that a seed chooses, the start `factor` off: in standard errors, how far from the truth."""
    chance = np.random.default_rng(seed)
    folder = folder / str(seed)
    folder.mkdir()
    with open(folder / "tracks.csv", "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["time", "row", "col", "x", "y", "z"])
        table.writerows([time, row, col, *(x + chance.normal(0.0, 1e-3, 3))] for time, row, col, x in seen)
    start = {key: value * factor ** chance.choice([-1, 1]) for key, value in TRUE.items()}
    found = weft.fit(SHEET, folder / "tracks.csv", list(TRUE), folder / "fit", start, sigma=1e-3, force=True)
    return found, start, [(found.values[key] - TRUE[key]) / found.errors[key] for key in TRUE]


def repeat(folder: Path, seen, repeats: int, factor: float):
    """Of as many fits: in standard errors, how far each number is from the truth."""
    with ThreadPoolExecutor(os.cpu_count()) as threads:  # each waits for a process
        return np.array(list(threads.map(lambda seed: fit(folder, seen, seed, factor)[2], range(1, 1 + repeats))))


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--repeats", type=int, default=0)
    options.add_argument("--factor", type=float, default=1.18, help="of the start in repeats")
    given = options.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        seen = tracks(folder)
        if given.repeats == 0:
            found, start, _ = fit(folder, seen, 1, 3.0)
            for key in TRUE:
                print("%-34s %10.5g +- %-8.2g from %-8.3g (true: %g)" % (key, found.values[key], found.errors[key],
                                                                          start[key], TRUE[key]))
            print("chi2 %.0f of %d coordinates, %d runs" % (found.chi2, found.coordinates, found.runs))
            return
        all_of = repeat(folder, seen, given.repeats, given.factor)
        print("within 1, 2, 3 standard errors: %s; all numbers within 3: %d of %d; root mean square %s" % (
            [round(float((abs(all_of) < k).mean()), 3) for k in (1, 2, 3)], (abs(all_of) < 3).all(axis=1).sum(), len(all_of),
            np.sqrt((all_of ** 2).mean(axis=0)).round(2)))


if __name__ == "__main__":
    main()

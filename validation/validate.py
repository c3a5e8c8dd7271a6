#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares weft with exact and published results: theory/validation.md with a picture per case, and every number in
results.md, in the folder PAGES.

validate.py                       every case; writes both and names the cases whose numbers docs/ and results.md have not
validate.py --quick               the quick half
validate.py --check [--quick]     fails where these have other numbers; writes nothing
validate.py NAME...               these cases alone; writes their parts

BUILD names the folder of the program, as in make; PAGES is BUILD/pages, unless it is docs. The numbers of a run are the
same on every machine; times are not, and no comparison has them.
"""
import math
import os
import re
import sys
import time
from pathlib import Path

sys.dont_write_bytecode = True  # beside the sources

import dynamic  # noqa: E402
import drape  # noqa: E402
import sheets  # noqa: E402
import static  # noqa: E402

DOCS, PAGE, RESULTS = Path("docs"), "theory/validation.md", Path("validation/results.md")
SHOWN = 3  # most rows that agree on the page; results.md has all, and the further tables
PAGES = Path(os.environ.get("PAGES") or Path(os.environ.get("BUILD", "build")) / "pages")
CASES = {case.__name__.replace("_", "-"): case
         for module in (static, dynamic, sheets, drape) for case in module.CASES}
HEAD = """# Validation

This page compares weft with exact and published results, for you who must defend a result. `make validate` computes every case
with the program and names the cases that differ from this page; `make validate CASE=NAME` computes one, and `RENEW=1` renews the
page. `make check-validation` computes the quick half and `make nightly` all; both fail if a number differs. The programs are in
the folder validation, in Python without other packages; [results.md](../../validation/results.md) there has every number, the
tables of refinement included. Times are those of one run on two cores that other programs used too.

The tolerance of a case is the uncertainty of its source, or of the method by which an exact value is approached (the finest
mesh, the step). A case that disagrees stays in the table with the reason.

Expected values come from validation/exact.py (elastica, plates, buckling) or from formulas that stand with the case. The sources
of the bands and coefficients of drapes, of the plate with nu = 0.3 and the abstract on twisted ribbons were read when this page
was written, and Provot's paper is followed in [the model](model.md). The others are cited from memory, for who came first: no
value is taken from them.

What this page does not show: stick and slip, and the wrinkles of a twisted ribbon. The drapes are clamped at the rim of the
support, without contact; [a disc that lies on one](../guides/test-a-fabric.md#a-disc-that-lies-on-its-support) is in the guide.
Other simulators on the same work are on the page [peers](peers.md). And no drape of a fabric is compared here with the measured
drape of that same fabric. That needs a table with bending, shear and drape of each fabric; none could be read in full when this
page was written (ARS 72-17 of the USDA, 1963, would be the first to take): **this comparison is owed**. Until then the Cusick
cases compare with published *bands* and with one other program.

"""
RESULTS_HEAD = """# All numbers of the validation

`make validate` writes this file; docs/theory/validation.md explains the cases.

"""


def verdict(row):
    what, expected, got, tolerance = row[:4]
    if isinstance(expected, tuple):
        return expected[0] - tolerance <= got <= expected[1] + tolerance
    return abs(got - expected) <= tolerance


def show(value):
    if isinstance(value, tuple):
        return " to ".join(show(v) for v in value)
    return value if isinstance(value, str) else "%.6g" % value


def measured(expected, got):
    """Roundoff, where 0 is expected, differs between builds of Python's libm: its order of magnitude is enough."""
    return "below 1e%d" % math.ceil(math.log10(abs(got) + 1e-300)) if expected == 0 else show(got)


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(show(v) for v in row) + " |" for row in rows]) + "\n"


def shown(rows):
    """The rows that the page has: all that disagree, and at most SHOWN of those that agree, evenly spread."""
    agreeing = [k for k, row in enumerate(rows) if row[-1] == "yes"]
    step = -(-len(agreeing) // SHOWN) if agreeing else 1
    kept = set(agreeing[step - 1::step])
    return [row for k, row in enumerate(rows) if row[-1] != "yes" or k in kept]


def page_part(name, case, rows):
    """The section of the page of a case."""
    few = shown(rows)
    part = ["## " + name, "", case["title"] + "\n", "- Source: " + case["source"], "- Formula: " + case["formula"],
            "- Tolerance: " + case["tolerance"], "", table(("quantity", "expected", "weft", "tolerance", "agrees"), few)]
    if len(few) < len(rows):
        part.append("%d more rows agree ([all](../../validation/results.md#%s)).\n" % (len(rows) - len(few), name))
    part += [table(head, more) for head, more in case.get("tables", ()) if case.get("whole")]
    part.append("![%s](../pictures/validation/%s.svg)\n" % (case["caption"], name))
    if case.get("text"):
        part.append(case["text"].strip() + "\n")
    return "\n".join(part)


def results_part(name, case, rows):
    """The section of results.md."""
    part = ["## " + name, "", table(("quantity", "expected", "weft", "tolerance", "agrees"), rows)]
    return "\n".join(part + [table(head, more) for head, more in case.get("tables", ())])


def compute(name):
    """The line of the table of a case, its section of the page and of results.md, its picture."""
    began = time.monotonic()
    case = CASES[name]()
    seconds = time.monotonic() - began
    agree = sum(verdict(row) for row in case["rows"])
    result = "agrees" if agree == len(case["rows"]) else "%d of %d agree" % (agree, len(case["rows"]))
    worst = max(case["rows"], key=lambda row: not verdict(row))
    line = "| [%s](#%s) | %s | %s | %s | %s | %.0f |" % (
        name, name, worst[0], show(worst[1]), measured(*worst[1:3]), result, seconds)
    rows = [(*row[:2], measured(*row[1:3]), row[3], "yes" if verdict(row) else "**no**") for row in case["rows"]]
    return line, page_part(name, case, rows), results_part(name, case, rows), case["figure"]


def results_of(folder):
    return RESULTS if folder == DOCS else folder / RESULTS.name


def sections(text):
    found = {m[1]: m[0] for m in re.finditer(r"^## ([\w-]+)\n.*?(?=^## |\Z)", text, re.M | re.S)}
    return {name: part.rstrip("\n") + "\n" for name, part in found.items()}


def read(folder):
    """Lines of the table and sections of the page of a folder, and sections of its results.md."""
    text = (folder / PAGE).read_text()
    lines = {m[1]: m[0] for m in re.finditer(r"^\| \[([\w-]+)\]\(#.*$", text, re.M)}
    return lines, sections(text), sections(results_of(folder).read_text())


def write(lines, parts, results):
    names = [name for name in CASES if name in lines]
    text = HEAD + "| case | its first quantity, or the first that disagrees | expected | weft | result | time [s] |\n"
    text += "|---|---|---|---|---|---|\n" + "\n".join(lines[name] for name in names)
    (PAGES / PAGE).parent.mkdir(parents=True, exist_ok=True)
    (PAGES / PAGE).write_text(text + "\n\n" + "\n".join(parts[name] for name in names))
    results_of(PAGES).write_text(RESULTS_HEAD + "\n".join(results[name] for name in names))


def untimed(line):
    return line.rsplit("|", 2)[0]


def picture(folder, name):
    return folder / "pictures/validation" / (name + ".svg")


def is_told(name, line, part, result, figure):
    """Whether docs/ and results.md have these numbers, and this picture."""
    lines, parts, results = read(DOCS)
    there = picture(DOCS, name)
    return (untimed(lines.get(name, "|||")) == untimed(line) and parts.get(name) == part and results.get(name) == result
            and there.exists() and there.read_text() == figure)


def keep(name, line, part, result, figure):
    """Puts a case into the page and the results of PAGES, which begin as those of docs/."""
    lines, parts, results = read(PAGES if (PAGES / PAGE).exists() and results_of(PAGES).exists() else DOCS)
    picture(PAGES, name).parent.mkdir(parents=True, exist_ok=True)
    picture(PAGES, name).write_text(figure)
    lines[name], parts[name], results[name] = line, part, result
    write(lines, parts, results)


def main(*words):
    check, quick = "--check" in words, "--quick" in words
    names = [word for word in words if not word.startswith("--")]
    unknown = [name for name in names if name not in CASES]
    if unknown:
        sys.exit("no case %s; there are %s" % (", ".join(unknown), ", ".join(CASES)))
    names = names or [name for name, case in CASES.items() if not quick or getattr(case, "quick", False)]
    others = []
    for name in names:
        line, part, result, figure = compute(name)
        print(line, flush=True)
        if not is_told(name, line, part, result, figure):
            others.append(name)
        if not check:
            keep(name, line, part, result, figure)
        elif name in others:
            print(part, result, sep="\n")
    other = "docs/theory/validation.md or validation/results.md has other numbers or pictures of: " + ", ".join(others)
    if check and others:
        sys.exit(other)
    if not check:
        print("written: %s%s" % (PAGES / PAGE, "; " + other if others and PAGES != DOCS else ""))


if __name__ == "__main__":
    main(*sys.argv[1:])

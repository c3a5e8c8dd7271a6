#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares weft with exact and published results: theory/validation.md with a picture per case, and every number in
results.md, in the folder PAGES.

validate.py                       every case; writes both and names the cases whose numbers docs/ and results.md have not
validate.py --quick               the quick half
validate.py --check [--quick]     fails where these have other numbers; writes nothing
validate.py NAME...               these cases alone; writes their parts

BUILD names the folder of the program, as in make; PAGES is BUILD/pages, unless it is docs. The numbers of a run are the
same on every machine.
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
PAGES = Path(os.environ.get("PAGES") or Path(os.environ.get("BUILD", "build")) / "pages")
CASES = {case.__name__.replace("_", "-"): case
         for module in (static, dynamic, sheets, drape) for case in module.CASES}
HEAD = """# Validation

If you must defend a result: these cases compare weft with exact and published results. `make validate` computes all of them
in 22 minutes on two cores, and names those that differ from this page; `make validate CASE=NAME` computes one.
[validation/results.md](../../validation/results.md) has every number, and the programs stand beside it.

The tolerance of a case is the uncertainty of its source, or of the method by which an exact value is approached (the finest
mesh, the step). A case that disagrees stays, with the reason. Expected values come from validation/exact.py or from the formula of the
case. The sources of drapes and of the plate with nu = 0.3 and Provot's paper were read; the others are cited from memory, and no
value is taken from them.

**What is missing**: no case compares the drape of a fabric with the measured drape of that same fabric, because no table with bending,
shear and drape of each fabric could be read in full. The Cusick cases compare with published *bands* and with one other program. Stick and
slip and the wrinkles of a twisted ribbon are missing too. Other pages have drapes [on a
support](../guides/test-a-fabric.md#a-disc-that-lies-on-its-support) and [other simulators](peers.md).

| case | result |
|---|---|
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


def shown_part(name, rows):
    """The rows that the page has: those that disagree, as a table, else the last one, as a sentence."""
    few = [row for row in rows if row[-1] != "yes"]
    more = len(rows) - max(len(few), 1)
    rest = "[%d more](../../validation/results.md#%s) agree%s.\n" % (more, name, "s" if more == 1 else "")
    if few:
        part = ["", table(("quantity that disagrees", "expected", "weft", "tolerance"), [row[:4] for row in few])]
        return part + ([rest] if more else [])
    what, expected, got, tolerance, _ = rows[-1]
    line = "- Result: %s is %s; expected %s" % (what, got, show(expected))
    line += ", tolerance %s" % show(tolerance) if tolerance else ""
    return [line + ("; " + rest if more else ".\n")]


def page_part(name, case, rows):
    """The section of the page of a case."""
    part = ["## " + name, "", case["title"] + "\n", "- Source: " + case["source"], "- Formula: " + case["formula"],
            "- Tolerance: " + case["tolerance"], *shown_part(name, rows)]
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
    case = CASES[name]()
    agree = sum(verdict(row) for row in case["rows"])
    result = "agrees" if agree == len(case["rows"]) else "%d of %d agree" % (agree, len(case["rows"]))
    line = "| [%s](#%s) | %s |" % (name, name, result)
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
    text = HEAD + "\n".join(lines[name] for name in names)
    (PAGES / PAGE).parent.mkdir(parents=True, exist_ok=True)
    (PAGES / PAGE).write_text(text + "\n\n" + "\n".join(parts[name] for name in names))
    results_of(PAGES).write_text(RESULTS_HEAD + "\n".join(results[name] for name in names))


def picture(folder, name):
    return folder / "pictures/validation" / (name + ".svg")


def is_told(name, line, part, result, figure):
    """Whether docs/ and results.md have these numbers, and this picture."""
    lines, parts, results = read(DOCS)
    there = picture(DOCS, name)
    return (lines.get(name) == line and parts.get(name) == part and results.get(name) == result
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
        began = time.monotonic()
        line, part, result, figure = compute(name)
        print("%s %.0f s" % (line, time.monotonic() - began), flush=True)
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

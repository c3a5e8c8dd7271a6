#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares weft with exact and published results: theory/validation.md with a picture per case, in the folder PAGES.

validate.py                       every case; writes the page and names the cases whose numbers docs/theory/validation.md has not
validate.py --quick               the quick half
validate.py --check [--quick]     fails where docs/theory/validation.md has other numbers; writes nothing
validate.py NAME...               these cases alone; writes their parts of the page

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

DOCS, PAGE = Path("docs"), "theory/validation.md"
PAGES = Path(os.environ.get("PAGES") or Path(os.environ.get("BUILD", "build")) / "pages")
CASES = {case.__name__.replace("_", "-"): case
         for module in (static, dynamic, sheets, drape) for case in module.CASES}
HEAD = """# Validation

weft against exact and published results: what a user who must defend a result can check. Every case is computed with the
program by `make validate`, which writes this page to build/pages and names the cases that differ from it here;
`make validate CASE=NAME` computes one case, and `RENEW=1` writes the page to docs. `make check-validation` computes the
quick half, as part of the gate, and `make nightly` all; both fail if a number differs from this page. The
programs are in the folder validation, in Python without other packages. Times are those of one run on two cores that other
programs used too: they give the order of magnitude.

The tolerance of a case is the uncertainty of its source, or of the method by which an exact value is approached (the
finest mesh, the step). It is stated with the case. A case that disagrees stays in the table with the reason.

Numbers that are expected come from programs of the folder validation (exact.py computes elastica, plates and buckling) or from
formulas that stand with the case. Of the sources, those of the bands and coefficients of drapes, of the plate with nu = 0.3
and the abstract on twisted ribbons were read when this page was written; Provot's paper is followed in
[model.md](model.md). The others are cited from memory, for who came first: no number is taken from them.

What this page does not show: stick and slip, and the wrinkles of a twisted ribbon. The drapes are clamped at the rim of the
support, without contact; [drape-on-a-body.md](../guides/drape-on-a-body.md#a-mesh-as-the-collider) has the disc that lies on one. Other simulators on the same work are in
[peers.md](peers.md). And no drape of a fabric is compared here with the measured drape of that same fabric. That needs a
table with bending, shear and drape of each fabric; none could be read in full when this page was written (ARS 72-17 of the
USDA, 1963, would be the first to take): **this comparison is owed**. Until then the Cusick cases compare with published
*bands* and with one other program.

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


def compute(name):
    """The part of the page of a case, its line of the table, its picture."""
    began = time.monotonic()
    case = CASES[name]()
    seconds = time.monotonic() - began
    agree = sum(verdict(row) for row in case["rows"])
    result = "agrees" if agree == len(case["rows"]) else "%d of %d agree" % (agree, len(case["rows"]))
    worst = max(case["rows"], key=lambda row: not verdict(row))
    line = "| [%s](#%s) | %s | %s | %s | %s | %.0f |" % (
        name, name, worst[0], show(worst[1]), measured(*worst[1:3]), result, seconds)
    rows = [(*row[:2], measured(*row[1:3]), row[3], "yes" if verdict(row) else "**no**") for row in case["rows"]]
    part = ["## " + name, "", case["title"] + "\n", "- Source: " + case["source"], "- Formula: " + case["formula"],
            "- Tolerance: " + case["tolerance"], "- Command: `make validate CASE=%s`" % name, ""]
    part.append(table(("quantity", "expected", "weft", "tolerance", "agrees"), rows))
    for head, more in case.get("tables", ()):
        part.append(table(head, more))
    part.append("![%s](../pictures/validation/%s.svg)\n" % (case["caption"], name))
    if case.get("text"):
        part.append(case["text"].strip() + "\n")
    return line, "\n".join(part), case["figure"]


def read(folder):
    """Lines of the table and parts of the page of a folder."""
    text = (folder / PAGE).read_text()
    lines = {m[1]: m[0] for m in re.finditer(r"^\| \[([\w-]+)\]\(#.*$", text, re.M)}
    parts = {m[1]: m[0] for m in re.finditer(r"^## ([\w-]+)\n.*?(?=^## |\Z)", text, re.M | re.S)}
    return lines, {name: part.rstrip("\n") + "\n" for name, part in parts.items()}


def write(lines, parts):
    names = [name for name in CASES if name in lines]
    text = HEAD + "| case | its first quantity, or the first that disagrees | expected | weft | result | time [s] |\n"
    text += "|---|---|---|---|---|---|\n" + "\n".join(lines[name] for name in names)
    (PAGES / PAGE).parent.mkdir(parents=True, exist_ok=True)
    (PAGES / PAGE).write_text(text + "\n\n" + "\n".join(parts[name] for name in names))


def untimed(line):
    return line.rsplit("|", 2)[0]


def picture(folder, name):
    return folder / "pictures/validation" / (name + ".svg")


def is_told(name, line, part, figure):
    """Whether docs/ has these numbers, and this picture."""
    lines, parts = read(DOCS)
    there = picture(DOCS, name)
    return (untimed(lines.get(name, "|||")) == untimed(line) and parts.get(name) == part
            and there.exists() and there.read_text() == figure)


def keep(name, line, part, figure):
    """Puts a case into the page of PAGES, which begins as that of docs/."""
    lines, parts = read(PAGES if (PAGES / PAGE).exists() else DOCS)
    picture(PAGES, name).parent.mkdir(parents=True, exist_ok=True)
    picture(PAGES, name).write_text(figure)
    lines[name], parts[name] = line, part
    write(lines, parts)


def main(*words):
    check, quick = "--check" in words, "--quick" in words
    names = [word for word in words if not word.startswith("--")]
    unknown = [name for name in names if name not in CASES]
    if unknown:
        sys.exit("no case %s; there are %s" % (", ".join(unknown), ", ".join(CASES)))
    names = names or [name for name, case in CASES.items() if not quick or getattr(case, "quick", False)]
    others = []
    for name in names:
        line, part, figure = compute(name)
        print(line, flush=True)
        if not is_told(name, line, part, figure):
            others.append(name)
        if not check:
            keep(name, line, part, figure)
        elif name in others:
            print(part)
    other = "docs/theory/validation.md has other numbers or pictures of: " + ", ".join(others)
    if check and others:
        sys.exit(other)
    if not check:
        print("written: %s%s" % (PAGES / PAGE, "; " + other if others and PAGES != DOCS else ""))


if __name__ == "__main__":
    main(*sys.argv[1:])

# SPDX-License-Identifier: BSD-3-Clause
"""Every public name has a docstring, in the form of numpydoc where it takes or gives something."""
import builtins
import inspect
import re

import pytest

import weft
import weft.garment
import weft.mesh

MODULES = {"weft.garment": ["load", "relaxed"], "weft.mesh": ["flat_coordinates"]}


def public():
    """(name, object) of the functions, classes and members that a user sees."""
    names = [("weft." + name, getattr(weft, name)) for name in weft.__all__]
    names += [("%s.%s" % (module, name), getattr(inspect.importlib.import_module(module), name))
              for module, members in MODULES.items() for name in members]
    for name, of in names:
        if inspect.isfunction(of) or inspect.isclass(of):
            yield name, of
        for member, raw in vars(of).items() if inspect.isclass(of) else ():
            if not member.startswith("_") and member not in getattr(of, "_fields", ()):
                yield name + "." + member, raw.__func__ if isinstance(raw, staticmethod) else raw


EVERYTHING = list(public())


def sections(of):
    """{"Parameters": text, ...} of a docstring, and "" for what comes before."""
    parts = re.split(r"^(\w+)\n-+\n", inspect.getdoc(of), flags=re.MULTILINE)
    return {"": parts[0], **dict(zip(parts[1::2], parts[2::2]))}


def described(section):
    """The names that a section lists: "a, b : int" or "**fields"."""
    found = set()
    for line in section.splitlines():
        if line and not line.startswith(" "):
            found.update(name.strip().lstrip("*") for name in line.split(" : ")[0].split(","))
    return found


def is_record(of):
    return inspect.isclass(of) and hasattr(of, "_fields")


def is_error(of):
    return inspect.isclass(of) and issubclass(of, Exception)


def test_the_walk_meets_the_api():
    names = dict(EVERYTHING)
    assert len(names) > 120
    for name in ("weft.load", "weft.Sim.name", "weft.Sim.cols", "weft.Sim.stats", "weft.Sim.pin", "weft.Batch.forces",
                 "weft.Mesh.from_meshio", "weft.Run.shapes", "weft.Energy.total", "weft.garment.load"):
        assert name in names


@pytest.mark.parametrize("name, of", EVERYTHING, ids=[name for name, _ in EVERYTHING])
def test_a_public_name_has_a_docstring_that_begins_with_a_sentence(name, of):
    doc = (inspect.getdoc(of) or "").strip()
    assert doc and not doc.startswith(name.rpartition(".")[2] + "("), name
    assert re.match(r"[A-Z\[(]|\w+\(\) of|n simulations|pin\(\)|Sim\.pin|shapes\.csv|series\.csv|final\.csv", doc), doc[:40]
    assert doc.split("\n\n")[0].rstrip().endswith((".", ":", "]", "kept.")) or "\n" not in doc, doc[:80]


@pytest.mark.parametrize("name, of", EVERYTHING, ids=[name for name, _ in EVERYTHING])
def test_parameters_results_and_fields_stand_in_their_sections(name, of):
    found = sections(of)
    if is_record(of):
        assert described(found.get("Attributes", "")) == set(of._fields), name
        return
    if is_error(of) or isinstance(of, property) or not callable(of):
        return
    made = inspect.isclass(of) and (issubclass(of, Warning) or of in (weft.Sim,))  # by weft alone
    arguments = [] if made else [key for key in inspect.signature(of).parameters if key != "self"]
    assert described(found.get("Parameters", "")) == set(arguments), name
    if inspect.isclass(of):
        return
    result = str(inspect.signature(of).return_annotation)
    gives = "Yields" if result.startswith("Iterator") else None if result == "None" else "Returns"
    assert gives is None or gives in found, name
    assert gives is not None or not {"Returns", "Yields"} & set(found), name


@pytest.mark.parametrize("name, of", [(name, of) for name, of in EVERYTHING
                                      if name.count(".") == 1 + name.startswith(("weft.garment", "weft.mesh"))])
def test_a_function_or_class_has_an_example(name, of):
    if is_record(of) or (is_error(of) and of is not weft.NotFoundError):
        return
    assert ">>> " in sections(of).get("Examples", ""), name


def test_what_raises_says_so():
    for name in ("load", "run", "batch", "compare", "converge", "fit", "gradient", "map", "diff", "export", "view", "open",
                 "scene", "program", "methods", "amplification", "scene_help", "load_plugin"):
        assert "Raises" in sections(getattr(weft, name)), name
    for name in ("step", "advance", "frames", "between", "set_state", "save", "restore", "move_pin", "unpin", "add_shape"):
        assert "Raises" in sections(getattr(weft.Sim, name)), name


@pytest.mark.parametrize("name, of", [(name, of) for name, of in EVERYTHING if inspect.isfunction(of)])
def test_a_function_begins_with_what_it_does(name, of):
    assert re.match(r"[A-Z][a-z]*s\b", inspect.getdoc(of)), inspect.getdoc(of)[:60]


@pytest.mark.parametrize("name, of", EVERYTHING, ids=[name for name, _ in EVERYTHING])
def test_exceptions_that_a_docstring_names_exist(name, of):
    found = sections(of)
    for one in described(found.get("Raises", "")) | described(found.get("Warns", "")):
        kind = getattr(weft, one, None) or getattr(builtins, one, None)
        assert inspect.isclass(kind) and issubclass(kind, Exception), one

# SPDX-License-Identifier: BSD-3-Clause
import re
from pathlib import Path

import pytest

import weft

TREE = Path(__file__).resolve().parents[2]


def sheet():
    """The scene of the package's docstring."""
    code = re.search(r">>> scene = (.*?)\n>>>", weft.__doc__, re.DOTALL)[1]
    return eval(re.sub(r"^\.\.\. ", "", code, flags=re.MULTILINE))


@pytest.fixture
def scene():
    return sheet()


@pytest.fixture(scope="session")
def doctest_folder(tmp_path_factory):
    return tmp_path_factory.mktemp("doctest")


@pytest.fixture(autouse=True)
def examples_know(doctest_namespace, doctest_folder):
    doctest_namespace.update(weft=weft, scene=sheet(), tmp=doctest_folder)

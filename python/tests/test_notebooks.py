# SPDX-License-Identifier: BSD-3-Clause
"""The notebooks of examples/notebooks, each run in an empty folder (make check-notebooks)."""
import pytest
from conftest import TREE

nbclient = pytest.importorskip("nbclient")
pytest.importorskip("ipykernel")
nbformat = pytest.importorskip("nbformat")

NOTEBOOKS = sorted((TREE / "examples" / "notebooks").glob("*.ipynb"))


def read(path):
    notebook = nbformat.read(path, 4)
    nbformat.validate(notebook)
    return notebook


def test_there_are_the_six_that_the_pages_name():
    assert [path.stem for path in NOTEBOOKS] == ["drape", "exercises", "fit", "lecture", "own-method", "work-precision"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_kept_without_outputs(path):
    cells = [cell for cell in read(path).cells if cell.cell_type == "code"]
    assert all(cell.outputs == [] and cell.execution_count is None for cell in cells)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_in_an_empty_folder_and_warns_of_nothing(path, tmp_path, monkeypatch):
    monkeypatch.delenv("MPLBACKEND", raising=False)
    notebook = read(path)
    nbclient.NotebookClient(notebook, timeout=600, kernel_name="python3", resources={"metadata": {"path": str(tmp_path)}}).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert len(outputs) > 0
    assert [output.text for output in outputs if output.get("name") == "stderr"] == []
    shown = [output.data["text/html"] for output in outputs if "text/html" in output.get("data", {})]
    assert ("<iframe" in "".join(shown)) == (path.stem not in ("exercises", "fit"))


def test_there_are_ten_exercises_each_with_its_answer_hidden():
    cells = read(TREE / "examples" / "notebooks" / "exercises.ipynb").cells[2:]
    assert [cell.cell_type for cell in cells] == ["markdown", "code"] * 10
    assert all(cell.source.startswith("**%d. " % (k + 1)) for k, cell in enumerate(cells[::2]))
    assert all(cell.metadata["jupyter"]["source_hidden"] for cell in cells[1::2])

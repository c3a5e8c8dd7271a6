# SPDX-License-Identifier: BSD-3-Clause
"""What the program does with runs: pages, exports, differences, refinement, methods of one's own."""
import html
import re

import numpy as np
import pytest

import weft


@pytest.fixture
def run(scene, tmp_path):
    return weft.run(scene, tmp_path / "run", {"run.duration": 0.2})


def page_within(markup):
    """The page in the iframe that a notebook gets."""
    frame = re.fullmatch(r'<iframe sandbox="([^"]*)"[^>]* srcdoc="([^"]*)"></iframe>', markup)
    assert "allow-scripts" in frame[1] and "allow-same-origin" not in frame[1]
    return html.unescape(frame[2])


def test_a_notebook_shows_the_page_that_view_writes(run):
    page = page_within(run._repr_html_())
    assert page == (run.directory / "run.html").read_text(encoding="utf-8")
    assert page.startswith("<!doctype html>") and "weft-data" in page


def test_show_opens_a_browser_outside_of_a_notebook(run, monkeypatch):
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    run.show()
    assert opened == [(run.directory / "run.html").as_uri()]


def test_two_runs_and_a_batch_have_pages(run, scene, tmp_path):
    other = weft.run(scene, tmp_path / "other place", {"run.duration": 0.2, "cloth.density": 0.3})
    both = weft.view(run, other, out=tmp_path / "both two.html", height=300)
    assert both.path == tmp_path / "both two.html" and 'height="300"' in both._repr_html_()
    weft.batch(scene, tmp_path / "b", {"run.duration": 0.1})
    assert weft.view(tmp_path / "b").path == tmp_path / "b" / "batch.html"
    for look in (weft.view, weft.Page, weft.open, lambda run: weft.diff(run, run), lambda run: weft.export(run, "obj")):
        with pytest.raises(weft.NotFoundError, match="nowhere"):
            look(tmp_path / "nowhere")


def test_an_exported_frame_has_the_positions(run):
    path, = weft.export(run, "obj", 3)
    vertices = re.findall(r"^v (\S+) (\S+) (\S+)$", path.read_text(), re.MULTILINE)
    assert (np.array(vertices, dtype=np.float32).reshape(8, 10, 3) == run.positions[3]).all()
    assert {p.name for p in weft.export(run, "pc2")} == {"run.pc2", "rest.obj"}
    with pytest.raises(weft.RunError, match="stl"):
        weft.export(run, "stl")


def test_diff_is_equal_up_to_a_tolerance(run, scene, tmp_path):
    assert weft.diff(run, run).equal
    other = weft.run(scene, tmp_path / "other", {"run.duration": 0.2, "cloth.density": 0.2 * (1 + 1e-9)})
    exact = weft.diff(run, other)
    assert not exact.equal and "first other state: frame 1" in exact.report
    assert weft.diff(run, other, tolerance=1e-6).equal


def test_converge_finds_the_order_of_a_fall_without_springs(scene):
    del scene["cloth"]["springs"], scene["cloth"]["pins"]
    scene["cloth"]["grid"] = {"rows": 9, "cols": 9, "spacing": 0.1}
    table = weft.converge(scene, [5, 9, 17], {"run.duration": 0.1}, at=["gravitational", "tip.y"])
    assert list(table["quantity"]) == ["gravitational"] * 3 + ["tip.y"] * 3 and list(table["size"][:3]) == [5, 9, 17]
    assert np.ptp(table["value"][3:]) < 1e-12


def test_fabrics_can_stand_in_scenes(scene):
    for name, fabric in weft.fabrics().items():
        scene["cloth"] = {"grid": {"rows": 8, "cols": 8, "spacing": [0.01, 0.012]}, "fabric": fabric}
        own = weft.load(scene)
        scene["cloth"]["fabric"] = {"preset": name}
        assert (own.masses == weft.load(scene).masses).all()


def test_packed_scenes_run_with_their_meshes():
    assert weft.load(weft.scene("skirt")).cols == 0 and weft.load(weft.scene("flag")).cols > 0
    with pytest.raises(weft.NotFoundError, match="'flog'; there are .*flag"):
        weft.scene("flog")


def rk4(rhs, t, y, h):
    a = rhs(t, y)
    b = rhs(t + h / 2, y + h / 2 * a)
    c = rhs(t + h / 2, y + h / 2 * b)
    return y + h / 6 * (a + 2 * b + 2 * c + rhs(t + h, y + h * c))


def test_an_own_method_stands_beside_the_same_of_a_library(scene, tmp_path):
    if not {"gsl", "arkode"} <= {method.plugin for method in weft.methods()}:
        pytest.skip("needs the plugins gsl and arkode")
    table = weft.compare(scene, tmp_path / "c", methods=["arkode/rk4"], until=0.04, own={"mine": rk4})
    mine, theirs = (table[(table["method"] == name) & (table["outcome"] == "done")] for name in ("mine", "rk4"))
    assert len(mine) >= 3 and list(mine["rhs_calls"]) == list(theirs["rhs_calls"])
    assert np.allclose(mine["error"], theirs["error"], rtol=1e-3)
    assert '"name":"mine"' in (tmp_path / "c" / "compare.html").read_text()


def test_a_run_by_an_own_method_can_be_played(scene, tmp_path):
    scene["stepper"] = {"plugin": "own", "method": "mine", "fixed_step": 1e-3}
    run = weft.run(scene, tmp_path / "run", {"run.duration": 0.1}, own={"mine": rk4})
    assert run.manifest["method"]["name"] == "mine" and "mine" in run._repr_html_()
    y = weft.load({**scene, "stepper": {"plugin": "verlet", "method": "euler", "fixed_step": 1e-3}})
    state, h = y.state.copy(), 1 / 30 / 34  # the fixed step divides a frame evenly
    for i in range(102):
        state = rk4(y.rhs, i * h, state, h)
    assert abs(run.final[["x", "y", "z"]].to_numpy() - state[:240].reshape(3, 80).T).max() < 1e-12


def test_what_an_own_method_raises_is_raised(scene, tmp_path):
    scene["stepper"] = {"plugin": "own", "method": "mine", "fixed_step": 1e-3}
    with pytest.raises(ZeroDivisionError):
        weft.run(scene, tmp_path / "a", own={"mine": lambda rhs, t, y, h: 1 / 0})
    with pytest.raises(ValueError, match="what a method returns has the shape"):
        weft.run(scene, tmp_path / "b", own={"mine": lambda rhs, t, y, h: y[1:]})
    with pytest.raises(weft.RunError, match="not finite"):
        weft.run(scene, tmp_path / "c", own={"mine": lambda rhs, t, y, h: y * np.nan})
    with pytest.raises(ValueError, match="no name of a method"):
        weft.run(scene, tmp_path / "d", own={"my method": rk4})
    with pytest.raises(TypeError, match="no function"):
        weft.run(scene, tmp_path / "e", own={"mine": 3})

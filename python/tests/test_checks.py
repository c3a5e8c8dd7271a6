# SPDX-License-Identifier: BSD-3-Clause
"""What is found before a run, runs that go on, and the family of errors."""
import inspect
import pickle
import re

import numpy as np
import pytest

import weft

SCENE = {"weft": 1, "stepper": {"plugin": "stiff", "method": "backward_euler", "fixed_step": 0.03},
         "run": {"duration": 1.0}}


def test_a_check_finds_the_stability_limit_that_a_simulation_computes(scene):
    found = weft.check(scene)
    own, = found.methods[found.methods["of_the_scene"]].to_dict("records")
    sim = weft.load(scene)
    assert (own["plugin"], own["method"]) == ("verlet", "velocity_verlet")
    assert own["stable_step"] == pytest.approx(sim.stable_step(), rel=1e-6)
    assert found.omega ** 2 == pytest.approx(sim.stiffness().omega2, rel=1e-9)
    assert (found.particles, found.pinned, found.trial) == (80, 2, None)
    assert len(found.methods) == len([m for m in weft.methods() if "butcher" not in m.flags])


def test_a_sharper_check_is_below_the_guaranteed_bounds(scene):
    sharp, safe = weft.check(scene, refine=True), weft.check(scene)
    assert 0.5 * safe.omega < sharp.omega <= safe.omega


def test_a_check_takes_overrides_and_raises_all_errors_of_a_scene(scene):
    assert weft.check(scene, {"cloth.grid.rows": 4}).particles == 40
    scene["cloth"]["densty"], scene["run"]["fsp"] = 1, 2
    with pytest.raises(weft.SceneError, match="densty'(.|\n)*fsp"):
        weft.check(scene)
    with pytest.raises(weft.NotFoundError):
        weft.check("nowhere.yaml")


def test_a_run_that_goes_on_has_the_files_of_a_longer_one(scene, tmp_path):
    short = weft.run(scene, tmp_path / "short", {"run.duration": 0.2, "run.keep_checkpoint": True, "run.checkpoint": 3})
    longer = weft.run(scene, tmp_path / "longer", {"run.duration": 0.4, "run.keep_checkpoint": True, "run.checkpoint": 3})
    assert not weft.diff(short, longer).equal
    assert weft.resume(short, 0.4).directory == tmp_path / "short"
    assert (tmp_path / "short" / "series.csv").read_bytes() == (tmp_path / "longer" / "series.csv").read_bytes()
    assert weft.diff(short, longer).equal


def test_what_cannot_go_on_is_refused(scene, tmp_path):
    run = weft.run(scene, tmp_path / "run", {"run.duration": 0.1})
    with pytest.raises(weft.RunError, match="^until 0.05: not a time beyond 0.1 s"):
        weft.resume(run, 0.05)
    with pytest.raises(weft.NotFoundError):
        weft.resume(tmp_path / "nothing")
    with pytest.raises(weft.NotFoundError, match="holds no run"):
        weft.resume(tmp_path)


def test_the_strip_has_the_modulus_of_its_fabric(tmp_path):
    denim = weft.fabrics()["11oz-black-denim"]
    found = weft.lab("strip", "11oz-black-denim", tmp_path)
    assert (found.test, found.fabric, found.picture) == ("strip", "11oz-black-denim", None)
    assert found.values["modulus"] == pytest.approx(denim["stretch"][0], rel=0.01)
    assert found.values["extension"] == pytest.approx(100 * 490 / found.values["modulus"], rel=1e-9)
    assert weft.load(found.scene).particles == 11


def test_a_fabric_of_a_scene_is_tested(tmp_path):
    fabric = {"density": 0.2, "stretch": 500, "shear": 20, "bend": 1e-5}
    cloth = {"grid": {"rows": 3, "cols": 3, "spacing": 0.05}, "fabric": fabric}
    found = weft.lab("cantilever", {**SCENE, "name": "mine", "cloth": cloth}, tmp_path, {"run.duration": 20})
    length = (1e-5 / (0.2 * 9.81)) ** (1 / 3)
    assert found.fabric == "mine" and found.scene == tmp_path / "cantilever-mine.yaml"
    assert found.values["bending_length"] == pytest.approx(length, rel=0.03)
    assert found.values["rigidity"] == pytest.approx(1e-5, rel=0.09)
    with pytest.raises(weft.RunError, match="File exists with another text; force=True"):
        weft.lab("cantilever", {**SCENE, "name": "mine", "cloth": {**cloth, "fabric": {**fabric, "bend": 2e-5}}}, tmp_path)


def test_the_drape_has_a_picture(tmp_path):
    found = weft.lab("drape", "11oz-black-denim", tmp_path, {"cloth.cut.spacing": 0.03, "run.duration": 0.3})
    assert 0 < found.values["coefficient"] < 100
    assert "<svg" in found.picture.read_text()


def test_tests_and_fabrics_that_are_not_there_are_named(tmp_path, scene):
    with pytest.raises(weft.ArgumentError, match="there is no test 'tear'; there are drape, cantilever, strip$"):
        weft.lab("tear", "11oz-black-denim", tmp_path)
    with pytest.raises(weft.ArgumentError, match="there is no fabric 'denim'; there are .*11oz-black-denim"):
        weft.lab("drape", "denim", tmp_path)
    with pytest.raises(weft.SceneError, match="its cloth has no fabric"):
        weft.lab("drape", scene, tmp_path)


WRONG = [
    (ValueError, lambda sim, tmp: sim.advance(-1.0)),
    (ValueError, lambda sim, tmp: sim.set_state(np.zeros((3, 3)))),
    (ValueError, lambda sim, tmp: sim.add_shape("cone")),
    (ValueError, lambda sim, tmp: weft.Batch(sim.scene, 0)),
    (ValueError, lambda sim, tmp: weft.load({**SCENE, "weft": 7})),
    (TypeError, lambda sim, tmp: weft.load(sim.scene, force=3)),
    (TypeError, lambda sim, tmp: sim.set_state(np.full((80, 3), "x"))),
    (TypeError, lambda sim, tmp: weft.gradient(sim.scene, len, "cloth.density")),
    (IndexError, lambda sim, tmp: sim.pin(80)),
    (IndexError, lambda sim, tmp: sim.shape_pose(0)),
    (KeyError, lambda sim, tmp: weft.run(sim.scene, tmp / "run", {"run.duration": 0.1, "record.fields": []}).strains),
    (AttributeError, lambda sim, tmp: setattr(sim, "positons", 0)),
    (FileNotFoundError, lambda sim, tmp: weft.open(tmp / "nothing")),
    (RuntimeError, lambda sim, tmp: sim.restore(b"nothing")),
]


@pytest.mark.parametrize("kind, wrong", WRONG)
def test_every_error_is_of_one_family_and_of_pythons(scene, tmp_path, kind, wrong):
    with pytest.raises(weft.Error) as caught:
        wrong(weft.load(scene), tmp_path)
    assert isinstance(caught.value, kind)
    assert str(caught.value) and str(caught.value)[0] not in "'\""
    again = pickle.loads(pickle.dumps(caught.value))
    assert type(again) is type(caught.value) and str(again) == str(caught.value)


def test_every_exception_of_the_package_is_of_the_family():
    errors = [of for of in map(weft.__dict__.get, weft.__all__) if inspect.isclass(of) and issubclass(of, Exception)]
    assert len(errors) > 12
    assert all(issubclass(of, (weft.Error, Warning)) for of in errors)


def test_messages_name_functions_of_python(scene, tmp_path):
    with pytest.raises(weft.SceneError) as caught:
        weft.load({**scene, "sweep": {"cloth.density": [0.1, 0.2]}})
    assert "weft.batch() runs them" in str(caught.value)
    assert "weft.batch() runs them" in caught.value.diagnostics[0].message
    weft.run(scene, tmp_path / "run", {"run.duration": 0.1})
    (tmp_path / "run" / "result.yaml").unlink()
    with pytest.raises(weft.RunError) as caught:
        weft.run(scene, tmp_path / "run", {"run.duration": 0.1})
    assert re.search(r"weft\.resume\(.*\) continues it; or choose another out, or force=True", str(caught.value))
    with pytest.raises(weft.RunError) as caught:
        weft.compare(scene, tmp_path / "compared", methods=["verlat"])
    assert re.search(r"^methods: no method 'verlat'.*; weft\.methods\(\) lists them$", str(caught.value))


@pytest.mark.parametrize("kind", [weft.Sim, weft.Batch, weft.Run, weft.Page, weft.Mesh])
def test_objects_have_slots_and_no_dict(kind):
    assert "__dict__" not in dir(kind)

"""Solutions: numbers, dense output, arrays, files, pictures, pickles."""

import copy
import gc
import json
import pickle
import subprocess

import extremal as ex
import numpy as np
import pytest
from conftest import SCENES


def test_numbers_are_those_of_shooting(arc):
    s = arc.solve(tolerance=1e-12)
    assert s.converged and s.status == "converged" and s.index == 0 and s.nullity == 0 and s.minimizing
    assert s.momentum_start["x"] == pytest.approx(0.0986855516302332, abs=1e-11)
    assert s.momentum_start["y"] == pytest.approx(0.9978231699793557, abs=1e-11)
    np.testing.assert_allclose(np.asarray(s.momentum_start), s.v(0), rtol=1e-13)
    assert s.windows.tolist() == [[0, 2.5]] and len(s.conjugate_times) == 0 and s.multipliers is None
    assert s.error_estimate < 1e-11 and s.iterations == len(s.history) > 0


def test_dense_output_solves_the_equation_of_motion(arc):
    s = arc.solve(tolerance=1e-12)
    assert s(1.3).shape == (2,)
    t = np.linspace(0, 2.5, 1001)
    q, v, p = s(t), s.v(t), s.p(t)
    assert q.shape == v.shape == p.shape == (1001, 2)
    np.testing.assert_array_equal(q, s.q(t))
    np.testing.assert_array_equal(v, p)
    assert s(t.reshape(7, 143)).shape == (7, 143, 2)
    np.testing.assert_allclose(q[[0, -1]], [[1, 0], [-0.6, 0.9]], atol=1e-12)
    energy = (v**2).sum(1) / 2 - 1 / np.hypot(*q.T)
    np.testing.assert_allclose(energy, s.energy, atol=1e-10)
    with pytest.raises(ValueError, match="from 0 to 2.5"):
        s(2.6)
    with pytest.raises(ValueError):
        s(np.nan)


def test_coordinates_by_name(arc):
    s = arc.solve()
    assert s.t[0] == 0 and s.t[-1] == 2.5 and (np.diff(s.t) > 0).all()
    np.testing.assert_array_equal(s.x, s(s.t)[:, 0])
    np.testing.assert_array_equal(s["y'"], s.v(s.t)[:, 1])
    np.testing.assert_array_equal(s["p_y"], s.p(s.t)[:, 1])
    inside = s.nodes[:, :-1].reshape(-1, 2)
    np.testing.assert_array_equal(s.x[:-1], inside[:, 0])
    with pytest.raises(AttributeError, match="'z'"):
        s.z
    with pytest.raises(KeyError, match="x, y"):
        s["z"]
    with pytest.raises(TypeError, match="no element 0"):
        s[0]
    with pytest.raises(TypeError, match="not iterable"):
        list(s)
    assert "x" in dir(s)


def test_arrays_are_views_that_keep_their_owner(arc):
    s = arc.solve()
    nodes, windows = s.nodes, s.windows
    assert np.shares_memory(nodes, s.nodes) and not nodes.flags.owndata
    values = nodes.copy()
    del s
    gc.collect()
    for _ in range(5):
        arc.solve()
    np.testing.assert_array_equal(nodes, values)
    assert windows.tolist() == [[0, 2.5]]
    with pytest.raises(ValueError):
        nodes[0] = 1
    with pytest.raises(ValueError):
        nodes.flags.writeable = True


def test_solutions_do_not_change(arc):
    s = arc.solve()
    with pytest.raises(AttributeError):
        s.action = 0
    with pytest.raises(AttributeError):
        del s.action
    assert copy.deepcopy(s) is s and copy.copy(s) is s
    with pytest.raises(TypeError):
        ex.Solution()


def test_a_pickle_has_every_number():
    for name, keys in [("figure-eight", {}), ("kepler", {}), ("stoermer-verlet", {}), ("van-der-pol", {})]:
        s = ex.load(SCENES / f"{name}.toml").solve(**keys)
        again = pickle.loads(pickle.dumps(s))
        one, two = s.to_dict(50), again.to_dict(50)
        one.pop("seconds"), two.pop("seconds")
        assert one == two, name
        assert len(again.history) == len(s.history)


def test_the_result_is_that_of_the_command(arc, tmp_path, command):
    scene = tmp_path / "scene.toml"
    scene.write_text(arc.to_toml())
    subprocess.run(
        [command, "solve", scene, "--output", tmp_path / "r.json", "--samples", "11", "--quiet"], check=True
    )
    written = json.loads((tmp_path / "r.json").read_text())
    arc.solve().save(tmp_path / "deep" / "s.json", samples=11)
    saved = json.loads((tmp_path / "deep" / "s.json").read_text())
    written.pop("seconds"), saved.pop("seconds")
    assert saved == written


def test_periodic_orbits_have_multipliers():
    s = ex.load(SCENES / "figure-eight.toml").solve()
    assert s.multipliers.dtype == complex and s.multipliers.shape == (12,)
    np.testing.assert_allclose(abs(s.multipliers), 1, atol=1e-6)
    assert s.krein.shape == (12,) and s.minimal_period == pytest.approx(s.duration)
    assert [list(map(complex, s.multipliers))] == [[complex(*z) for z in s.to_dict()["multipliers"]]]


def test_fits(tmp_path):
    steps = []
    s = ex.load(SCENES / "damped-pendulum-fit.toml").solve(progress=steps.append)
    assert s.converged and s.fit is not None
    assert len(steps) > 1 and isinstance(steps[0], ex.FitStep) and steps[-1].chi_squared > 0
    written = s.to_dict()
    assert dict(s.fit.parameters) == written["parameters"]
    np.testing.assert_array_equal(s.fit.covariance, written["covariance"])
    assert np.all(np.linalg.eigvalsh(s.fit.covariance) > 0)
    assert s.fit.chi_squared == written["chi_squared"]
    for name, (t, left) in s.fit.residuals.items():
        assert len(t) == len(left) > s.fit.freedom / 10 and abs(left.mean()) < left.std(), name
    with pytest.raises(ValueError):
        s.fit.covariance[0, 0] = 1
    again = pickle.loads(pickle.dumps(s))
    assert dict(again.fit.parameters) == dict(s.fit.parameters) and again.fit.freedom == s.fit.freedom
    np.testing.assert_array_equal(again.fit.covariance, s.fit.covariance)
    np.testing.assert_allclose(again.p([0, 3])[1], s.p([0, 3])[1])
    np.testing.assert_allclose(s.p(s.duration), list(s.momentum_end.values()), rtol=1e-9)
    s.plot(tmp_path / "fit.svg")
    assert (tmp_path / "fit.svg").stat().st_size > 1000
    assert ex.load(SCENES / "pendulum.toml").solve().fit is None


def test_files(arc, tmp_path):
    s = arc.solve()
    s.save(tmp_path / "s.csv", samples=5)
    assert len((tmp_path / "s.csv").read_text().splitlines()) == 6
    s.save(tmp_path / "s.npz", samples=[0, 1, 2.5])
    arrays = np.load(tmp_path / "s.npz")
    assert sorted(arrays) == ["p_x", "p_y", "t", "x", "x'", "y", "y'"]
    np.testing.assert_array_equal(arrays["x"], s([0, 1, 2.5])[:, 0])
    again = arc.replace(guess={"file": str(tmp_path / "s.csv")}).solve()
    assert again.action == pytest.approx(s.action, rel=1e-9)
    with pytest.raises(ValueError, match="units"):
        s.save(tmp_path / "s.oem")
    space = {"length": 1e3, "time": 1e4, "frame": "ICRF", "centre": "SUN", "epoch": "2025-01-31T12:00:00"}
    arc.replace(units=space).solve().save(tmp_path / "s.oem", samples=3)
    first = "2025-01-31T12:00:00.000000000 1.000000000000000e+03 0.000000000000000e+00 "
    assert first in (tmp_path / "s.oem").read_text()
    for bad in ("s.txt", "s"):
        with pytest.raises(ValueError, match="ends neither"):
            s.save(tmp_path / bad)
    with pytest.raises(RuntimeError, match="missing|written|folder|No such|denied"):
        s.save("/proc/none/s.json")


def test_pictures(arc, tmp_path):
    s = arc.solve()
    assert s.plot().svg.startswith("<?xml") and "</svg>" in s._repr_svg_()
    assert s.plot(tmp_path / "s.png") is None
    assert (tmp_path / "s.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(ValueError):
        s.plot(tmp_path / "s.bmp")


def test_pages(arc, tmp_path):
    s = arc.solve()
    try:
        s.plot(tmp_path / "s.html")
    except ValueError as e:  # a build without npm
        assert "built" in str(e)
        return
    page = (tmp_path / "s.html").read_text()
    assert page.startswith("<!doctype html>") and repr(s.action) in page


def test_the_table_is_that_of_the_command(arc):
    lines = repr(arc.solve()).splitlines()
    assert lines[0] == "status          converged" and lines[-1].startswith("time")


def test_a_failed_solve_says_why():
    # Between conjugate ends there is no motion of an oscillator but for special ends.
    failing = ex.Problem("x'^2/2 - x^2/2", start={"x": 0}, end={"x": 1}, duration="pi")
    s = failing.solve()
    assert not s.converged and s.status == "conjugate-ends" and s.message
    assert s.nodes is None and s.index is None and s.windows is None
    assert [s.action, s.duration, s.error_estimate, s.residual, s.energy] == [None] * 5
    assert s.to_dict(5)["status"] == s.status and "samples" not in s.to_dict(5)
    with pytest.raises(ValueError, match="no trajectory"):
        s(0.5)
    with pytest.raises(ValueError):
        s.plot()
    with pytest.raises(ex.NotConverged, match="conjugate-ends") as error:
        failing.solve(raise_on_failure=True)
    assert error.value.solution.status == "conjugate-ends"
    assert pickle.loads(pickle.dumps(s)).message == s.message


def test_several_solutions_come_by_their_actions():
    pendulum = ex.Problem("th'^2/2 + cos(th)", start={"th": 0}, end={"th": 1}, duration=10)
    found = pendulum.solve(solutions=4)
    assert len(found) == 4 and all(s.converged for s in found)
    assert [s.action for s in found] == sorted(s.action for s in found)
    one = pendulum.replace(search={"solutions": 4}).solve()
    assert [s.action for s in one.solutions] == [s.action for s in found]
    assert len(one.to_dict()["solutions"]) == 4 and one.to_dict()["action"] == one.action
    assert found[0].solutions == (found[0],)
    assert "</svg>" in one.plot().svg
    assert len(pickle.loads(pickle.dumps(one)).solutions) == 4


def test_a_table_of_several_solutions_is_that_of_the_command(tmp_path, command):
    scene = tmp_path / "scene.toml"
    law, search = "th'^2/2 + cos(th)", {"solutions": 2}
    pendulum = ex.Problem(law, start={"th": 0}, end={"th": 1}, duration=10, search=search)
    scene.write_text(pendulum.to_toml())
    written = ["--csv", tmp_path / "c.csv", "--output", tmp_path / "c.json", "--samples", "201"]
    subprocess.run([command, "solve", scene, *written, "--quiet"], check=True)
    for ending in ("csv", "json"):
        pendulum.solve().save(bytes(tmp_path / f"p.{ending}"))
    assert (tmp_path / "p.csv").read_text() == (tmp_path / "c.csv").read_text()
    ours, theirs = (json.loads((tmp_path / f"{name}.json").read_text()) for name in "pc")
    for result in (ours, theirs, *ours["solutions"], *theirs["solutions"]):
        del result["seconds"]
    assert ours == theirs


def test_samples_are_a_number_or_a_list_of_times(arc):
    s = arc.solve()
    assert s.to_dict([1, 0])["samples"]["t"] == [1, 0]
    for samples in (1, [[0, 1], [1, 2]]):
        with pytest.raises(ValueError, match="samples"):
            s.to_dict(samples)


def test_schemes_are_keywords(arc):
    s = arc.solve(scheme="midpoint", elements=64)
    assert s.elements == 64 and s.degree == 1
    with pytest.raises(ex.SceneError, match="excludes|exclude"):
        arc.replace(scheme="midpoint", elements=64).solve(tolerance=1e-3)
    with pytest.raises(ex.SceneError):
        arc.solve(tolerance=0)

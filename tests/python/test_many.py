"""Many arcs and families."""

import copy
import pickle

import extremal as ex
import numpy as np
import pytest
from conftest import KEPLER, SCENES


def circle(m):
    angle = np.linspace(0.5, 2.5, m)
    return np.c_[np.cos(angle), np.sin(angle)]


@pytest.mark.parametrize("threads", [1, 3])
def test_each_row_is_a_solve(arc, threads):
    end, duration = circle(40), np.linspace(1, 3, 40)
    many = arc.solve_many(end=end, duration=duration, tolerance=1e-8, threads=threads)
    assert many.converged.all() and set(many.status) == {"converged"} and len(many) == 40
    assert many.q.shape == many.momenta.shape == (40, 2, 2)
    np.testing.assert_array_equal(many.q[:, 1], end)
    np.testing.assert_array_equal(many.duration, duration)
    for k in (0, 17, 39):
        one = arc.replace(end=dict(zip("xy", end[k])), duration=duration[k]).solve(tolerance=1e-8)
        assert many.action[k] == one.action and many.energy[k] == one.energy
        np.testing.assert_array_equal(
            many.momenta[k], [list(one.momentum_start.values()), list(one.momentum_end.values())]
        )
        assert many.index[k] == one.index and many.error_estimate[k] == one.error_estimate
    assert pickle.loads(pickle.dumps(many)).action.tolist() == many.action.tolist()


def test_ends_that_the_problem_leaves_open_are_fixed():
    problem = ex.Problem(KEPLER, start={"x": 1, "y": 0}, duration=2.0)
    many = problem.solve_many(end=circle(5))
    np.testing.assert_array_equal(many.q[:, 1], circle(5))
    many = problem.solve_many(start=circle(5), end=[-1, 0.1])
    np.testing.assert_array_equal(many.q[:, 0], circle(5))


def test_failures_are_masked():
    oscillator = ex.Problem("x'^2/2 - x^2/2", start={"x": 0}, end={"x": 1}, duration=1.0)
    many = oscillator.solve_many(duration=[1.0, np.pi, 2.0])
    assert many.converged.tolist() == [True, False, True] and many.status[1] == "conjugate-ends"
    assert many.action.mask.tolist() == [False, True, False]
    assert many.q.mask[1].all() and not many.q.mask[[0, 2]].any()
    assert many.action[0] == pytest.approx(oscillator.solve().action)
    assert np.isfinite(many.action.data).all()


def test_forces_and_times_and_initial_data():
    driven = ex.Problem(
        "x'^2/2 - x^2/2 + cos(t)*x", force={"x": "-0.1*x'"}, start={"x": 0}, end={"x": 1}, duration=1
    )
    many = driven.solve_many(end=[[1.0], [2.0]])
    assert many.converged.all() and np.ma.getmaskarray(many.index).all()
    one = driven.replace(end={"x": 2.0}).solve()
    assert many.momenta[1, 0, 0] == pytest.approx(one.momentum_start["x"], rel=1e-9)
    thrown = ex.Problem("(x'^2 + y'^2)/2 - y", start={"x": 0, "y": 0, "p_x": 1, "p_y": 1}, duration=1.0)
    many = thrown.solve_many(start=[[0, 0], [0, 3]], duration=[1, 2])
    np.testing.assert_allclose(many.q[:, 1], [[1, 0.5], [2, 3]], atol=1e-9)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({}, "a row for each"),
        ({"end": [1, 2]}, "a row for each"),
        ({"end": np.zeros((3, 3))}, "shape"),
        ({"end": np.zeros((3, 2)), "duration": [1, 2]}, "number of rows"),
        ({"end": [[0.5, np.nan]]}, r"end\[0, 1\] = nan"),
        ({"duration": [np.inf, 1]}, r"duration\[0\] = inf"),
        ({"duration": [[1.0], [2.0]]}, "shape"),
        ({"duration": [1, -1]}, "duration\\[1\\] = -1"),
        ({"duration": [1.0], "threads": 0}, "threads"),
    ],
)
def test_wrong_arrays(arc, keys, message):
    with pytest.raises(ValueError, match=message):
        arc.solve_many(**keys)


def test_complex_numbers_are_refused(arc):
    """numpy would leave their imaginary parts out."""
    with pytest.raises(TypeError, match="end has complex"):
        arc.solve_many(end=[[0.5, 1j]])
    with pytest.raises(TypeError, match="t has complex"):
        arc.solve()(np.array([1j]))


def test_no_rows(arc):
    assert len(arc.solve_many(end=np.zeros((0, 2)))) == 0


def test_a_family_as_arrays(tmp_path):
    problem = ex.load(SCENES / "lyapunov-family.toml")
    seen = []
    branch = problem.follow("duration", to=3.2, points=12, progress=seen.append)
    m = len(branch)
    assert 5 <= m == len(seen) and seen[3].parameter == branch.parameter[3]
    assert branch.name == "duration"
    np.testing.assert_array_equal(branch.duration, branch.parameter)
    assert branch.multipliers.shape == (m, 6) and branch.q.shape == branch.v.shape == (m, 3)
    s = branch[-1]
    assert s.converged and s.duration == branch.duration[-1]
    np.testing.assert_array_equal(s(0), branch.q[-1])
    assert s.problem.solve().converged
    assert len(branch.to_dict()["points"]) == m and "duration" in repr(branch)
    branch.save(tmp_path / "b.csv")
    assert len((tmp_path / "b.csv").read_text().splitlines()) == m + 1
    assert "</svg>" in branch.plot(quantity="x(0)").svg
    with pytest.raises(ValueError, match="quantity"):
        branch.plot(quantity="nothing(0)")
    with pytest.raises(IndexError):
        branch[m]
    with pytest.raises(TypeError, match="slice"):
        branch[1:3]
    assert "parameter" in repr(seen[3])


def test_a_pickle_of_a_family_has_every_point(arc):
    branch = arc.follow("duration", to=3.0, points=6)
    again = pickle.loads(pickle.dumps(branch))
    assert again.to_dict() == branch.to_dict() and repr(again) == repr(branch)
    np.testing.assert_array_equal(again[3](1.3), branch[3](1.3))
    assert again.plot(quantity="x'(0)").svg == branch.plot(quantity="x'(0)").svg
    assert copy.copy(branch) is branch and copy.deepcopy(branch) is branch


def test_a_family_in_a_parameter_has_its_momenta():
    law = "m*x'^2/2 - x^2/2"
    problem = ex.Problem(law, parameters={"m": 1.0}, start={"x": 0}, end={"x": 1}, duration=1.0)
    branch = problem.follow("m", to=2.0)
    assert branch.parameter[0] == 1 and branch.parameter[-1] == pytest.approx(2)
    np.testing.assert_allclose(branch[-1].p(0), 2 * branch.v[-1], rtol=1e-12)
    assert branch.multipliers is None
    # An oscillator of mass m: action = m w cos(w)/(2 sin(w)), w = m^(-1/2).
    w = branch.parameter**-0.5
    np.testing.assert_allclose(branch.action, branch.parameter * w / np.tan(w) / 2, rtol=1e-8)


def test_a_family_in_the_energy_frees_the_duration(arc):
    branch = arc.follow("energy", to=-1.4, points=20)
    assert len(branch) == 20 and branch.name == "energy"
    assert branch.energy[0] == pytest.approx(arc.solve().energy, rel=1e-9)
    assert branch.duration[0] == pytest.approx(2.5, rel=1e-7)
    # No ellipse between these ends has a lower energy: -2/(r1 + r2 + chord).
    chord = np.hypot(1.6, 0.9)
    assert branch.energy.min() == pytest.approx(-2 / (1 + np.hypot(0.6, 0.9) + chord), rel=1e-8)
    assert "fold" in branch.kind
    assert branch[3].energy == branch.energy[3]


def test_a_family_that_is_none(arc):
    with pytest.raises(ValueError, match="continuation"):
        arc.follow()
    with pytest.raises(ex.SceneError, match="nothing"):
        arc.follow("nothing", to=1)
    with pytest.raises(TypeError):
        arc.follow(to=1)

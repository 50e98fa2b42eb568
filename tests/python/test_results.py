"""Results beyond those of smooth problems: each field of a file is an attribute."""

import pickle

import extremal as ex
import numpy as np
import pytest
from conftest import SCENES

FREE = "(x'^2 + y'^2)/2"


def test_constraints():
    """A pendulum as a point on a circle: the force of the rod is that of its acceleration and of gravity."""
    s = ex.Problem(
        "(x'^2 + y'^2)/2 - 9.81*y",
        constraints=["x^2 + y^2 = 1"],
        start={"x": 0, "y": -1},
        end={"x": 0.6, "y": -0.8},
        duration=0.5,
    ).solve(tolerance=1e-11)
    t = np.linspace(0, 0.5, 7)
    q, v, force = s(t), s.v(t), s.constraint_forces(t)
    assert force.shape == (7, 1) and s.constraint_forces(0.25).shape == (1,)
    # λ of r'' = −g e_y + 2 λ r, with |r| = 1 and r·r'' = −v²
    assert force[:, 0] == pytest.approx((9.81 * q[:, 1] - (v**2).sum(axis=1)) / 2, rel=1e-9)
    assert (q**2).sum(axis=1) == pytest.approx(1, abs=1e-14)
    assert s.path_forces(t) is None and s.contacts is None
    assert s.to_dict(3)["samples"]["constraint_forces"][0][0] == force[0, 0]


def test_path_constraints():
    if not ex.load(SCENES / "round-a-disc.toml").solve().converged:
        pytest.skip("this build has no Ipopt")
    s = ex.Problem(
        FREE,
        path={"constraints": ["x^2 + y^2 >= 0.25"]},
        start={"x": -1, "y": 0.05},
        end={"x": 1, "y": 0.05},
        duration=1,
    ).solve()
    (contact,) = s.contacts
    assert contact["constraint"] == 0 and 0 < contact["from"] < 0.5 < contact["to"] < 1
    assert s.path_forces(0.5)[0] > 1 and s.path_forces([0.0, 1.0]).ravel() == pytest.approx([0, 0])
    assert s.constraint_forces(0.5) is None
    assert pickle.loads(pickle.dumps(s)).contacts == s.contacts


def test_forces():
    s = ex.Problem(
        "x'^2/2 - x^2/2", force={"x": "-0.1*x'"}, start={"x": 1}, end={"x": 0}, duration=1.0
    ).solve()
    energy = (s.v(1.0)[0] ** 2 + s(1.0)[0] ** 2) / 2 - (s.v(0.0)[0] ** 2 + s(0.0)[0] ** 2) / 2
    assert s.work == pytest.approx(energy, rel=1e-9) and s.index is None


def test_a_hamiltonian():
    s = ex.Problem(hamiltonian="p_x^2/2 + x^2/2", start={"x": 0}, end={"x": 1}, duration=1.0).solve()
    assert s.momentum_start["x"] == pytest.approx(1 / np.sin(1), rel=1e-8)
    assert s.p(0.5)[0] == pytest.approx(np.cos(0.5) / np.sin(1), rel=1e-8)


def test_waypoints():
    s = ex.Problem(
        FREE,
        start={"x": 0, "y": 0},
        end={"x": 1, "y": 0},
        duration=2,
        waypoints=[{"at": 1.0, "x": 0.2}],
    ).solve()
    (waypoint,) = s.waypoints
    assert waypoint["t"] == 1 and waypoint["impulse"] == {"x": pytest.approx(0.6)}


def test_integrals_and_unknowns():
    p = ex.Problem(
        "x'^2/2 - k*x^2/2",
        start={"x": 0},
        end={"x": 0},
        duration=1.0,
        unknowns={"k": 1.0},
        integrals=["x = 0.5"],
        where=["k = 5"],
    )
    s = p.solve()
    assert s.unknowns == {"k": 5.0} and len(s.integral_multipliers) == 1
    assert pickle.loads(pickle.dumps(s)).unknowns == s.unknowns
    assert isinstance(ex.load(SCENES / "kepler.toml").solve().unknowns, int)


def test_infinite_ends():
    p = ex.Problem("x'^2/2 + (1 - x^2)^2/4", start={"x": -1}, end={"x": 1}, duration="infinite")
    s = p.solve()
    rate = np.sqrt(2)
    assert s.rates == {"start": pytest.approx(rate), "end": pytest.approx(rate)}
    assert s.action == pytest.approx(2 * rate / 3, rel=1e-8)
    finite = p.solve_many(duration=[1.0, 2.0])
    assert finite.action == pytest.approx([p.replace(duration=t).solve().action for t in (1.0, 2.0)])


def test_ends_at_which_l_is_infinite():
    p = ex.load(SCENES / "brachistochrone.toml")
    s = p.solve()
    assert s.converged and len(s.momentum_start) == 0 and len(s.momentum_end) == len(p.coordinates)
    assert np.isnan(s.v(0.0)).all() and np.isnan(s.p(0.0)).all() and np.isfinite(s(0.0)).all()
    assert np.isfinite(s.v(s.duration / 2)).all() and repr(s)
    many = p.solve_many(duration=[s.duration, 1.5])
    assert many.converged.all() and many.momenta.mask[:, 0].all() and not many.momenta.mask[:, 1].any()


def test_a_spectrum():
    p = ex.Problem("x'^2/2 - x^2/2", start={"x": 1, "p_x": 0}, duration=60.0)
    assert p.solve().spectrum is None
    s = p.replace(spectrum={"lines": 1}).solve()
    assert s.spectrum["x"][0]["frequency"] == pytest.approx(1, rel=1e-6)
    assert s.spectrum["x"][0]["amplitude"] == pytest.approx(1, rel=1e-6) and s.flat_norm is None


def test_a_branch_is_drawn(tmp_path, arc):
    branch = arc.follow("duration", to=2.6, points=5)
    branch.plot(tmp_path / "b.svg")
    branch.plot(tmp_path / "x.svg", quantity="x(0)")
    assert (tmp_path / "b.svg").read_text().startswith("<?xml")
    with pytest.raises(ValueError, match="quantity"):
        branch.plot(tmp_path / "c.svg", quantity="x(0")


def test_columns_are_the_points(arc):
    """Many times at once give what one time gives."""
    s = arc.solve()
    t = np.linspace(0, s.duration, 300)
    for evaluate in (s.q, s.v, s.p):
        assert np.array_equal(evaluate(t), [evaluate(time) for time in t])

"""Problems: from keywords, functions, texts and files; what is refused."""

import inspect
import pickle
import tomllib

import extremal as ex
import numpy as np
import pytest
from conftest import KEPLER, SCENES

ENDS = {"start": {"x": 1, "y": 0}, "end": {"x": -0.6, "y": 0.9}, "duration": 2.5}


def test_keywords_write_the_scene(arc):
    assert ex.Problem.from_toml(arc.to_toml()).solve().action == arc.solve().action
    assert arc.coordinates == ("x", "y")
    assert 'lagrangian = "' + KEPLER + '"' in arc.to_toml()


def test_a_file_is_the_same_problem(arc):
    scene = ex.load(SCENES / "kepler.toml")
    assert scene.to_toml() == (SCENES / "kepler.toml").read_text()
    assert scene.title == "Transfer between two points of the plane"
    assert scene.solve().action == pytest.approx(arc.solve().action, rel=1e-9)


def test_every_scene_reads():
    scenes = sorted(SCENES.glob("*.toml"))
    assert len(scenes) > 50
    for scene in scenes:
        problem = ex.load(scene)
        again = problem.replace(title="another title")
        assert again.title == "another title" and again.coordinates == problem.coordinates, scene


def test_replace_changes_one_thing(arc):
    assert arc.replace(duration=3.0).solve().duration == 3.0
    assert arc.replace(title="An arc").title == "An arc"
    mu = arc.replace(lagrangian="(x'^2 + y'^2)/2 + mu/sqrt(x^2 + y^2)", parameters={"mu": 1.0})
    assert mu.solve().action == pytest.approx(arc.solve().action, rel=1e-9)
    assert mu.replace(parameters={"mu": np.float64(2)}).solve().action > mu.solve().action
    free = arc.replace(end={"x": -0.6})
    assert free.solve().momentum_end["y"] == pytest.approx(0, abs=1e-8)
    assert arc.to_toml() == ex.Problem(KEPLER, **ENDS).to_toml()


def test_values_of_numpy_and_names_in_quotes():
    chain = ex.Problem(
        "sum(i, 1, 3, q[i]'^2/2) - sum(i, 1, 2, k*(q[i+1] - q[i])^2/2)",
        coordinates=["q[3]"],
        parameters={"k": np.float32(2)},
        start={"q": np.array([0.0, 0.1, 0.2])},
        end={"q[1]": np.int64(1), "q[2]": 1.0, "q[3]": 1.0},
        duration=np.float64(1.5),
        title='with "quotes", \\ and \n lines',
    )
    assert chain.title == 'with "quotes", \\ and \n lines'
    solution = chain.solve()
    assert solution["q"].shape == (len(solution.t), 3)
    np.testing.assert_allclose(solution(1.5), [1, 1, 1], atol=1e-12)


@pytest.mark.parametrize(
    ("keys", "message", "line"),
    [
        ({"lagrangian": "x'^2/2 + coss(x)"}, "did you mean 'cos'", 3),
        ({"end": {"z": 1}}, "z", 7),
        ({"duration": -1.0}, "duration", 8),
        ({"tolerance": 2}, "tolerance = 2", 11),
        ({"tolerance": float("nan")}, "", 11),
        ({"scheme": "lobato(3)"}, "lobato", 11),
        ({"elements": 3}, "scheme", 11),
    ],
)
def test_errors_have_message_place_and_mend(keys, message, line):
    with pytest.raises(ex.SceneError) as error:
        ex.Problem(**({"lagrangian": KEPLER, "coordinates": ["x", "y"]} | ENDS | keys))
    assert message in error.value.message
    assert error.value.line == line and error.value.column >= 1
    assert str(error.value).startswith(f"problem:{line}:{error.value.column}: ")
    assert pickle.loads(pickle.dumps(error.value)).line == line


def test_errors_of_files_are_those_of_the_command():
    with pytest.raises(ex.SceneError, match="did you mean .*kepler.toml"):
        ex.load(SCENES / "keppler.toml")
    with pytest.raises(ex.SceneError, match="scene:1:"):
        ex.Problem.from_toml("duration == 3")
    with pytest.raises(ex.SceneError):
        ex.Problem.from_toml("")
    with pytest.raises(ex.SceneError):
        ex.Problem.from_toml("title = 'a\0b'")


def test_wrong_arguments():
    with pytest.raises(TypeError, match="did you mean 'duration'"):
        ex.Problem(KEPLER, start={"x": 1}, duratoin=2)
    with pytest.raises(TypeError, match="list of names"):
        ex.Problem(KEPLER, coordinates="xy", duration=1)
    with pytest.raises(TypeError, match="neither a number"):
        ex.Problem(KEPLER, duration=object())
    with pytest.raises(TypeError, match="length"):
        ex.Problem("q[1]'^2/2", duration=1)


def test_a_tolerance_is_a_number_of_adaptive_solves(arc):
    for keys, message in (
        ({"tolerance": "tight"}, "must be a number"),
        ({"tolerance": True}, "must be a number"),
        ({"tolerance": 1e-6, "scheme": "midpoint", "elements": 16}, "exclude"),
    ):
        with pytest.raises(ex.SceneError, match=message):
            arc.solve(**keys)
    assert arc.solve(tolerance=np.float32(1e-6)).converged


@pytest.mark.parametrize(
    "choice",
    [
        lambda x: 1 if x == 0 else 2,
        lambda x: 1 if x != 0 else 2,
        lambda x: 1 if x in (0, 1) else 2,
        lambda x: 1 if x > 0 else 2,
        lambda x: max(x, 0),
        lambda x: np.where(x >= 0, 1, 2),
    ],
)
def test_functions_that_choose_by_values_are_refused(choice):
    with pytest.raises(TypeError, match="cannot choose"):
        ex.Problem(lambda q, v, t: v[0] ** 2 / 2 - choice(q[0]), coordinates=["x"], duration=1.0)


def test_functions_of_numpy_on_symbols():
    def law(function):
        fixed = {"start": {"x": 0, "y": 0}, "end": {"x": 1, "y": 1}, "duration": 1.0}
        return tomllib.loads(ex.Problem(function, coordinates=["x", "y"], **fixed).to_toml())["system"]

    def plane(extra):
        return law(lambda q, v, t: v @ v / 2 - extra(q, v))["lagrangian"]

    assert plane(lambda q, v: np.cross(q, v)) == "(x'*x' + y'*y')/2 - (x*y' - y*x')"
    assert plane(lambda q, v: np.polyval([1, 2], q[0])) == "(x'*x' + y'*y')/2 - ((0*x + 1.0)*x + 2.0)"
    assert law(lambda q, v, t, m=3: m * v @ v / 2)["lagrangian"] == "(3*x'*x' + 3*y'*y')/2"
    with pytest.raises(TypeError, match="no function 'sign'; those .* sin"):
        plane(lambda q, v: np.sign(q[0]))
    with pytest.raises(AttributeError, match="no parameter 'k'"):
        law(lambda q, v, t, p: v @ v / 2 - p.k)


def test_a_force_of_one_coordinate_is_a_number():
    start = {"x": 0, "p_x": 1}
    problem = ex.Problem("x'^2/2", force=lambda q, v, t: -v[0], start=start, duration=2.0)
    assert problem.solve()(2.0)[0] == pytest.approx(1 - np.exp(-2), abs=1e-9)


def test_problems_do_not_change(arc):
    with pytest.raises(AttributeError):
        arc.title = "another"
    again = pickle.loads(pickle.dumps(arc))
    assert again.to_toml() == arc.to_toml()


class TestFunctions:
    """A function is traced into a formula, and gives the same trajectory."""

    def solved(self, law, **keys):
        return ex.Problem(law, **({"coordinates": ["x", "y"]} | ENDS | keys)).solve(tolerance=1e-11)

    @pytest.mark.parametrize(
        ("function", "formula"),
        [
            (lambda q, v, t: (v[0] ** 2 + v[1] ** 2) / 2 - 9.81 * q[1], "(x'^2 + y'^2)/2 - 9.81*y"),
            (lambda q, v, t: v @ v / 2 + 1 / np.linalg.norm(q), KEPLER),
            (lambda q, v, t: np.sum(v**2) / 2 + 1 / np.hypot(*q), KEPLER),
            (lambda q, v, t: np.dot(v, v) / 2 - np.cos(q).sum(), "(x'^2 + y'^2)/2 - cos(x) - cos(y)"),
            (lambda q, v, t: sum(v**2) / 2 + 0.1 * np.sin(t) * q[0], "(x'^2 + y'^2)/2 + 0.1*sin(t)*x"),
            (
                lambda q, v, t: v @ v / 2 - np.exp(-(q[0] ** 2)) * 2 ** (q[1] / 9),
                "(x'^2+y'^2)/2 - exp(-x^2)*2^(y/9)",
            ),
            (
                lambda q, v, t: v @ v / 2 - -q[0] ** 2 / (9 - (q[1] - q[0])),
                "(x'^2+y'^2)/2 + x^2/(9 - (y - x))",
            ),
            (
                lambda q, v, t: v @ v / 2 - abs(q[0]) ** 3 - np.arctan2(q[1], 2),
                "(x'^2+y'^2)/2 - abs(x)^3 - atan2(y, 2)",
            ),
        ],
    )
    def test_same_as_the_formula(self, function, formula):
        traced, written = self.solved(function), self.solved(formula)
        assert traced.converged and written.converged
        assert traced.action == pytest.approx(written.action, rel=1e-10, abs=1e-10)

    def test_is_called_once(self):
        calls = []

        def law(q, v, t):
            calls.append(q)
            return v @ v / 2

        problem = ex.Problem(law, coordinates=["x", "y"], **ENDS)
        problem.solve()
        assert len(calls) == 1 and calls[0].shape == (2,)

    def test_with_parameters_that_can_be_continued(self):
        def law(q, v, t, p):
            return v @ v / 2 + p.m[0] * p.m[1] / np.sqrt(q @ q) + p.mu * q[0]

        problem = ex.Problem(law, coordinates=["x", "y"], parameters={"m": [1.0, 2.0], "mu": 0.1}, **ENDS)
        formula = ex.Problem("(x'^2 + y'^2)/2 + 2/sqrt(x^2 + y^2) + 0.1*x", coordinates=["x", "y"], **ENDS)
        assert problem.solve().action == pytest.approx(formula.solve().action, rel=1e-9)
        assert len(problem.follow("mu", to=0.2, points=5)) >= 2

    def test_what_is_used_often_is_written_once(self):
        def law(q, v, t):
            u = q[0] * q[1] + 1
            for _ in range(60):  # written out, the text would have 2^60 names
                u = u * u / 2
            return v @ v / 2 - 1e-9 * np.sin(u)

        problem = ex.Problem(law, coordinates=["x", "y"], **ENDS)
        assert len(problem.to_toml()) < 4000

    def test_hamiltonians_and_forces(self):
        def energy(q, p, t):
            return p @ p / 2 - 1 / np.sqrt(q @ q)

        hamiltonian = ex.Problem(hamiltonian=energy, coordinates=["x", "y"], **ENDS).solve()
        assert hamiltonian.action == pytest.approx(self.solved(KEPLER).action, rel=1e-9)

        def drag(q, v, t):
            return -0.1 * v

        forced = ex.Problem(KEPLER, force=drag, coordinates=["x", "y"], **ENDS).solve()
        written = ex.Problem(KEPLER, force={"x": "-0.1*x'", "y": "-0.1*y'"}, **ENDS).solve()
        assert forced.work == pytest.approx(written.work, rel=1e-8) and forced.work < 0

    def test_arrays(self):
        def chain(q, v, t):
            return v @ v / 2 - np.sum(np.diff(q) ** 2) / 2

        problem = ex.Problem(chain, coordinates=["q[4]"], start={"q": "0.1*i"}, end={"q": "1"}, duration=1)
        written = ex.Problem(
            "sum(i, 1, 4, q[i]'^2/2) - sum(i, 1, 3, (q[i+1] - q[i])^2/2)",
            coordinates=["q[4]"],
            start={"q": "0.1*i"},
            end={"q": "1"},
            duration=1,
        )
        assert problem.solve().action == pytest.approx(written.solve().action, rel=1e-9)

    @pytest.mark.parametrize(
        ("law", "error"),
        [
            (lambda q, v, t: v @ v / 2 if q[0] > 0 else 0, TypeError),
            (lambda q, v, t: v @ v / 2 + float(q[0]), TypeError),
            (lambda q, v, t: v @ v / 2 + np.nan, ValueError),
            (lambda q, v, t: v @ v / 2 + 1j, TypeError),
            (lambda q, v, t: np.cbrt(q[0]), TypeError),
            (lambda q, v, t: v, TypeError),
            (lambda q, v, t: "x", TypeError),
        ],
    )
    def test_what_is_no_formula_is_refused(self, law, error):
        with pytest.raises(error):
            ex.Problem(law, coordinates=["x", "y"], **ENDS)


def test_all_that_is_public_has_a_docstring():
    for name in ex.__all__:
        public = getattr(ex, name)
        if not callable(public):
            continue
        assert inspect.getdoc(public), name
        members = [m for m in vars(public) if not m.startswith("_")] if inspect.isclass(public) else []
        for member in members:
            value = inspect.getattr_static(public, member)
            if isinstance(value, property) or inspect.isroutine(value):
                assert value.__doc__, f"{name}.{member}"

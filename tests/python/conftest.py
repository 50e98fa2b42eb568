"""Problems that several tests use."""

import pathlib

import extremal as ex
import pytest

SCENES = pathlib.Path(__file__).parents[2] / "problems/scenes"
KEPLER = "(x'^2 + y'^2)/2 + 1/sqrt(x^2 + y^2)"


@pytest.fixture
def arc() -> ex.Problem:
    """Lambert's problem in the plane. Its velocity at the start, 0.0986855516302332 and 0.9978231699793557,
    is known from shooting with 113 bits."""
    return ex.Problem(KEPLER, start={"x": 1, "y": 0}, end={"x": -0.6, "y": 0.9}, duration=2.5)


@pytest.fixture
def long_solve() -> ex.Problem:
    """One that takes minutes: a search for more motions of a chaotic system than there is time for."""
    return ex.load(SCENES / "double-pendulum.toml").replace(
        duration=40.0, search={"solutions": 200}, budget=300.0, continuation=None
    )


@pytest.fixture
def command() -> pathlib.Path:
    """The program that was built beside the module."""
    return pathlib.Path(ex.__file__).parents[2] / "extremal"

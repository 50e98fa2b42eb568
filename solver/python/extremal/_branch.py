"""Branches: families of solutions as arrays."""

from __future__ import annotations

import json
import operator
import os
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._many import known
from ._solution import Picture, Solution, drawn

if TYPE_CHECKING:
    from ._problem import Problem

Array = npt.NDArray[Any]


class Branch:
    """A family of m solutions, and the branches that bifurcate from it where they were asked for. Immutable.

    `branch[k]` is the solution of a point. Attributes are arrays with an entry for each point; numbers that
    are not known of some points are masked.
    """

    __slots__ = ("_problem", "_study", "_followed", "_table")
    _problem: Problem
    _study: _core.Study
    _followed: _core.FollowedBranch
    _table: dict[str, Any]

    def __init__(self) -> None:
        raise TypeError("branches come from Problem.follow()")

    @classmethod
    def _made(cls, problem: Problem, study: _core.Study, followed: _core.FollowedBranch) -> Branch:
        branch = cls.__new__(cls)
        put = object.__setattr__
        put(branch, "_problem", problem)
        put(branch, "_study", study)
        put(branch, "_followed", followed)
        put(branch, "_table", json.loads(followed.json()))
        return branch

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError("a branch does not change")

    @property
    def status(self) -> str:
        """Of the branch that was asked for: "converged", or why it ended early."""
        return str(self._table["status"])

    @property
    def message(self) -> str:
        """Why it ended."""
        return str(self._table["message"])

    @property
    def name(self) -> str:
        """What varies: "duration", "energy" or a parameter."""
        return self._followed.parameter

    def _column(self, key: str, dtype: Any) -> Array:
        entries = [point[key] for point in self._table["points"]]
        missing = np.array([entry is None for entry in entries], dtype=bool)
        return known(np.array([0 if entry is None else entry for entry in entries], dtype=dtype), missing)

    @property
    def branch(self) -> Array:
        """Number of the branch of each point; 0 is the one that was asked for."""
        return self._column("branch", int)

    @property
    def parameter(self) -> Array:
        """Values of what varies, (m,)."""
        return self._column("parameter", float)

    @property
    def duration(self) -> Array:
        """T of each solution, (m,)."""
        return self._column("duration", float)

    @property
    def energy(self) -> Array:
        """Energies, (m,)."""
        return self._column("energy", float)

    @property
    def action(self) -> Array:
        """Actions, (m,)."""
        return self._column("action", float)

    @property
    def index(self) -> Array:
        """Morse indices, (m,)."""
        return self._column("morse_index", int)

    @property
    def nullity(self) -> Array:
        """Null directions, (m,)."""
        return self._column("nullity", int)

    @property
    def kind(self) -> Array:
        """Of each point: "regular", "fold", "branch" or "period-doubling", (m,)."""
        return self._column("kind", str)

    @property
    def multipliers(self) -> Array | None:
        """Floquet multipliers of periodic orbits, (m, 2n); else None."""
        values = [point["multipliers"] for point in self._table["points"]]
        shape = next((np.shape(value) for value in values if value is not None), None)
        if shape is None:
            return None
        missing = np.array([value is None for value in values])
        pairs = np.array([np.zeros(shape) if value is None else value for value in values])
        return known(pairs[..., 0] + 1j * pairs[..., 1], missing)

    @property
    def q(self) -> Array:
        """Positions at t = 0, (m, n)."""
        return self._followed.q()

    @property
    def v(self) -> Array:
        """Velocities at t = 0, (m, n)."""
        return self._followed.v()

    def __len__(self) -> int:
        return len(self._followed)

    def __getitem__(self, k: int) -> Solution:
        """The solution of a point."""
        count, k = len(self), operator.index(k)
        if not -count <= k < count:
            raise IndexError(f"the branch has {count} points")
        k %= count
        value = self._table["points"][k]["parameter"]
        changes = (
            {self.name: value} if self.name in ("duration", "energy") else {"parameters": {self.name: value}}
        )
        problem = self._problem.replace(continuation=None, **changes)
        return Solution._made(problem, self._followed.solved(k, problem._study))

    def __iter__(self) -> Iterator[Solution]:
        return (self[k] for k in range(len(self)))

    def to_dict(self) -> dict[str, Any]:
        """The branch as `extremal continue --output` writes it."""
        table: dict[str, Any] = json.loads(self._followed.json())
        return table

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes it as .json or .csv, by the ending of the path."""
        name = os.fspath(path)
        if not name.endswith((".json", ".csv")):
            raise ValueError(f"'{name}' ends neither in .json nor in .csv")
        text = self._followed.json() if name.endswith(".json") else self._followed.csv()
        _core.write(name, text.encode())

    def plot(self, path: str | os.PathLike[str] | None = None, *, quantity: str = "") -> Picture | None:
        """Draws the diagram: by gnuplot into a file .svg, .png or .pdf, or as a picture for a notebook; into a
        file .html as an interactive page, with the orbits.
        `quantity` is a formula of what is drawn upwards, as "x(0)"."""
        return drawn(lambda name: self._followed.plot(self._study, name, quantity), path)

    def _repr_svg_(self) -> str | None:
        try:
            picture = self.plot() if len(self) else None
        except RuntimeError:  # there is no gnuplot
            return None
        return picture.svg if picture else None

    def __repr__(self) -> str:
        return self._followed.summary().rstrip("\n") if len(self) else f"{self.status}: {self.message}"

    def __copy__(self) -> Branch:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Branch:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self._problem, self._followed.state())


def _restored(problem: Problem, state: tuple[Any, ...]) -> Branch:
    study = _core.Study(problem._text, problem._name, True)
    return Branch._made(problem, study, _core.restored_branch(state))

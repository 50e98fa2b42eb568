"""Solutions: whole trajectories with what is known of them."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._many import reals

if TYPE_CHECKING:
    from ._problem import Problem

Array = npt.NDArray[np.float64]


class Named(Mapping[str, float]):
    """Numbers by the names of the coordinates; numpy.asarray gives them as an array of n that cannot be
    written."""

    __slots__ = ("_names", "_values")

    def __init__(self, names: list[str], values: Array) -> None:
        self._names = names
        self._values = values

    def __getitem__(self, name: str) -> float:
        try:
            return float(self._values[self._names.index(name)])
        except ValueError:
            raise KeyError(name) from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __array__(self, dtype: npt.DTypeLike = None) -> Array:
        return self._values if dtype is None else self._values.astype(dtype)

    def __repr__(self) -> str:
        return repr(dict(self))


@dataclass(frozen=True)
class Fit:
    """What observations determine.

    parameters, open_ends: what was fitted, by name.
    covariance: of the parameters in their order, then of the open ends, (k, k).
    chi_squared, freedom: the sum that is least, and values observed less unknowns.
    residuals: of each observed column its times and observed − computed, (2, m).
    """

    parameters: Named
    open_ends: Named
    covariance: Array
    chi_squared: float
    freedom: int
    residuals: Mapping[str, Array]


class Picture:
    """A drawing, shown by notebooks; `svg` is its text."""

    def __init__(self, svg: str) -> None:
        self.svg = svg

    def _repr_svg_(self) -> str:
        return self.svg

    def __repr__(self) -> str:
        return f"<Picture, {len(self.svg)} bytes of SVG>"


def drawn(draw: Any, path: str | os.PathLike[str] | None) -> Picture | None:
    """What draw(path) draws: as a picture, or into a file."""
    if path is None:
        return Picture(draw("picture.svg").decode())
    _core.write(os.fspath(path), draw(os.fspath(path)))
    return None


class Solution:
    """A trajectory q(t) on [0, T], n coordinates, in the units of the problem. Immutable.

    Where `converged` is false, `status` and `message` say why, there is no trajectory, and numbers of one are
    None. Arrays cannot be written; they are views of the solution's own memory and keep it alive.

    >>> s(1.3)                      # q(1.3), (n,)
    >>> s(np.linspace(0, s.duration, 100))  # (100, n)
    >>> s.x, s["x'"], s["p_x"]      # at the times s.t of all nodes
    """

    __slots__ = ("_problem", "_solved", "_all", "_t", "__weakref__")
    _problem: Problem
    _solved: _core.Solved
    _all: tuple[Solution, ...]
    _t: Array | None

    def __init__(self) -> None:
        raise TypeError("solutions come from Problem.solve()")

    @classmethod
    def _made(cls, problem: Problem, solved: _core.Solved, found: tuple[Solution, ...] = ()) -> Solution:
        solution = cls.__new__(cls)
        put = object.__setattr__
        put(solution, "_problem", problem)
        put(solution, "_solved", solved)
        put(solution, "_all", found)
        put(solution, "_t", None)
        return solution

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError("a solution does not change")

    def __delattr__(self, name: str) -> None:
        self.__setattr__(name, None)

    @property
    def problem(self) -> Problem:
        """What it solves."""
        return self._problem

    @property
    def solutions(self) -> tuple[Solution, ...]:
        """All that a search found, by their actions; else this one alone."""
        return self._all or (self,)

    @property
    def status(self) -> str:
        """Either "converged", or why not: "collision", "no-solution-near", …"""
        return self._solved.status

    @property
    def message(self) -> str:
        """Where, why and what to try, in words."""
        return self._solved.message

    @property
    def converged(self) -> bool:
        """Whether the tolerance is met."""
        return self._solved.converged

    @property
    def strategy(self) -> str:
        """What led to it."""
        return self._solved.strategy

    @property
    def action(self) -> float | None:
        """∫ L dt."""
        return self._known(self._solved.action)

    @property
    def duration(self) -> float | None:
        """T."""
        return self._known(self._solved.duration)

    @property
    def energy(self) -> float | None:
        """p·q' − L at t = 0; None where L depends on t."""
        return self._solved.energy

    @property
    def energy_drift(self) -> float | None:
        """Largest change of the energy along the path."""
        return self._solved.energy_drift

    @property
    def work(self) -> float | None:
        """∫ F·q' dt of the forces; None without forces."""
        return self._solved.work

    @property
    def error_estimate(self) -> float | None:
        """Largest error of q(t), in units of q."""
        return self._known(self._solved.error_estimate)

    @property
    def residual(self) -> float | None:
        """Largest component of the discrete equations, divided by the largest momentum."""
        return self._known(self._solved.residual)

    @property
    def index(self) -> int | None:
        """Morse index of the second variation; None where there is none."""
        return self._solved.morse_index

    morse_index = index

    @property
    def nullity(self) -> int | None:
        """Null directions of the second variation, symmetries included."""
        return self._solved.nullity

    @property
    def minimizing(self) -> bool | None:
        """Whether the action has a local minimum, but for symmetries; None without an index."""
        return self._solved.minimizing if self.index is not None else None

    @property
    def certificate(self) -> str:
        """What is known of the windows: "none", "sampled" or "global"."""
        return self._solved.certificate

    def _known(self, value: float) -> float | None:
        """A number that a path has; None where there is none."""
        return value if self.converged else None

    @property
    def windows(self) -> Array | None:
        """(k, 2): times between which the path minimises with its ends fixed; None where there are none."""
        return self._solved.windows

    @property
    def conjugate_times(self) -> Array | None:
        """Times conjugate to 0, in (0, T), repeated by multiplicity; None where they are not known."""
        return self._solved.conjugate_times

    @property
    def momentum_start(self) -> Named:
        """Canonical momenta at t = 0 by name; empty where L is infinite there."""
        return self._momenta(self._solved.momentum_start)

    @property
    def momentum_end(self) -> Named:
        """Canonical momenta at t = T by name; empty where L is infinite there."""
        return self._momenta(self._solved.momentum_end)

    def _momenta(self, values: Array) -> Named:
        return Named(self._solved.names if len(values) else [], values)

    def _field(self, name: str) -> Any:
        """A field of the result as `--output` writes it; None where it has none."""
        return json.loads(_core.json([self._solved], [None], False)).get(name)

    @property
    def multipliers(self) -> npt.NDArray[np.complex128] | None:
        """Floquet multipliers of a periodic orbit, (2n,), largest modulus first; else None."""
        return self._solved.multipliers

    @property
    def krein(self) -> npt.NDArray[np.intc] | None:
        """Krein signs beside the multipliers."""
        return self._solved.krein

    @property
    def fit(self) -> Fit | None:
        """What the observations of a table [fit] determine; None without one."""
        found = self._solved.fit
        if found is None:
            return None
        parameters, open_ends, values, covariance, chi_squared, freedom, residuals = found
        numbers = np.array(values)
        numbers.setflags(write=False)
        count = len(parameters)
        return Fit(
            Named(parameters, numbers[:count]),
            Named(open_ends, numbers[count:]),
            covariance,
            chi_squared,
            freedom,
            MappingProxyType(residuals),
        )

    @property
    def symplectic_defect(self) -> float | None:
        """How far the flow of a periodic orbit is from a symplectic one; None without multipliers."""
        defect: float | None = self._field("symplectic_defect")
        return defect

    @property
    def rates(self) -> dict[str, float] | None:
        """Slowest rates of decay at infinite ends, "start" and "end"; None without such ends."""
        rates: dict[str, float] | None = self._field("rates")
        return rates

    @property
    def integral_multipliers(self) -> list[float] | None:
        """ν of L + Σ ν (integrand), in the order of `integrals`; None without them."""
        multipliers: list[float] | None = self._field("integral_multipliers")
        return multipliers

    @property
    def waypoints(self) -> list[dict[str, Any]] | None:
        """Of each waypoint its time "t" and, by name, the "impulse": momentum after it less that before."""
        waypoints: list[dict[str, Any]] | None = self._field("waypoints")
        return waypoints

    @property
    def contacts(self) -> list[dict[str, float]] | None:
        """When inequalities of `path` are equalities: "constraint", counted from 0, "from" and "to"."""
        contacts: list[dict[str, float]] | None = self._field("contacts")
        return contacts

    @property
    def spectrum(self) -> dict[str, list[dict[str, float]]] | None:
        """Lines of each coordinate, "frequency", "amplitude" and "phase", by falling amplitude; None without
        a table `spectrum` in the problem."""
        spectrum: dict[str, list[dict[str, float]]] | None = self._field("spectrum")
        return spectrum

    @property
    def flat_norm(self) -> dict[str, float] | None:
        """Of each coordinate the distance of its spectrum from that of `spectrum.against`."""
        norm: dict[str, float] | None = self._field("flat_norm")
        return norm

    @property
    def minimal_period(self) -> float | None:
        """Of a path that closes: T, or a part of it."""
        return self._solved.minimal_period

    @property
    def elements(self) -> int:
        """Number N of elements."""
        return self._solved.elements

    @property
    def degree(self) -> int:
        """Degree of the elements that were solved for."""
        return self._solved.degree

    @property
    def unknowns(self) -> int | dict[str, float]:
        """Constants that were asked for, by name; elsewhere how many numbers were solved for."""
        found: int | dict[str, float] = self._field("unknowns")
        return found

    @property
    def iterations(self) -> int:
        """Steps of Newton's method."""
        return self._solved.iterations

    @property
    def history(self) -> list[_core.Iteration]:
        """The steps: elements, degree, residual, step and damping of each."""
        return self._solved.history

    @property
    def seconds(self) -> dict[str, float]:
        """Time taken by `solve` and `analyse`, s."""
        return {"solve": self._solved.seconds_solve, "analyse": self._solved.seconds_analyse}

    @property
    def mesh(self) -> Array:
        """Times of the ends of the elements, (N + 1,)."""
        return self._solved.times

    @property
    def nodes(self) -> Array | None:
        """Values at the Lobatto nodes of each element, (N, s + 1, n); None if there is no trajectory."""
        return self._solved.nodes if self.converged else None

    @property
    def t(self) -> Array:
        """Times of all nodes, from 0 to T, (m,)."""
        if self._t is None:
            self._require()
            object.__setattr__(self, "_t", self._solved.node_times)
        assert self._t is not None
        return self._t

    def _require(self) -> None:
        if not self.converged:
            raise ValueError(f"there is no trajectory: {self.status}: {self.message}")

    def _at(self, t: npt.ArrayLike, evaluate: Any) -> Array:
        self._require()
        times = reals(t, "t")
        values: Array = evaluate(times.ravel())
        return values.reshape(times.shape + values.shape[1:])

    def __call__(self, t: npt.ArrayLike) -> Array:
        """q(t): (n,) at one time, (m, n) at m. Raises ValueError outside of [0, T]."""
        return self._at(t, self._solved.q)

    def q(self, t: npt.ArrayLike) -> Array:
        """Positions q(t): (n,) at one time, (m, n) at m."""
        return self._at(t, self._solved.q)

    def v(self, t: npt.ArrayLike) -> Array:
        """Velocities q'(t), likewise; NaN at an end where L is infinite."""
        return self._at(t, self._solved.v)

    def p(self, t: npt.ArrayLike) -> Array:
        """Canonical momenta ∂L/∂q'(t), likewise; NaN at an end where L is infinite."""
        return self._at(t, self._solved.p)

    def constraint_forces(self, t: npt.ArrayLike) -> Array | None:
        """λ of d/dt ∂L/∂q' − ∂L/∂q = Σ λ_k ∂g_k/∂q: (k,) at one time, (m, k) at m; None without constraints."""
        return self._forces(t, self._solved.constraint_forces)

    def path_forces(self, t: npt.ArrayLike) -> Array | None:
        """μ >= 0 of the inequalities of `path`, likewise; None without them."""
        return self._forces(t, self._solved.path_forces)

    def _forces(self, t: npt.ArrayLike, evaluate: Any) -> Array | None:
        self._require()
        if evaluate(np.zeros(1)) is None:
            return None
        return self._at(t, evaluate)

    def __getitem__(self, name: str) -> Array:
        """Values of "x", "x'" or "p_x" at the times `t`: (m,), of an array of k coordinates (m, k)."""
        if not isinstance(name, str):
            raise TypeError(f"a solution has no element {name!r}; s(t) is q(t), s[\"x\"] a coordinate at s.t")
        evaluate, wanted = self._solved.q, name
        if name.endswith("'"):
            evaluate, wanted = self._solved.v, name[:-1]
        elif name.startswith("p_") and self._columns(name) is None:
            evaluate, wanted = self._solved.p, name[2:]
        columns = self._columns(wanted)
        if columns is None:
            raise KeyError(
                f"there is no coordinate '{wanted}'; the problem has {', '.join(self._solved.names[:20])}"
            )
        values = self._at(self.t, evaluate)[:, columns]
        values.setflags(write=False)
        return values

    __iter__ = None

    def _columns(self, name: str) -> int | slice | None:
        for coordinate, first, count, array in self._problem._study.coordinates:
            if name == coordinate:
                return slice(first, first + count) if array else first
        names = self._solved.names
        return names.index(name) if name in names else None

    def __getattr__(self, name: str) -> Array:
        if name.startswith("_") or self._columns(name) is None:
            raise AttributeError(f"a solution has no '{name}'", name=name, obj=self)
        return self[name]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *(name for name, *_ in self._problem._study.coordinates)]

    def to_dict(self, samples: int | npt.ArrayLike | None = None) -> dict[str, Any]:
        """The result as `--output` writes it, with so many equal samples, or samples at these times."""
        times = [solution._times(samples) for solution in self.solutions]
        result: dict[str, Any] = json.loads(_core.json(self._every(), times, bool(self._all)))
        return result

    def _every(self) -> list[_core.Solved]:
        return [solution._solved for solution in self.solutions]

    def _times(self, samples: int | npt.ArrayLike | None) -> Array | None:
        if samples is None or not self.converged:
            return None
        if isinstance(samples, (int, np.integer)):
            if samples < 2:
                raise ValueError(f"samples = {samples}; need at least 2")
            # Rounded as those of the command, so that files are the same.
            duration = self._solved.duration
            times = duration * np.arange(samples) / (samples - 1)
            times[-1] = duration
            return times
        given = reals(samples, "samples")
        if given.ndim > 1:
            raise ValueError(f"samples has the shape {given.shape}; need a number of samples, or times (m,)")
        return given

    def _rows(self, samples: int | npt.ArrayLike | None) -> Array:
        """Times of samples, where nothing else is written; None: those of the nodes."""
        times = self.t if samples is None else self._times(samples)
        self._require()
        assert times is not None
        return times

    def save(self, path: str | os.PathLike[str], samples: int | npt.ArrayLike | None = 201) -> None:
        """Writes the result with samples as .json, or the samples alone as .csv, .npz or .oem (with the
        table `units`), by the ending of the path; of a search all solutions as .json and .csv. A file is
        written whole or not at all."""
        name = os.fsdecode(path)
        times: list[Array | None]
        if name.endswith(".json"):
            times = [solution._times(samples) for solution in self.solutions]
        elif name.endswith((".csv", ".npz", ".oem")):
            times = [solution._rows(samples) for solution in self.solutions]
        else:
            raise ValueError(f"'{name}' ends neither in .json nor in .csv, .npz or .oem")
        _core.save(name, self._every(), times, bool(self._all))

    def plot(self, path: str | os.PathLike[str] | None = None) -> Picture | None:
        """Draws the trajectory, of a search all of them: by gnuplot into a file .svg, .png or .pdf, or as a
        picture for a notebook; into a file .html as an interactive page."""
        return drawn(lambda name: _core.plot(name, self._every()), path)

    def _repr_svg_(self) -> str | None:
        try:
            picture = self.plot() if self.converged else None
        except RuntimeError:  # there is no gnuplot
            return None
        return picture.svg if picture else None

    def __repr__(self) -> str:
        return self._solved.summary().rstrip("\n")

    def __copy__(self) -> Solution:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Solution:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self._problem, self._solved.state(), self._all)


def _restored(problem: Problem, state: tuple[Any, ...], found: tuple[Solution, ...]) -> Solution:
    return Solution._made(problem, _core.restored(problem._study, state), found)

"""Problems: scenes that Python writes, reads, changes and solves."""

from __future__ import annotations

import difflib
import inspect
import os
import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from numbers import Real
from typing import Any, overload

import numpy as np
import numpy.typing as npt

from . import _core, _toml, _trace
from ._branch import Branch
from ._errors import NotConverged
from ._many import Solutions, reals
from ._solution import Solution

Progress = Callable[[Any], object]
Law = str | Callable[..., Any]

# A key that several tables have belongs to the first of them.
TABLES = ("system", "boundary", "solve")
VELOCITY = re.compile(r"([A-Za-z_]\w*)(\[[^\]]*\])?'")
# What a scene adds to, where it is changed; other values are replaced.
ADDED = ("parameters", "definitions")


def _places() -> dict[str, str]:
    """Of each keyword the table that it is written in; "" for tables and keys of the scene itself."""
    keys = _core.keys()
    places = {name: "" for table, name, _ in keys if table == "" and name not in TABLES}
    for table in TABLES:
        for other, name, _ in keys:
            if other == table and name != "*":
                places.setdefault(name, table)
    return places


PLACES = _places()


def _insert(tables: dict[str, Any], keys: Mapping[str, Any]) -> None:
    """Writes keywords into the tables of a scene; None removes."""
    for name, value in keys.items():
        if name not in PLACES:
            near = difflib.get_close_matches(name, PLACES, 1)
            raise TypeError(f"a problem has no '{name}'" + (f"; did you mean '{near[0]}'?" if near else ""))
        table = tables.setdefault(PLACES[name], {}) if PLACES[name] else tables
        if value is None:
            table.pop(name, None)
        elif name in ADDED:
            table.setdefault(name, {}).update(value)
        else:
            table[name] = value


def _inferred(law: Law, ends: Sequence[Any], definitions: Mapping[str, Any]) -> list[str]:
    """Names of the coordinates, where they are not given: those with velocities in the formula, then those
    with values at the ends."""
    names: dict[str, None] = {}
    if isinstance(law, str):
        for name, index in VELOCITY.findall(law):
            if index:
                raise TypeError(f"'{name}' is an array; give coordinates=['{name}[n]'] with its length")
            if name not in definitions:
                names[name] = None
    for end in ends:
        if isinstance(end, Mapping):
            names.update((name, None) for name in end if not name.startswith("p_"))
    if not names:
        raise TypeError("the coordinates are not known; give coordinates=['x', …]")
    return list(names)


def _length(text: str, parameters: Mapping[str, Any]) -> int:
    """The n of a coordinate "q[n]"."""
    if text.isdigit():
        return int(text)
    value = _toml.plain(parameters.get(text))
    if not isinstance(value, (int, float)):
        raise TypeError(
            f"the length '{text}' of an array must be a number, or a parameter that is one, for a function"
        )
    return int(value)


def _elements(coordinates: Sequence[str], parameters: Mapping[str, Any]) -> list[list[str]]:
    """Of each coordinate the names of its elements."""
    elements = []
    for coordinate in coordinates:
        name, _, rest = coordinate.partition("[")
        count = _length(rest.rstrip("]").strip(), parameters) if rest else 0
        elements.append([f"{name}[{i}]" for i in range(1, count + 1)] if rest else [name])
    return elements


class _Parameters:
    """The parameters that a traced function may use, as attributes: symbols, of lists arrays of symbols."""

    def __init__(self, parameters: Mapping[str, Any]) -> None:
        for name, value in parameters.items():
            value = _toml.plain(value)
            if isinstance(value, (list, tuple)):
                array = np.array(
                    [_trace.name_symbol(f"{name}[{i + 1}]") for i in range(len(value))], dtype=object
                )
                setattr(self, name, array)
            else:
                setattr(self, name, _trace.name_symbol(name))

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(f"there is no parameter '{name}'; give parameters=dict({name}=…)")


def _takes_parameters(function: Callable[..., Any]) -> bool:
    """Whether it has a fourth argument that must be given."""
    arguments = inspect.signature(function).parameters.values()
    variable = inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD
    return sum(a.default is a.empty and a.kind not in variable for a in arguments) == 4


def _traced(keys: dict[str, Any]) -> dict[str, Any]:
    """Keywords with formulas in place of functions."""
    laws = [name for name in ("lagrangian", "hamiltonian", "force") if callable(keys.get(name))]
    if not laws:
        return keys
    parameters = keys.get("parameters") or {}
    blocks = _elements(keys["coordinates"], parameters)
    names = [name for block in blocks for name in block]
    symbols = {
        "q": np.array([_trace.name_symbol(name) for name in names], dtype=object),
        "v": np.array([_trace.name_symbol(name + "'") for name in names], dtype=object),
        "p": np.array([_trace.name_symbol("p_" + name) for name in names], dtype=object),
    }
    definitions = dict(keys.get("definitions") or {})
    taken = {name.partition("[")[0] for name in names} | set(parameters)
    result = dict(keys)
    for law in laws:
        function = keys[law]
        arguments = [symbols["q"], symbols["p" if law == "hamiltonian" else "v"], _trace.name_symbol("t")]
        if _takes_parameters(function):
            arguments.append(_Parameters(parameters))
        value = function(*arguments)
        values = list(np.atleast_1d(np.asarray(value, dtype=object))) if law == "force" else [value]
        if law == "force" and len(values) != len(names):
            raise ValueError(f"force returned {len(values)} components for {len(names)} coordinates")
        texts = _trace.Formulas(values, definitions, taken).texts
        if law == "force":
            forces: dict[str, Any] = {}
            for block in blocks:
                own, texts = texts[: len(block)], texts[len(block) :]
                name, bracket, _ = block[0].partition("[")
                forces[name] = own if bracket else own[0]
            result[law] = forces
        else:
            result[law] = texts[0]
    if definitions:
        result["definitions"] = definitions
    return result


class Problem:
    """A mechanical problem: a law of motion, conditions at the ends, a duration. Immutable.

    Args:
        lagrangian: formula of L in coordinates `x`, velocities `x'` and `t`; or a function L(q, v, t) of
            arrays with n symbols, which is called once. A function of four arguments gets the parameters as
            attributes of the last one, and may then be continued in them.
        coordinates: names, `"x"` or `"q[32]"` for an array. Left out, those whose velocities the formula
            has, or those with values at the ends.
        use: instead of both: name of a system file.
        start, end: values q(0) and q(T) by name; what is left out gets its natural condition. `p_x` gives a
            momentum.
        duration: T, or `"free"` with `energy` or `where`.
        keys: all other keys of a scene, in units of the user's own: `parameters`, `definitions`,
            `hamiltonian` (also a function of q, p, t), `force` (also a function of q, v, t), `periodic`,
            `map`, `conditions`, `where`, `energy`, `tolerance`, `scheme`, `elements`, `method`, `budget`,
            `title`; and whole tables as dicts, `guess` and `continuation` among them.

    Raises:
        SceneError: for what a scene would be refused for, with message, place and mend.
    """

    __slots__ = ("_text", "_name", "_study")
    _text: str
    _name: str
    _study: _core.Study

    def __init__(
        self,
        lagrangian: Law | None = None,
        *,
        coordinates: Sequence[str] | None = None,
        use: str | None = None,
        start: Mapping[str, Any] | None = None,
        end: Mapping[str, Any] | None = None,
        duration: float | str | None = None,
        **keys: Any,
    ) -> None:
        if isinstance(coordinates, str):
            raise TypeError(f"coordinates = {coordinates!r}; give a list of names")
        keys |= {"lagrangian": lagrangian, "use": use, "start": start, "end": end, "duration": duration}
        law = lagrangian or keys.get("hamiltonian")
        if coordinates is None and use is None and law is not None:
            coordinates = _inferred(law, [start, end], keys.get("definitions") or {})
        keys = {"coordinates": None if coordinates is None else list(coordinates)} | keys
        tables: dict[str, Any] = {}
        _insert(tables, _traced({name: value for name, value in keys.items() if value is not None}))
        # Tables in the order of the reference.
        order = {name: tables[name] for name in ("title", "system", "boundary") if name in tables}
        self._read(_toml.dumps(order | tables), "problem")

    def _read(self, text: str, name: str) -> None:
        object.__setattr__(self, "_text", text)
        object.__setattr__(self, "_name", name)
        object.__setattr__(self, "_study", _core.Study(text, name))

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError("a problem does not change; replace() makes another one")

    def __delattr__(self, name: str) -> None:
        self.__setattr__(name, None)

    @classmethod
    def from_toml(cls, text: str, name: str = "scene") -> Problem:
        """The problem of a scene's text. Files that it names are looked up beside `name`, as if that were
        its path."""
        problem = cls.__new__(cls)
        problem._read(text, os.fspath(name))
        return problem

    def to_toml(self) -> str:
        """The scene as text; `extremal solve` takes it as a file."""
        return self._text

    def replace(self, **changes: Any) -> Problem:
        """The problem with other values of the keywords of Problem(); None takes one away. `parameters` and
        `definitions` are added to those there."""
        return self.from_toml(self._changed(changes), self._beside())

    def _changed(self, changes: Mapping[str, Any]) -> str:
        tables = tomllib.loads(self._text)
        system = tables.get("system", {})
        keys = dict(changes)
        if any(callable(value) for value in keys.values()):
            declared = [
                f"{name}[{count}]" if array else name for name, _, count, array in self._study.coordinates
            ]
            known = {name: system.get(name, {}) | dict(keys.get(name) or {}) for name in ADDED}
            keys = _traced({"coordinates": declared} | keys | known)
            if "coordinates" not in changes:
                del keys["coordinates"]
        _insert(tables, keys)
        return _toml.dumps({name: value for name, value in tables.items() if value != {}})

    def _beside(self) -> str:
        """The name of a text that was made of this one, in the same folder."""
        return os.path.join(os.path.dirname(self._name), "problem")

    @property
    def title(self) -> str:
        """Title of the scene, or ""."""
        return self._study.title

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the n coordinates, as "x" and "q[1]"."""
        return tuple(self._study.names)

    def _accepts(self, tolerance: Any) -> bool:
        """Whether the problem can be solved to it as it is; the scene says why not."""
        return self._study.adaptive and isinstance(tolerance, Real) and 0 < float(tolerance) < 1

    @overload
    def solve(
        self,
        *,
        tolerance: float | None = None,
        solutions: None = None,
        raise_on_failure: bool = False,
        progress: Progress | None = None,
        **changes: Any,
    ) -> Solution:
        ...

    @overload
    def solve(
        self,
        *,
        tolerance: float | None = None,
        solutions: int,
        raise_on_failure: bool = False,
        progress: Progress | None = None,
        **changes: Any,
    ) -> list[Solution]:
        ...

    def solve(
        self,
        *,
        tolerance: float | None = None,
        solutions: int | None = None,
        raise_on_failure: bool = False,
        progress: Progress | None = None,
        **changes: Any,
    ) -> Solution | list[Solution]:
        """Finds the extremal that the guess leads to.

        Args:
            tolerance: largest error of q(t), relative to the largest range of a coordinate; 1e-9 where
                neither this nor the problem says.
            solutions: look for up to so many extremals; they come as a list, by their actions.
            raise_on_failure: raise NotConverged instead of returning a solution that says why there is none.
            progress: called with each step of the iteration, of a fit with each of its own; an exception that
                it raises ends the solve.
            changes: as for replace().

        Returns:
            A Solution. Of a problem with a table [search] that with the least action, the others in
            `solutions`.
        """
        if tolerance is not None and (changes or not self._accepts(tolerance)):
            changes["tolerance"] = tolerance
        if solutions is not None:
            changes["search"] = {"solutions": solutions}
        problem = self.replace(**changes) if changes else self
        study = problem._study
        if study.solutions == 0:
            solution = Solution._made(problem, study.solve(tolerance, progress))
            if raise_on_failure and not solution.converged:
                raise NotConverged(solution)
            return solution
        found = [
            Solution._made(problem, solved) for solved in study.search(study.solutions, tolerance, progress)
        ]
        if raise_on_failure and not found[0].converged:
            raise NotConverged(found[0])
        return found if solutions is not None else Solution._made(problem, found[0]._solved, tuple(found))

    def follow(
        self,
        parameter: str | None = None,
        *,
        to: float | None = None,
        points: int | None = None,
        switch: bool | None = None,
        progress: Callable[[_core.BranchPoint], object] | None = None,
        **changes: Any,
    ) -> Branch:
        """Follows a family of extremals from this one, past folds.

        Args:
            parameter: "duration", "energy" or the name of a parameter. Left out, the table [continuation]
                says all. Where the energy is to vary and the duration is fixed, it becomes free: the
                family begins with the energy of this problem's solution.
            to: its last value; the first is that of the problem.
            points: largest number of points of a branch; 50 if not given.
            switch: follow also the branches that bifurcate.
            progress: called with each point; an exception that it raises ends the work.
            changes: as for replace().

        Returns:
            A Branch. If it has no points, its status and message say why.

        Raises:
            NotConverged: where that solution is not found.
        """
        if parameter is not None:
            given = {"parameter": parameter, "to": to, "points": points, "switch": switch}
            changes["continuation"] = {name: value for name, value in given.items() if value is not None}
            if parameter == "energy":
                changes = self._with_free_duration(changes)
        elif not (to is None and points is None and switch is None):
            raise TypeError("to, points and switch need the name of a parameter")
        text, name = (self._changed(changes), self._beside()) if changes else (self._text, self._name)
        study = _core.Study(text, name, True)
        return Branch._made(self.from_toml(text, name), study, study.follow(progress))

    def _with_free_duration(self, changes: dict[str, Any]) -> dict[str, Any]:
        """Changes after which the energy closes a free duration, if the duration was fixed."""
        others = {name: value for name, value in changes.items() if name != "continuation"}
        problem = self.replace(continuation=None, search=None, **others)
        tables = tomllib.loads(problem._text)
        if tables["boundary"]["duration"] == "free" or problem._study.initial:
            return changes
        solution = problem.solve(raise_on_failure=True)
        if solution.energy is None:
            return changes
        guess = tables.get("guess", {}) | {"duration": solution.duration}
        return changes | {"duration": "free", "energy": solution.energy, "guess": guess, "search": None}

    def solve_many(
        self,
        *,
        start: npt.ArrayLike | None = None,
        end: npt.ArrayLike | None = None,
        duration: npt.ArrayLike | None = None,
        tolerance: float | None = None,
        threads: int | None = None,
    ) -> Solutions:
        """Solves m problems that differ in their ends and durations, with one compiled Lagrangian, in
        several threads.

        Args:
            start, end: positions, (m, n) or (n,) for all alike, in the order of `coordinates`; left out: the
                problem's.
            duration: (m,) or a number, likewise.
            tolerance: as for solve().
            threads: so many at once; as many as there are processors for this process if not given.

        Returns:
            Arrays with a row for each problem.
        """
        n = len(self.coordinates)
        given: dict[str, npt.NDArray[np.float64]] = {}
        for name, value, width in (("start", start, n), ("end", end, n), ("duration", duration, 0)):
            if value is not None:
                array = reals(value, name)
                if array.ndim not in ((1, 2) if width else (0, 1)) or (width and array.shape[-1] != n):
                    raise ValueError(
                        f"{name} has the shape {array.shape}; need {f'(m, {n})' if width else '(m,)'}"
                    )
                if not np.isfinite(array).all():
                    at = tuple(np.argwhere(~np.isfinite(array))[0].tolist())
                    raise ValueError(
                        f"{name}[{', '.join(map(str, at))}] = {array[at]}; need a finite number"
                    )
                given[name] = array
        counts = {len(a) for name, a in given.items() if a.ndim == (1 if name == "duration" else 2)}
        if not counts:
            raise ValueError("give start, end or duration as an array with a row for each problem")
        if len(counts) > 1:
            raise ValueError(
                f"start, end and duration have {sorted(counts)} rows; they must have one number of rows"
            )
        m = counts.pop()
        rows = {name: np.broadcast_to(a, (m,) if name == "duration" else (m, n)) for name, a in given.items()}
        problem = self._with_first(rows) if m else self
        threads = threads if threads is not None else len(os.sched_getaffinity(0))
        if tolerance is not None and not self._accepts(tolerance):
            problem = problem.replace(tolerance=tolerance)
        arrays = problem._study.solve_many(
            rows.get("start"), rows.get("end"), rows.get("duration"), tolerance, threads
        )
        return Solutions._made(arrays)

    def _with_first(self, rows: Mapping[str, npt.NDArray[np.float64]]) -> Problem:
        """The problem of the first row: its ends are fixed where rows replace them."""
        changes: dict[str, Any] = {}
        for name in ("start", "end"):
            if name in rows:
                fixed: dict[str, Any] = {}
                for coordinate, first, count, array in self._study.coordinates:
                    values = rows[name][0][first : first + count].tolist()
                    fixed[coordinate] = values if array else values[0]
                momenta = tomllib.loads(self._text)["boundary"].get(name, {})
                if name == "start" and self._study.initial:
                    fixed |= {key: value for key, value in momenta.items() if key not in fixed}
                changes[name] = fixed
        if "duration" in rows:
            changes["duration"] = float(rows["duration"][0])
        return self.replace(**changes)

    def _repr_pretty_(self, printer: Any, cycle: bool) -> None:
        printer.text(repr(self))

    def __repr__(self) -> str:
        return f"<Problem {self.title or self._name!r}: {', '.join(self.coordinates[:8])}>\n{self._text}"

    def __reduce__(self) -> tuple[Any, ...]:
        return Problem.from_toml, (self._text, self._name)


def load(path: str | os.PathLike[str]) -> Problem:
    """The problem of a scene file.

    Raises:
        SceneError: as `extremal solve` refuses it.
    """
    name = os.fspath(path)
    return Problem.from_toml(_core.read_text(name), name)

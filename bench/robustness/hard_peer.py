#!/usr/bin/env python3
"""Runs scipy.integrate.solve_bvp on scenes with ends that are fixed or free, from the guess of the scene.

usage: hard_peer.py SCENE[|KEY=VALUE]...   (of boundary, system.parameters and guess; VALUE is TOML)

Equations of motion and their Jacobian are derived from the scene's Lagrangian by sympy. Of a periodic scene
whose guess is a state, both ends are fixed at that state's position. Where the equations are singular at t = 0
the interval begins just beside it. Writes one JSON list to standard output: for each scene the first run that
converged, else the last one, with the action of its path.
"""

import json
import os
import re
import signal
import sys
import tomllib
import warnings

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "precision"))
from scipy_peer import MOST_NODES, Scene  # noqa: E402  (leaves with a message where scipy is absent)

try:
    import numpy as np
    import sympy
    from scipy.integrate import solve_ivp
except ImportError as error:
    sys.exit(f"{error}")

TOLERANCE = 1e-8
FIRST_NODES = (101, 1001, 11)
MOST_VALUES = 200_000  # of nodes times unknowns at a node
LIMIT = 30  # seconds of one run
BESIDE = 1e-4  # where the interval begins, as a part of it
GAUSS = np.polynomial.legendre.leggauss(7)
SYSTEMS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "problems", "systems")


class Array:
    """The elements of a coordinate or parameter, counted from 1."""

    def __init__(self, elements):
        self.elements = elements

    def __getitem__(self, index):
        return self.elements[int(index) - 1]


def python_of(formula):
    """A formula of a scene as a Python expression: q' is dot_q, a sum is a function of its body."""
    text = str(formula)
    text = re.sub(r"([A-Za-z_]\w*)(\[[^\[\]]*\])?'", r"dot_\1\2", text).replace("^", "**")
    while found := re.search(r"\bsum\(", text):
        depth, begin, parts = 1, found.end(), []
        for at in range(found.end(), len(text)):
            depth += (text[at] in "([") - (text[at] in ")]")
            if depth == 0 or (depth == 1 and text[at] == ","):
                parts.append(text[begin:at])
                begin = at + 1
            if depth == 0:
                break
        index, first, last = (part.strip() for part in parts[:3])
        body = ",".join(parts[3:])
        text = f"{text[:found.start()]}total(lambda {index}: {body}, {first}, {last}){text[begin:]}"
    return text


def whole(value):
    """Numbers that serve as bounds of sums are integers."""
    return int(value) if isinstance(value, float) and value.is_integer() else value


class Formulas:
    """Values of formulas in the coordinates, velocities, parameters and definitions of a system."""

    def __init__(self, system):
        self.names = {name: getattr(sympy, name) for name in ("sin", "cos", "tan", "sqrt", "exp", "log")}
        self.names |= {name: getattr(sympy, name) for name in ("sinh", "cosh", "tanh", "pi")}
        self.names |= {"total": lambda body, first, last: sum(body(k) for k in range(int(first), int(last) + 1))}
        self.t = self.names["t"] = sympy.Symbol("t")
        for name, value in system.get("parameters", {}).items():
            self.names[name] = Array(value) if isinstance(value, list) else whole(value)
        self.keys, self.q, self.v = [], [], []
        for declared in system["coordinates"]:
            name, _, size = declared.rstrip("]").partition("[")
            keys = [f"{name}[{k + 1}]" for k in range(int(self.value(size)))] if size else [name]
            q, v = ([sympy.Symbol(dot + key, real=True) for key in keys] for dot in ("", "dot_"))
            self.names[name], self.names["dot_" + name] = (Array(q), Array(v)) if size else (q[0], v[0])
            self.keys, self.q, self.v = self.keys + keys, self.q + q, self.v + v
        left = dict(system.get("definitions", {}))
        while left:
            ready = {}
            for name, formula in left.items():
                try:
                    ready[name] = self.value(formula)
                except NameError:
                    continue
            self.names |= ready
            left = {name: formula for name, formula in left.items() if name not in ready}
            if not ready:
                raise ValueError(f"definitions {list(left)} use unknown names")

    def value(self, formula, **more):
        return eval(python_of(formula), self.names | more) if isinstance(formula, str) else formula

    def of_coordinates(self, table, rate=False, **more):
        """One formula for each coordinate, None where the table has none; a formula of an array is in i."""
        values, mark = [], "'" if rate else ""
        for key in self.keys:
            name, _, index = key.rstrip("]").partition("[")
            given = table.get(key + mark, table.get(name + mark))
            if isinstance(given, list):
                given = given[int(index) - 1]
            values.append(None if given is None else self.value(given, i=int(index or 0), **more))
        return values


class Equations:
    """M q'' = ∂L/∂q − ∂²L/∂v∂q q' − ∂²L/∂v∂t as a first-order system of (q, v) with its Jacobian."""

    def __init__(self, formulas, lagrangian):
        q, v, t = formulas.q, formulas.v, formulas.t
        L = formulas.value(lagrangian)
        momenta = [sympy.diff(L, x) for x in v]
        mass = sympy.Matrix([[sympy.diff(p, x) for x in v] for p in momenta])
        force = sympy.Matrix(
            [
                sympy.diff(L, x) - sympy.diff(p, t) - sum(sympy.diff(p, y) * w for y, w in zip(q, v))
                for x, p in zip(q, momenta)
            ]
        )
        diagonal = mass.is_diagonal()
        rates = [f / mass[k, k] for k, f in enumerate(force)] if diagonal else list(mass.LUsolve(force))
        columns = [*q, *v]
        slots = [(r, c) for r in range(len(q)) for c in range(len(columns)) if rates[r].has(columns[c])]
        compiled = lambda rows: sympy.lambdify([t, columns], rows, modules="numpy", cse=True)  # noqa: E731
        self.rates, self.lagrangian, self.momenta = compiled(rates), compiled([L]), compiled(momenta)
        self.slopes, self.slots = compiled([sympy.diff(rates[r], columns[c]) for r, c in slots]), slots

    def right_hand_side(self, t, y):
        rows = [np.broadcast_to(row, y.shape[1:]) for row in self.rates(t, y)]
        return np.concatenate([y[len(rows) :], np.array(rows, dtype=float)])

    def jacobian(self, t, y):
        n = len(y) // 2
        result = np.zeros((2 * n, 2 * n, y.shape[1]))
        result[:n, n:] = np.eye(n)[:, :, None]
        for (row, column), slope in zip(self.slots, self.slopes(t, y)):
            result[n + row, column] = slope
        return result

    def action(self, path):
        """∫ L dt by Gauss's rule between the nodes of a solution of solve_bvp."""
        ends = path.x
        halves, middles = np.diff(ends) / 2, (ends[1:] + ends[:-1]) / 2
        t = (middles + halves * GAUSS[0][:, None]).ravel()
        values = np.broadcast_to(self.lagrangian(t, path(t))[0], t.shape).reshape(len(GAUSS[0]), -1)
        return float((GAUSS[1][:, None] * halves * values).sum())


def changed(scene, sets):
    """The scene with the changes "key.key=value"."""
    for text in sets:
        key, _, value = text.partition("=")
        *tables, last = key.split(".")
        table = scene
        for name in tables:
            table = table.setdefault(name, {})
        table[last] = tomllib.loads(f"value = {value}")["value"]
    return scene


def with_system_file(system):
    """The system's own tables added to those of the file that it uses."""
    if "use" not in system:
        return system
    with open(os.path.join(SYSTEMS, system["use"] + ".toml"), "rb") as file:
        base = tomllib.load(file)["system"]
    for table in ("parameters", "definitions"):
        base[table] = base.get(table, {}) | system.get(table, {})
    return base | {"lagrangian": system.get("lagrangian", base["lagrangian"])}


class HardScene(Scene):
    def __init__(self, text):
        path, *sets = text.split("|")
        with open(path, "rb") as file:
            scene = changed(tomllib.load(file), sets)
        system = with_system_file(scene["system"])
        self.formulas = Formulas(system)
        self.equations = Equations(self.formulas, system["lagrangian"])
        self.right_hand_side, self.jacobian = self.equations.right_hand_side, self.equations.jacobian
        boundary, n = scene["boundary"], len(self.formulas.keys)
        self.duration = float(self.formulas.value(boundary["duration"]))
        self.given = scene.get("guess", {})
        self.state = self.read_state() if "state" in self.given else None
        if boundary.get("periodic"):
            self.start = self.end = self.state[:n]
        else:
            self.start, self.end = (self.read_end(boundary.get(end, {})) for end in ("start", "end"))
        self.ends_jacobian = None
        self.most_nodes = min(MOST_NODES, MOST_VALUES // (2 * n))
        with np.errstate(all="ignore"):
            first = self.right_hand_side(np.zeros(1), np.ones((2 * n, 1)))
        self.begin = 0.0 if np.isfinite(first).all() else BESIDE * self.duration

    def read_end(self, table):
        """Values of coordinates, NaN where they are free."""
        values = self.formulas.of_coordinates(table)
        return np.array([np.nan if value is None else float(value) for value in values])

    def read_state(self):
        table = self.given["state"]
        q, v = (self.formulas.of_coordinates(table, rate) for rate in (False, True))
        return np.array([0.0 if value is None else float(value) for value in q + v])

    def first_path(self, nodes):
        """The scene's guess: its state integrated, its formulas, else the line between the ends."""
        n = len(self.start)
        if self.state is not None:
            motion = solve_ivp(
                self.right_hand_side_of_one, (0, self.duration), self.state, "DOP853", rtol=1e-12, atol=1e-12
            )
            return motion.t, motion.y
        t = np.linspace(self.begin, self.duration, nodes)
        low = np.where(np.isnan(self.start), self.end, self.start)
        high = np.where(np.isnan(self.end), self.start, self.end)
        q = low[:, None] + (high - low)[:, None] * t / self.duration
        formulas = self.formulas.of_coordinates(self.given, T=self.duration)
        for a in range(n):
            if formulas[a] is not None:
                q[a] = sympy.lambdify(self.formulas.t, formulas[a], "numpy")(t)
        return t, np.vstack([q, np.gradient(q, t, axis=1)])

    def right_hand_side_of_one(self, t, y):
        return np.concatenate([y[len(y) // 2 :], self.equations.rates(t, y)])

    def miss(self, first, last):
        n, rows = len(self.start), []
        for given, y, t in ((self.start, first, self.begin), (self.end, last, self.duration)):
            free = np.array(self.equations.momenta(t, y), dtype=float)
            rows.append(np.where(np.isnan(given), free, y[:n] - given))
        return np.concatenate(rows)


def stop(*_):
    raise TimeoutError(f"more than {LIMIT} s")


def run(scene):
    record = {"failure": "nothing was run", "seconds": 0.0, "action": 0.0}
    for nodes in FIRST_NODES:
        signal.setitimer(signal.ITIMER_REAL, LIMIT)
        try:
            result, seconds = scene.timed(TOLERANCE, nodes)
        except (TimeoutError, ValueError, ArithmeticError, np.linalg.LinAlgError) as error:
            record = {"failure": str(error), "seconds": float(LIMIT), "action": 0.0}
            continue
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
        action = scene.equations.action(result.sol) if result.success else 0.0
        failure = "" if result.success else result.message
        if result.success and not np.isfinite(action):
            failure, action = "the path is not finite", 0.0
        record = {"failure": failure, "seconds": seconds, "action": action}
        if not failure or scene.state is not None:
            break
    return record


if __name__ == "__main__":
    warnings.filterwarnings("ignore")
    signal.signal(signal.SIGALRM, stop)
    json.dump([run(HardScene(text)) for text in sys.argv[1:]], sys.stdout)

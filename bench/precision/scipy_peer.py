#!/usr/bin/env python3
"""Times scipy.integrate.solve_bvp, with analytic Jacobians, on benchmark scenes with fixed ends.

usage: scipy_peer.py DATA_FOLDER SCENE...   (scenes without equations below are passed over)

Writes one JSON object to standard output: for each scene a list of runs, one for each tolerance and number of
nodes to begin with; "error" is the largest over coordinates and times against the reference solution.
"""

import csv
import json
import os
import sys
import time
import tomllib

try:
    import numpy as np
    from scipy.integrate import solve_bvp
except ImportError as error:
    sys.exit(f"{error}")

TOLERANCES = [10.0**-k for k in range(3, 12)]
FIRST_NODES = (11, 41)
MOST_NODES = 20000
BUDGET = 0.03  # seconds of repetitions a run
SLOW = 0.5  # seconds after which no smaller tolerance is tried


def pendulum(q):
    """Acceleration (n, m) and its derivative in q (n, n, m) at m points q (n, m); so for each force below."""
    return -np.sin(q), -np.cos(q)[None]


def kepler(q):
    r2 = q[0] ** 2 + q[1] ** 2
    r3 = r2 * np.sqrt(r2)
    slope = 3 * q[:, None] * q[None] / (r2 * r3) - np.eye(2)[:, :, None] / r3
    return -q / r3, slope


def henon_heiles(q):
    x, y = q
    force = np.stack([-x - 2 * x * y, -y - x**2 + y**2])
    slope = np.array([[-1 - 2 * y, -2 * x], [-2 * x, -1 + 2 * y]])
    return force, slope


def separable(force):
    """y = (q, v) as a first-order system with its Jacobian."""

    def right_hand_side(t, y):
        n = len(y) // 2
        return np.concatenate([y[n:], force(y[:n])[0]])

    def jacobian(t, y):
        n = len(y) // 2
        result = np.zeros((2 * n, 2 * n, y.shape[1]))
        result[:n, n:] = np.eye(n)[:, :, None]
        result[n:, :n] = force(y[:n])[1]
        return result

    return right_hand_side, jacobian


def double_pendulum(gravity=9.81):
    """M(q) v' = f(q, v) with M = [[2, c], [c, 1]], c = cos(a - b); derivatives by M dv' = df - dM v'."""

    def solve(c, f, g):
        determinant = 2 - c**2
        return (f - c * g) / determinant, (2 * g - c * f) / determinant

    def accelerations(y):
        a, b, u, w = y
        c, s = np.cos(a - b), np.sin(a - b)
        f, g = -s * w**2 - 2 * gravity * np.sin(a), s * u**2 - gravity * np.sin(b)
        return c, s, *solve(c, f, g)

    def right_hand_side(t, y):
        return np.array([y[2], y[3], *accelerations(y)[2:]])

    def jacobian(t, y):
        a, b, u, w = y
        c, s, p, r = accelerations(y)
        result = np.zeros((4, 4, y.shape[1]))
        result[0, 2] = result[1, 3] = 1
        # d/da and d/db of f and g, less dM (p, r) with dc/da = -s, dc/db = s
        columns = (
            (-c * w**2 - 2 * gravity * np.cos(a) + s * r, c * u**2 + s * p),
            (c * w**2 - s * r, -c * u**2 - gravity * np.cos(b) - s * p),
            (0 * a, 2 * s * u),
            (-2 * s * w, 0 * a),
        )
        for k, (f, g) in enumerate(columns):
            result[2, k], result[3, k] = solve(c, f, g)
        return result

    return right_hand_side, jacobian


SYSTEMS = {
    "pendulum-short": separable(pendulum),
    "kepler-arc": separable(kepler),
    "henon-heiles-10": separable(henon_heiles),
    "double-pendulum-1": double_pendulum(),
}


def read_csv(path):
    """Times and the columns of coordinates, without those of velocities."""
    with open(path, newline="") as file:
        header, *rows = csv.reader(file)
    rows = np.array(rows, dtype=float)
    keep = [k for k, name in enumerate(header) if name != "t" and not name.endswith("'")]
    return rows[:, header.index("t")], rows[:, keep].T


class Scene:
    def __init__(self, folder, name):
        with open(os.path.join(folder, name + ".toml"), "rb") as file:
            scene = tomllib.load(file)
        names = scene["system"]["coordinates"]
        boundary = scene["boundary"]
        self.start = np.array([boundary["start"][key] for key in names])
        self.end = np.array([boundary["end"][key] for key in names])
        self.duration = boundary["duration"]
        self.times, self.reference = read_csv(os.path.join(folder, name + ".csv"))
        guess = scene.get("guess", {}).get("file")
        self.guess = read_csv(os.path.join(folder, guess)) if guess else None
        self.right_hand_side, self.jacobian = SYSTEMS[name]
        n = len(names)
        at_start = np.vstack([np.eye(n, 2 * n), np.zeros((n, 2 * n))])
        at_end = np.vstack([np.zeros((n, 2 * n)), np.eye(n, 2 * n)])
        self.ends_jacobian = lambda first, last: (at_start, at_end)
        self.most_nodes = MOST_NODES

    def first_path(self, nodes):
        """The scene's guess on equal intervals: its file, or the line between the ends."""
        t = np.linspace(0, self.duration, nodes)
        if self.guess is None:
            q = self.start[:, None] + (self.end - self.start)[:, None] * t / self.duration
        else:
            q = np.array([np.interp(t, self.guess[0], row) for row in self.guess[1]])
        return t, np.vstack([q, np.gradient(q, t, axis=1)])

    def miss(self, first, last):
        n = len(self.start)
        return np.concatenate([first[:n] - self.start, last[:n] - self.end])

    def solve(self, tolerance, nodes):
        t, y = self.first_path(nodes)
        return solve_bvp(
            self.right_hand_side,
            self.miss,
            t,
            y,
            fun_jac=self.jacobian,
            bc_jac=self.ends_jacobian,
            tol=tolerance,
            bc_tol=tolerance,
            max_nodes=self.most_nodes,
        )

    def timed(self, tolerance, nodes):
        """The result of a solve and the median of the seconds of its repetitions."""
        seconds = []
        while not seconds or sum(seconds) < BUDGET:
            begin = time.perf_counter()
            result = self.solve(tolerance, nodes)
            seconds.append(time.perf_counter() - begin)
        return result, float(np.median(seconds))

    def run(self, tolerance, nodes):
        result, seconds = self.timed(tolerance, nodes)
        path = result.sol(self.times)[: len(self.start)]
        return {
            "tolerance": tolerance,
            "nodes": nodes,
            "failure": "" if result.success else result.message,
            "seconds": seconds,
            "error": float(np.abs(path - self.reference).max()),
        }


def runs(scene):
    results = []
    for nodes in FIRST_NODES:
        for tolerance in TOLERANCES:
            results.append(scene.run(tolerance, nodes))
            if results[-1]["seconds"] > SLOW:
                break
    return results


def main(folder, names):
    json.dump({name: runs(Scene(folder, name)) for name in names if name in SYSTEMS}, sys.stdout)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])

# ---
# jupyter:
#   jupytext:
#     formats: py:percent
# ---

# %% [markdown]
# # Bodies that follow each other on one curve
#
# After a part T of the period each of n equal masses has the place of the next one. A `map` says so; the
# search begins with random loops of that symmetry.

# %%
import numpy as np

import extremal as ex

N = 3


def lagrangian(q, v, t):
    x, y = q[:N], q[N:]
    energy = v @ v / 2
    for i in range(N):
        for j in range(i):
            energy = energy + 1 / np.hypot(x[i] - x[j], y[i] - y[j])
    return energy


follows = {f"{c}[{i + 1}]": f"{c}[{(i + 1) % N + 1}]" for c in "xy" for i in range(N)}
problem = ex.Problem(
    lagrangian,
    coordinates=[f"x[{N}]", f"y[{N}]"],
    periodic=True,
    map=follows,
    duration=2 * np.pi / N,
    guess=dict(x=f"cos(2*pi*(t/T + i - 1)/{N})", y=f"sin(2*pi*(t/T + i - 1)/{N})"),
    title="Choreographies of three bodies",
)
found = problem.solve(solutions=2)
for solution in found:
    print(f"action {solution.action:.10f}  energy {solution.energy:.10f}  index {solution.index}")

# %% [markdown]
# The first is Lagrange's triangle on a circle, the second the figure-eight of Chenciner and Montgomery,
# whose action over a period is 24.3719 for this period.

# %%
circle, eight = found
# Masses 1 at distances d on a circle of period 2π: d³ = 3.
assert abs(circle.energy + 1.5 * 3 ** (-1 / 3)) < 1e-8
assert abs(3 * eight.action - 24.3719) < 1e-3
eight.plot("out/eight.svg")

# %% [markdown]
# One body's way over the whole period is that of all three, one after the other.

# %%
t = np.linspace(0, eight.duration, 200)
curve = np.concatenate([eight(t)[:, [k, N + k]] for k in range(N)])
print(f"the eight is {np.ptp(curve, axis=0).max():.4f} long")

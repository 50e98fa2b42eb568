# ---
# jupyter:
#   jupytext:
#     formats: py:percent
# ---

# %% [markdown]
# # How weak noise crosses a barrier
#
# A particle at rest in a valley of the potential V, x' = −∇V + noise, crosses to another valley once in a
# long while. When it does, its way is the minimiser of the action of Freidlin and Wentzell, ∫ |x' + ∇V|²/2
# dt, whose least value over all times is twice the height of the barrier.

# %%
import numpy as np

import extremal as ex


def gradient(q):
    """Of V = (x² − 1)²/4 + 2 (y − x²/2)²: valleys at (±1, 1/2), a saddle at the origin of height 1/4."""
    x, y = q
    across = y - x**2 / 2
    return np.array([x * (x**2 - 1) - 4 * across * x, 4 * across])


def action(q, v, t):
    return np.sum((v + gradient(q)) ** 2) / 2


crossing = ex.Problem(
    action,
    coordinates=["x", "y"],
    start=dict(x=-1, y=0.5),
    end=dict(x=1, y=0.5),
    duration=10.0,
    guess=dict(x="-cos(pi*t/T)", y="cos(pi*t/T)^2/2"),
    title="The most probable way over a barrier",
)
path = crossing.solve(tolerance=1e-9, raise_on_failure=True)
print(path)
path.plot("out/crossing.svg")

# %% [markdown]
# It leads over the saddle, upwards and downwards along the same curve. The action falls to 2 · 1/4 as the
# time grows.

# %%
family = crossing.follow("duration", to=20.0)
print(np.c_[family.duration, family.action])
assert (np.diff(family.action) < 0).all() and abs(family.action[-1] - 0.5) < 1e-3
nearest = np.linalg.norm(path(np.linspace(0, 10, 501)), axis=1).min()
print(f"the path passes the saddle at a distance of {nearest:.1e}")
assert nearest < 1e-2

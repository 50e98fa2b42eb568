# ---
# jupyter:
#   jupytext:
#     formats: py:percent
# ---

# %% [markdown]
# # From planar orbits to near-rectilinear halo orbits
#
# About the libration point L2 of the Earth and the Moon planar orbits exist. Where their period falls to
# 3.4155 halo orbits branch off, north and south, and become near-rectilinear. Unit of length is the
# distance of the Moon, of time its period divided by 2π.

# %%
import os

import numpy as np

import extremal as ex

family = ex.load("problems/scenes/halo-family.toml").follow()
print(family.message)
family.plot("out/halo-family.svg", quantity="z(0)")

# %% [markdown]
# Halo orbits are those out of the plane. Their stability index is half the sum of the largest multiplier and
# its inverse; orbits with an index of at most one in absolute value are stable.

# %%
north = np.flatnonzero((family.branch > 0) & (np.abs(family.q[:, 2]) > 1e-3))
largest = family.multipliers[north, 0]
index = np.abs(largest + 1 / largest) / 2
for k, nu in zip(north[::6], index[::6]):
    print(f"period {family.duration[k]:.4f}  energy {family.energy[k]:.5f}  stability index {nu:8.2f}")
assert index.min() < 2 < 100 < index.max()

# %% [markdown]
# One of them in full: the orbit whose period is two ninths of the time between two full moons, as planned
# for a station there.

# %%
period = 2 / 9 * 29.530589 / 27.321661 * 2 * np.pi
k = north[np.argmin(np.abs(family.duration[north] - period))]
family[k].save("out/halo.csv", samples=401)
near = dict(file=os.path.abspath("out/halo.csv"))
orbit = family[k].problem.replace(duration=period, guess=near).solve(tolerance=1e-10)
print(orbit)
position = orbit(np.linspace(0, orbit.duration, 2001))
distance = np.linalg.norm(position - [1 - 0.01215058560962404, 0, 0], axis=1) * 384400
print(f"between {distance.min():.0f} and {distance.max():.0f} km from the Moon")
assert orbit.converged and 3000 < distance.min() < 3500 and 70000 < distance.max() < 72000
orbit.plot("out/halo.svg")

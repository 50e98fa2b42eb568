# ---
# jupyter:
#   jupytext:
#     formats: py:percent
# ---

# %% [markdown]
# # A transfer to Mars, and ten thousand of them
#
# Both planets move on circles about the Sun; lengths are in astronomical units, times in years. In polar
# coordinates the straight line between two points is a spiral about the Sun, a good first guess.

# %%
import matplotlib
import numpy as np

import extremal as ex

matplotlib.use("agg")
import matplotlib.pyplot as plt  # noqa: E402

MU = 4 * np.pi**2
EARTH, MARS = 1.0, 1.524
KM_PER_S = 149597870.7 / (365.25 * 86400)


def lagrangian(q, v, t):
    r, (dr, dtheta) = q[0], v
    return (dr**2 + (r * dtheta) ** 2) / 2 + MU / r


def angle(radius, t):
    return np.sqrt(MU / radius**3) * t


transfer = ex.Problem(
    lagrangian,
    coordinates=["r", "theta"],
    start=dict(r=EARTH, theta=0),
    end=dict(r=MARS, theta=2.5),
    duration=0.7,
    title="From the Earth to Mars",
)
arc = transfer.solve(tolerance=1e-10)
print(arc)
arc.plot("out/transfer.svg")

# %% [markdown]
# Now every departure within 0.7 years, with every time of flight from 0.4 to 1 years: one compiled
# Lagrangian, all processors. At t = 0 Mars is 44 degrees ahead, as it must be for the cheapest transfer.

# %%
departures, flights = np.meshgrid(np.linspace(-0.35, 0.35, 100), np.linspace(0.4, 1.0, 100))
departure, flight = departures.ravel(), flights.ravel()
ahead = np.radians(44.3) + angle(MARS, departure + flight) - angle(EARTH, departure)
arcs = transfer.solve_many(end=np.c_[np.full_like(ahead, MARS), ahead], duration=flight, tolerance=1e-8)
print(arcs)
assert arcs.converged.all()

# %% [markdown]
# Momenta are r' and r² θ'. The speeds to be gained at both ends follow from them; no transfer is cheaper than
# Hohmann's.

# %%
radius = np.array([EARTH, MARS])
radial, turning = arcs.momenta[:, :, 0], arcs.momenta[:, :, 1] / radius
speed = np.hypot(radial, turning - np.sqrt(MU / radius)).sum(axis=1) * KM_PER_S
half = np.sqrt(MU * 2 * radius[::-1] / (radius * radius.sum()))
hohmann = np.abs(half - np.sqrt(MU / radius)).sum() * KM_PER_S
print(f"cheapest: {speed.min():.3f} km/s; Hohmann: {hohmann:.3f} km/s")
assert hohmann <= speed.min() < 1.02 * hohmann

# %%
figure, axes = plt.subplots(figsize=(7, 5))
contours = axes.contour(
    departures, flights, np.reshape(speed, departures.shape), levels=np.arange(5.5, 16, 1)
)
axes.clabel(contours)
axes.set(xlabel="departure, years", ylabel="time of flight, years", title="Speed to be gained, km/s")
figure.savefig("out/porkchop.svg")

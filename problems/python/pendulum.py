# ---
# jupyter:
#   jupytext:
#     formats: py:percent
# ---

# %% [markdown]
# # Every motion of a pendulum between two angles
#
# From the angle 0 to the angle 1 in a given time a pendulum can swing over, to and fro, or turn. Each motion
# is a stationary point of the action; the number of its conjugate times is its Morse index.

# %%
import extremal as ex

pendulum = ex.Problem(
    "theta'^2/2 + cos(theta)",
    start=dict(theta=0.0),
    end=dict(theta=1.0),
    duration=20.0,
    title="From 0 to 1 in a time of 20",
)
motions = pendulum.solve(solutions=20)
for motion in motions:
    print(f"action {motion.action:9.4f}  energy {motion.energy:8.5f}  index {motion.index}")
    assert motion.index == len(motion.conjugate_times)

# %% [markdown]
# Longer times have more of them.

# %%
counts = [
    len(pendulum.replace(duration=duration).solve(solutions=20)) for duration in (2.0, 5.0, 10.0, 15.0, 20.0)
]
print(counts)
assert counts == sorted(counts) and counts[-1] == len(motions) == 11

# %%
pendulum.replace(search=dict(solutions=20)).solve().plot("out/motions.svg")

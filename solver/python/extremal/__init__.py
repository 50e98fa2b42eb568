"""Trajectories of mechanical systems as stationary points of the discrete action.

>>> import extremal as ex
>>> law = "(x'^2 + y'^2)/2 + 1/sqrt(x^2 + y^2)"
>>> p = ex.Problem(law, start=dict(x=1, y=0), end=dict(x=-0.6, y=0.9), duration=2.5)
>>> s = p.solve(tolerance=1e-12)
>>> s(1.3)
"""

from ._branch import Branch
from ._core import BranchPoint, FitStep, Iteration, __version__
from ._errors import NotConverged, SceneError
from ._many import Solutions
from ._problem import Problem, load
from ._solution import Fit, Named, Picture, Solution

__all__ = [
    "Branch",
    "BranchPoint",
    "Fit",
    "FitStep",
    "Iteration",
    "Named",
    "NotConverged",
    "Picture",
    "Problem",
    "SceneError",
    "Solution",
    "Solutions",
    "__version__",
    "load",
]

for _name in __all__:
    if not _name.startswith("_") and _name not in ("BranchPoint", "FitStep", "Iteration"):
        globals()[_name].__module__ = __name__

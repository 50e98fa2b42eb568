"""Many solutions as arrays."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core

Array = npt.NDArray[Any]


def reals(values: npt.ArrayLike, name: str) -> npt.NDArray[np.float64]:
    """An array of doubles; of complex numbers no part is left out in silence."""
    array = np.asarray(values)
    if array.dtype.kind == "c":
        raise TypeError(f"{name} has complex numbers; need real ones")
    return array.astype(float, copy=False)


def known(values: Array, mask: Array) -> Array:
    """Values of which those at `mask` are not known: a masked array where there are such."""
    if mask.any():
        shape = mask.reshape(mask.shape + (1,) * (values.ndim - mask.ndim))
        values = np.ma.masked_array(  # type: ignore[no-untyped-call]
            values, np.broadcast_to(shape, values.shape).copy()
        )
    values.flags.writeable = False
    return values


class Solutions:
    """m solutions as arrays, a row for each. Rows that did not converge are masked: where there are such,
    arrays are numpy.ma.MaskedArray.

    Attributes:
        status: why each row has no solution, or "converged", (m,).
        converged: (m,) of bool.
        q: positions at both ends, (m, 2, n).
        momenta: canonical momenta at both ends, (m, 2, n); masked at ends where L is infinite.
        action, energy, duration, error_estimate: (m,); energies are masked where L depends on t.
        index: Morse index, (m,); masked where there is none.
        iterations: steps of Newton's method, (m,).
    """

    __slots__ = (
        "status",
        "converged",
        "q",
        "momenta",
        "action",
        "energy",
        "duration",
        "error_estimate",
        "index",
        "iterations",
    )
    status: npt.NDArray[np.str_]
    converged: npt.NDArray[np.bool_]
    q: Array
    momenta: Array
    action: Array
    energy: Array
    duration: Array
    error_estimate: Array
    index: Array
    iterations: npt.NDArray[np.intc]

    @classmethod
    def _made(cls, arrays: dict[str, Any]) -> Solutions:
        self = cls.__new__(cls)
        put = object.__setattr__
        status = np.array(_core.STATUSES)[arrays["status"]]
        failed = arrays["status"] != 0
        put(self, "status", known(status, np.zeros(0, dtype=bool)))
        put(self, "converged", known(~failed, np.zeros(0, dtype=bool)))
        for name in ("q", "action", "duration", "error_estimate"):
            put(self, name, known(arrays[name], failed))
        momenta = arrays["momenta"]
        put(self, "momenta", known(momenta, failed[:, np.newaxis, np.newaxis] | np.isnan(momenta)))
        put(self, "energy", known(arrays["energy"], failed | ~arrays["energy_known"]))
        put(self, "index", known(arrays["index"], failed | (arrays["index"] < 0)))
        put(self, "iterations", known(arrays["iterations"], np.zeros(0, dtype=bool)))
        return self

    def __init__(self) -> None:
        raise TypeError("they come from Problem.solve_many()")

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError("solutions do not change")

    def __len__(self) -> int:
        return len(self.status)

    def __repr__(self) -> str:
        return f"<Solutions: {int(self.converged.sum())} of {len(self)} converged>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, tuple(getattr(self, name) for name in self.__slots__)


def _restored(*values: Any) -> Solutions:
    solutions = Solutions.__new__(Solutions)
    for name, value in zip(Solutions.__slots__, values, strict=True):
        value.flags.writeable = False
        object.__setattr__(solutions, name, value)
    return solutions

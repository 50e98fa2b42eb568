"""Functions of Python as formulas: called once, with symbols that note what is done to them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

SUM, PRODUCT, POWER, ATOM = 1, 2, 3, 4
OPERATORS = {"+": SUM, "-": SUM, "*": PRODUCT, "/": PRODUCT, "^": POWER}

Number = (int, float, np.integer, np.floating)


class Symbol:
    """A number that is not known yet: a coordinate, a velocity, the time, or what was computed from them.

    Arithmetic and functions of numpy give further symbols. Comparing symbols, and asking whether one is
    true, is refused: a formula has one form for all numbers. `np.minimum`, `np.maximum`, `abs` and
    `np.heaviside(u, 1)` are formulas.
    """

    __slots__ = ("op", "args")

    def __init__(self, op: str, *args: Any) -> None:
        self.op = op
        self.args = args

    def __add__(self, other: Any) -> Any:
        return binary("+", self, other)

    def __radd__(self, other: Any) -> Any:
        return binary("+", other, self)

    def __sub__(self, other: Any) -> Any:
        return binary("-", self, other)

    def __rsub__(self, other: Any) -> Any:
        return binary("-", other, self)

    def __mul__(self, other: Any) -> Any:
        return binary("*", self, other)

    def __rmul__(self, other: Any) -> Any:
        return binary("*", other, self)

    def __truediv__(self, other: Any) -> Any:
        return binary("/", self, other)

    def __rtruediv__(self, other: Any) -> Any:
        return binary("/", other, self)

    def __pow__(self, other: Any) -> Any:
        return binary("^", self, other)

    def __rpow__(self, other: Any) -> Any:
        return binary("^", other, self)

    def __neg__(self) -> Symbol:
        return Symbol("negative", self)

    def __pos__(self) -> Symbol:
        return self

    def __abs__(self) -> Symbol:
        return Symbol("abs", self)

    def conjugate(self) -> Symbol:
        return self

    def __bool__(self) -> bool:
        raise TypeError(REFUSED)

    def _compare(self, other: Any) -> bool:
        raise TypeError(REFUSED)

    __eq__ = __ne__ = __lt__ = __le__ = __gt__ = __ge__ = _compare
    __hash__ = object.__hash__

    def __float__(self) -> float:
        raise TypeError("a symbol has no value yet; use the functions of numpy, not those of math")

    def __getattr__(self, name: str) -> Any:
        """Of arrays of symbols numpy calls a function as a method of each."""
        function = FUNCTIONS.get(name)
        if function is None:
            raise AttributeError(lacking(name))
        return lambda *others: function(self, *others)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        function = FUNCTIONS.get(ufunc.__name__)
        out = options.pop("out", (None,))[0]
        if method != "__call__" or options or function is None:
            raise TypeError(lacking(ufunc.__name__))
        arrays = np.broadcast_arrays(*(np.asarray(each, dtype=object) for each in inputs))
        result = np.empty(arrays[0].shape, dtype=object)
        for place in np.ndindex(result.shape):
            result[place] = function(*(array[place] for array in arrays))
        if out is None:
            return result[()]
        out[...] = result
        return out

    def __repr__(self) -> str:
        return Formulas([self], {}, set()).texts[0]


REFUSED = (
    "a function is traced once, for all values of its arguments, and cannot choose by them; "
    "write np.minimum, np.maximum, abs or np.heaviside(u, 1)"
)


def lacking(name: str) -> str:
    known = ", ".join(sorted(FUNCTIONS))
    return f"a formula has no function '{name}'; those of numpy that it has are {known}"


def symbol(value: Any) -> Symbol:
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
    if isinstance(value, Symbol):
        return value
    if isinstance(value, Number) and not isinstance(value, bool):
        if not np.isfinite(float(value)):
            raise ValueError(f"{value} stands in a traced function; its numbers must be finite")
        return Symbol("number", value if isinstance(value, int) else float(value))
    raise TypeError(f"{value!r} stands in a traced function; it may use real numbers and its arguments")


def is_number(node: Symbol, value: float) -> bool:
    return node.op == "number" and node.args[0] == value


def binary(op: str, a: Any, b: Any) -> Any:
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return NotImplemented
    left, right = symbol(a), symbol(b)
    if op == "+" and is_number(left, 0):
        return right
    if (op in "+-" and is_number(right, 0)) or (op in "*/^" and is_number(right, 1)):
        return left
    if op == "*" and is_number(left, 1):
        return right
    return Symbol(op, left, right)


def call(name: str) -> Callable[..., Symbol]:
    return lambda *args: Symbol(name, *map(symbol, args))


def heaviside(u: Any, at_zero: Any) -> Symbol:
    if not is_number(symbol(at_zero), 1):
        raise ValueError("np.heaviside(u, h) is a formula for h = 1 alone")
    return Symbol("step", symbol(u))


ONE, TEN, TWO = (Symbol("number", n) for n in (1, 10, 2))

FUNCTIONS: dict[str, Callable[..., Any]] = {
    "add": lambda a, b: binary("+", a, b),
    "subtract": lambda a, b: binary("-", a, b),
    "multiply": lambda a, b: binary("*", a, b),
    "divide": lambda a, b: binary("/", a, b),
    "true_divide": lambda a, b: binary("/", a, b),
    "power": lambda a, b: binary("^", a, b),
    "float_power": lambda a, b: binary("^", a, b),
    "square": lambda a: binary("^", a, 2),
    "reciprocal": lambda a: binary("/", 1, a),
    "negative": lambda a: Symbol("negative", symbol(a)),
    "positive": symbol,
    "absolute": call("abs"),
    "fabs": call("abs"),
    "minimum": call("min"),
    "fmin": call("min"),
    "maximum": call("max"),
    "fmax": call("max"),
    "heaviside": heaviside,
    "arcsin": call("asin"),
    "arccos": call("acos"),
    "arctan": call("atan"),
    "arctan2": call("atan2"),
    "hypot": lambda a, b: Symbol("sqrt", binary("+", binary("^", a, 2), binary("^", b, 2))),
    "expm1": lambda a: binary("-", Symbol("exp", symbol(a)), 1),
    "exp2": lambda a: binary("^", 2, a),
    "log1p": lambda a: Symbol("log", binary("+", 1, a)),
    "log2": lambda a: binary("/", Symbol("log", symbol(a)), Symbol("log", TWO)),
    "log10": lambda a: binary("/", Symbol("log", symbol(a)), Symbol("log", TEN)),
    "deg2rad": lambda a: binary("*", a, np.pi / 180),
    "radians": lambda a: binary("*", a, np.pi / 180),
    "rad2deg": lambda a: binary("*", a, 180 / np.pi),
    "degrees": lambda a: binary("*", a, 180 / np.pi),
}
FUNCTIONS.update(
    (name, call(name)) for name in ("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "log", "sqrt")
)


def name_symbol(name: str) -> Symbol:
    """A name of a formula: "x", "x[1]'", "p_x", "t"."""
    return Symbol("name", name)


class Formulas:
    """Symbols as texts. What is used more than once becomes a definition, so that texts stay as short as the
    computation; `definitions` gets them, under names that are not in `taken`."""

    def __init__(self, values: Iterable[Any], definitions: dict[str, str], taken: set[str]) -> None:
        roots = [symbol(value) for value in values]
        self._definitions = definitions
        self._taken = taken
        self._count = 0
        order, uses = self._ordered(roots)
        done: dict[int, tuple[str, int]] = {}  # text and how tightly it binds
        for node in order:
            text, binding = self._text(node, done)
            if uses[id(node)] > 1 and node.args and node.op not in ("name", "number"):
                text, binding = self._define(text), ATOM
            done[id(node)] = text, binding
        self.texts = [done[id(root)][0] for root in roots]

    @staticmethod
    def _ordered(roots: list[Symbol]) -> tuple[list[Symbol], dict[int, int]]:
        """Each node once, after those that it is made of, and how often it is used."""
        order: list[Symbol] = []
        uses: dict[int, int] = {}
        stack = [(root, False) for root in reversed(roots)]
        while stack:
            node, seen = stack.pop()
            if seen:
                order.append(node)
                continue
            uses[id(node)] = uses.get(id(node), 0) + 1
            if uses[id(node)] > 1:
                continue
            stack.append((node, True))
            stack.extend((arg, False) for arg in reversed(node.args) if isinstance(arg, Symbol))
        return order, uses

    def _define(self, text: str) -> str:
        while True:
            self._count += 1
            name = f"u{self._count}"
            if name not in self._taken and name not in self._definitions:
                self._definitions[name] = text
                return name

    @staticmethod
    def _text(node: Symbol, done: dict[int, tuple[str, int]]) -> tuple[str, int]:
        if node.op == "name":
            return node.args[0], ATOM
        if node.op == "number":
            value = node.args[0]
            return repr(value), SUM if value < 0 else ATOM

        def operand(arg: Symbol, least: int) -> str:
            text, binding = done[id(arg)]
            return text if binding >= least else f"({text})"

        if node.op == "negative":
            return "-" + operand(node.args[0], POWER), SUM
        if node.op in OPERATORS:
            binding = OPERATORS[node.op]
            left, right = node.args
            space = " " if binding == SUM else ""
            first = operand(left, ATOM if node.op == "^" else binding)
            return f"{first}{space}{node.op}{space}{operand(right, binding + 1)}", binding
        return f"{node.op}({', '.join(done[id(arg)][0] for arg in node.args)})", ATOM

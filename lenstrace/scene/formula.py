"""Formulas that a person writes, as functions of named numbers: arithmetic and a few functions, nothing else.

>>> height = formula("a * cos(2 * pi * x) + y^2", ("x", "y"), {"a": 3})
>>> float(height(0.5, 2.0))
1.0
"""

from __future__ import annotations

import ast
import dataclasses
import math
import operator
from collections.abc import Callable, Mapping
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.errors import SceneError

# What may be called, by the name in a formula: its name in numpy and JAX, and how many numbers it takes.
FUNCTIONS: Mapping[str, tuple[str, int]] = {
    **{
        name: (name, 1) for name in ("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "sign", "floor")
    },
    **{"abs": ("abs", 1), "asin": ("arcsin", 1), "acos": ("arccos", 1), "atan": ("arctan", 1), "atan2": ("arctan2", 2)},
    **{"hypot": ("hypot", 2), "min": ("minimum", 2), "max": ("maximum", 2), "where": ("where", 3)},
}
CONSTANTS = {"pi": math.pi, "e": math.e}
LONGEST = 4000  # characters, so that no formula is too deep for Python

_BINARY: Mapping[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}
_COMPARED: Mapping[type, Callable[[Any, Any], Any]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}


@dataclasses.dataclass(frozen=True)
class Formula:
    """text: as it was written, ^ for powers.      names: of its numbers, in the order of the arguments.

    Two are equal where these are: a formula may be a static field of a pytree.
    """

    text: str
    names: tuple[str, ...]
    tree: Any = dataclasses.field(compare=False, repr=False)

    def __call__(self, *values: Any) -> Any:
        """Its value: of numbers or numpy arrays by numpy, of JAX arrays by JAX."""
        return self.evaluate(jnp if any(isinstance(value, jax.Array) for value in values) else np, *values)

    def evaluate(self, library: Any, *values: Any) -> Any:
        """Its value, of anything that computes like numbers, with a library that has the functions of `FUNCTIONS`."""
        return _value(self.tree, library, dict(zip(self.names, values, strict=True)))


def formula(text: str, names: tuple[str, ...], constants: Mapping[str, float] | None = None) -> Formula:
    """A formula of the numbers `names`, the constants given, pi and e. SceneError: what it must not hold, and where."""
    if not isinstance(text, str) or not text.strip():
        raise SceneError(f"formula: must be text, as 'x^2 + y^2 - 1'; got {text!r}")
    if len(text) > LONGEST:
        raise SceneError(f"formula: at most {LONGEST} characters, got {len(text)}")
    known = {**CONSTANTS, **(constants or {})}
    text = " ".join(text.split())  # several lines are one
    try:
        tree = ast.parse(text.replace("^", "**"), mode="eval").body
        return Formula(text, names, _checked(tree, text, names, known))
    except (SyntaxError, ValueError, MemoryError, RecursionError, ArithmeticError) as error:
        if isinstance(error, SceneError):
            raise
        reason = error.msg if isinstance(error, SyntaxError) else str(error) or type(error).__name__
        raise SceneError(f"formula {text!r}: cannot be read: {reason}") from None


def _checked(node: ast.AST, text: str, names: tuple[str, ...], known: Mapping[str, float]) -> Any:
    """The tree of what a formula may hold: a number, a name, or (operation, operands)."""

    def part(child: ast.AST) -> Any:
        return _checked(child, text, names, known)

    match node:
        case ast.Constant(value=bool()):
            pass
        case ast.Constant(value=int() | float() as value):
            return float(value)
        case ast.Name(id=name) if name in names:
            return name
        case ast.Name(id=name) if name in known:
            return float(known[name])
        case ast.Name(id=name):
            raise SceneError(f"formula {text!r}: unknown name {name!r}; it may use {', '.join((*names, *known))}")
        case ast.UnaryOp(op=ast.UAdd(), operand=operand):
            return part(operand)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return _folded(operator.neg, part(operand))
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
            return _folded(_BINARY[type(op)], part(left), part(right))
        case ast.Compare(left=left, ops=[op], comparators=[right]) if type(op) in _COMPARED:
            return _COMPARED[type(op)], part(left), part(right)
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]) if name in FUNCTIONS:
            function, count = FUNCTIONS[name]
            if len(arguments) != count:
                raise SceneError(f"formula {text!r}: {name} takes {count} numbers, got {len(arguments)}")
            return function, *map(part, arguments)
        case ast.Call(func=ast.Name(id=name)) if name not in FUNCTIONS:
            raise SceneError(f"formula {text!r}: unknown function {name!r}; it may use {', '.join(FUNCTIONS)}")
    found = ast.get_source_segment(text.replace("^", "**"), node) or type(node).__name__  # type: ignore[arg-type]
    raise SceneError(
        f"formula {text!r}: {found!r} is not arithmetic; it may hold numbers, names, + - * / ^ and functions"
    )


def _folded(operation: Callable[..., Any], *operands: Any) -> Any:
    """An operation, done at once on numbers; a whole power is kept whole, whose derivative exists at 0 and below."""
    if all(isinstance(operand, float) for operand in operands):
        value = operation(*operands)
        if not isinstance(value, float) or not math.isfinite(value):
            raise ValueError("a part of it is not a finite number")
        return value
    if operation is operator.pow and isinstance(operands[1], float) and operands[1].is_integer():
        return operation, operands[0], int(operands[1])
    return operation, *operands


def _value(tree: Any, library: Any, values: Mapping[str, Any]) -> Any:
    if isinstance(tree, str):
        return values[tree]
    if isinstance(tree, float | int):
        return tree
    operation, *operands = tree
    function = getattr(library, operation) if isinstance(operation, str) else operation
    return function(*(_value(operand, library, values) for operand in operands))

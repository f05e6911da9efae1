"""`where` and `derive`: conditions and formulas over parameters, read by Python's grammar but never evaluated by Python: only the nodes below are walked.

Formulas: + - * / **, numbers, names (short names or dotted paths, entries of lists as `loads[0]` or `loads.0`), pi, and the functions below. Conditions: also
comparisons, and or not, text.
Every number is a float, so that no power takes long; text is compared and never reckoned with; what is no number (NaN, complex) is an error.
"""

import ast
import math
import operator
import re
from collections.abc import Callable, Mapping
from typing import Any

MOST_LETTERS = 1000
MOST_LEVELS = 100  # of brackets, signs and terms in each other: what is deeper would end in Python's own limit
COMPARE = {ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt, ast.GtE: operator.ge, ast.Eq: operator.eq, ast.NotEq: operator.ne}
BINARY: dict[type, Callable] = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv, ast.Pow: operator.pow}
UNARY: dict[type, Callable] = {ast.USub: operator.neg, ast.UAdd: operator.pos, ast.Not: operator.not_}
FUNCTIONS: dict[str, Callable] = {name: getattr(math, name) for name in ("sqrt", "exp", "log", "log10", "sin", "cos", "tan", "atan")}
FUNCTIONS |= {"floor": math.floor, "ceil": math.ceil, "abs": abs, "min": min, "max": max}
ARGUMENTS = {"log": (1, 2), "min": (2, 100), "max": (2, 100)}  # one unless named here
FORMULA = f"+ - * / **, numbers, pi, {', '.join(FUNCTIONS)} and names of parameters"
ALLOWED = "comparisons (< <= > >= == !=), and, or, not, + - * / **, numbers, text, functions and names of parameters"


class ConditionError(ValueError):
    """A condition that cannot be read, or that fails on a point."""


class Formula:
    """A formula and the names it uses; call it with a mapping of their values for a number."""

    what, allowed = "formula", FORMULA

    def __init__(self, text: str):
        if len(text) > MOST_LETTERS:
            raise ConditionError(f"the {self.what} is longer than {MOST_LETTERS} letters")
        try:
            tree = ast.parse(indexed(text.strip()), mode="eval")
        except (SyntaxError, ValueError, MemoryError, RecursionError) as error:
            raise ConditionError(f"this is no {self.what}: {getattr(error, 'msg', None) or error}") from None
        if levels(tree.body) > MOST_LEVELS:
            raise ConditionError(f"the {self.what} has more than {MOST_LEVELS} levels of brackets, signs and terms")
        self.names: dict[str, None] = {}
        try:
            self.run = self.build(tree.body)
        except RecursionError:
            raise ConditionError(f"the {self.what} is nested too deeply") from None
        self.check(tree.body)

    def check(self, node: ast.AST) -> None:
        """Anything about the whole."""

    def __call__(self, values: Mapping[str, Any]) -> Any:
        value = self.evaluate(values)
        if not isinstance(value, float):
            raise ConditionError(f"the formula gives no number on this point ({value!r})")
        return value

    def evaluate(self, values: Mapping[str, Any]) -> Any:
        """The value on a point."""
        try:
            return self.run(values)
        except OverflowError:
            raise ConditionError(f"the {self.what} fails on this point: a number is too large") from None
        except (TypeError, ValueError, ZeroDivisionError) as error:
            raise ConditionError(f"the {self.what} fails on this point: {error}") from None

    def build(self, node: ast.AST) -> Callable[[Mapping[str, Any]], Any]:
        """A function of the values for one node of the tree."""
        if isinstance(node, ast.Constant) and isinstance(node.value, int | float | str) and not isinstance(node.value, bool):
            try:
                value = node.value if isinstance(node.value, str) else float(node.value)  # floats: powers overflow at once
            except OverflowError:
                raise ConditionError("a number is too large") from None
            return lambda values: value
        if isinstance(node, ast.Call):
            return self.call(node)
        if isinstance(node, ast.Name) and node.id == "pi":
            return lambda values: math.pi
        if isinstance(node, ast.Name | ast.Attribute | ast.Subscript):
            name = dotted(node, self.what)
            self.names[name] = None
            return lambda values: values[name]
        number = self.number
        if isinstance(node, ast.UnaryOp) and type(node.op) in UNARY:
            do, inner = UNARY[type(node.op)], self.build(node.operand)
            return lambda values: number(do(number(inner(values))))
        if isinstance(node, ast.BinOp) and type(node.op) in BINARY:
            do, left, right = BINARY[type(node.op)], self.build(node.left), self.build(node.right)
            return lambda values: number(do(number(left(values)), number(right(values))))
        raise ConditionError(f"a {self.what} may not hold {ast.unparse(node)[:60]!r}")

    def call(self, node: ast.Call) -> Callable[[Mapping[str, Any]], Any]:
        """One of the functions that are known."""
        if not isinstance(node.func, ast.Name) or node.func.id not in FUNCTIONS or node.keywords:
            raise ConditionError(f"a {self.what} may not hold {ast.unparse(node)[:60]!r}")
        least, most = ARGUMENTS.get(node.func.id, (1, 1))
        if not least <= len(node.args) <= most:
            wanted = f"{least}" if least == most else f"{least} or more" if most > 2 else f"{least} or {most}"
            raise ConditionError(f"{node.func.id} takes {wanted} argument{'s' * (wanted != '1')}, found {len(node.args)}")
        do, given, number = FUNCTIONS[node.func.id], [self.build(item) for item in node.args], self.number
        return lambda values: number(do(*(number(one(values)) for one in given)))

    @staticmethod
    def number(value: Any) -> Any:
        """A value that is reckoned with, as a float."""
        if not isinstance(value, float | int):
            raise TypeError(f"{value!r} is no number" if isinstance(value, str) else "it gives no number but a complex one: the root of a negative number")
        if math.isnan(value):
            raise ValueError("it gives no number, as inf - inf does")
        return float(value)


class Condition(Formula):
    """A condition and the names it uses; call it with a mapping of their values for yes or no."""

    what, allowed = "condition", ALLOWED

    def check(self, node: ast.AST) -> None:
        """A number alone is no condition."""
        if not isinstance(node, ast.Compare | ast.BoolOp | ast.UnaryOp) or (isinstance(node, ast.UnaryOp) and not isinstance(node.op, ast.Not)):
            raise ConditionError("a condition compares something, as in kappa > 0.3")

    def __call__(self, values: Mapping[str, Any]) -> bool:
        return bool(self.evaluate(values))

    def build(self, node: ast.AST) -> Callable[[Mapping[str, Any]], Any]:
        """Also comparisons and their joints."""
        if isinstance(node, ast.BoolOp):
            parts, stop = [self.build(item) for item in node.values], isinstance(node.op, ast.Or)
            return lambda values: any(part(values) for part in parts) if stop else all(part(values) for part in parts)
        if isinstance(node, ast.Compare) and all(type(op) in COMPARE for op in node.ops):
            terms, does = [self.build(item) for item in (node.left, *node.comparators)], [COMPARE[type(op)] for op in node.ops]
            return lambda values: all(do(*self.alike(left(values), right(values))) for do, left, right in zip(does, terms, terms[1:], strict=False))
        return super().build(node)

    def alike(self, left: Any, right: Any) -> tuple[Any, Any]:
        """Two texts, or two numbers: a text and a number never compare."""
        if isinstance(left, str) and isinstance(right, str):
            return left, right
        return self.number(left), self.number(right)


def indexed(text: str) -> str:
    """`loads.0.value` as `loads[0].value`, which Python can read; text in quotes stays as it is."""
    change = lambda match: match[0] if match[0][0] in "'\"" else re.sub(r"\.(\d+)(?![\w])", r"[\1]", match[0])  # noqa: E731
    return re.sub(r"""'[^']*'|"[^"]*"|(?<![\w.])[^\W\d]\w*(?:\.\w+|\[\d+\])+""", change, text)


def levels(tree: ast.AST) -> int:
    """How deep a tree is."""
    deepest, left = 0, [(tree, 1)]
    while left:
        node, depth = left.pop()
        deepest = max(deepest, depth)
        left += [(child, depth + 1) for child in ast.iter_child_nodes(node) if not isinstance(node, ast.Attribute | ast.Subscript)]
    return deepest


def dotted(node: ast.AST, what: str = "condition") -> str:
    """`materials.dough.heat.fourier.kappa` from nested attributes, `loads[0].value` as `loads.0.value`."""
    parts: list[str] = []
    whole = node
    while isinstance(node, ast.Attribute | ast.Subscript):
        if isinstance(node, ast.Attribute):
            parts.append(node.attr)
        elif isinstance(node.slice, ast.Constant) and type(node.slice.value) is int:
            parts.append(str(node.slice.value))
        else:
            break
        node = node.value
    if not isinstance(node, ast.Name):
        raise ConditionError(f"a {what} may not hold {ast.unparse(whole)[:60]!r}")
    return ".".join([node.id, *reversed(parts)])

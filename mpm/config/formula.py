"""A formula of one variable x, for lines of theory: read by Python's grammar, never evaluated by Python (config/condition.py walks the tree)."""

import ast
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from mpm.config.condition import COMPARE, Condition, ConditionError

FUNCTIONS = {"sqrt": np.sqrt, "exp": np.exp, "log": np.log, "abs": np.abs, "min": np.minimum, "max": np.maximum}
ALLOWED = f"+ - * / **, numbers, x, pi, and {', '.join(FUNCTIONS)}"


class Formula(Condition):
    """Numbers, x, pi, + - * / ** and a few functions; call it with x, a number or an array."""

    what = "formula"

    def __call__(self, x: Any) -> Any:
        with np.errstate(all="ignore"):
            return self.run({"x": np.asarray(x, dtype=float)})

    @staticmethod
    def number(value: Any) -> Any:
        """Arrays and numbers by numpy's rules: what has no value is NaN or infinite, and leaves a gap in the line."""
        return np.asarray(value, dtype=float)

    def check(self, body: ast.AST) -> None:
        """Only names that mean something, and no comparisons."""
        for node in ast.walk(body):
            if isinstance(node, ast.BoolOp | ast.Not) or (isinstance(node, ast.Constant) and isinstance(node.value, str)):
                raise ConditionError(f"a formula may not hold {ast.unparse(node)[:60]!r}" if not isinstance(node, ast.Not) else "a formula may not hold 'not'")
            if isinstance(node, ast.Compare) and any(type(op) in COMPARE for op in node.ops):
                raise ConditionError("a formula gives a number, it does not compare")
        unknown = [name for name in self.names if name != "x"]
        if unknown:
            raise ConditionError(f"a formula knows x and pi, not {unknown[0]!r}")

    def build(self, node: ast.AST) -> Callable[[Mapping[str, Any]], Any]:
        """As a condition, and calls of the functions above."""
        if isinstance(node, ast.Call):
            name = node.func.id if isinstance(node.func, ast.Name) else ""
            count = 2 if name in ("min", "max") else 1
            if name not in FUNCTIONS or node.keywords or len(node.args) != count:
                raise ConditionError(f"a formula may not hold {ast.unparse(node)[:60]!r}")
            do, parts = FUNCTIONS[name], [self.build(item) for item in node.args]
            return lambda values: do(*(self.number(part(values)) for part in parts))
        return super().build(node)

"""Sums that have the same bits wherever their arrays lie."""

import ast
from pathlib import Path

import numpy as np

from mpm.rigid.ordered import combined, dot

ROOT = Path(__file__).parent.parent
LONG = ("n", "N", "len(h)", "len(each)")  # how loops over all nodes or particles are written
ROOMS = ("rigid", "integrate", "materials", "heat", "total", "contact", "point")


def placed(array, shift):
    """The same numbers, `shift` bytes further on."""
    room = np.zeros(array.nbytes + shift, np.uint8)[shift : shift + array.nbytes].view(array.dtype).reshape(array.shape)
    room[...] = array
    return room


def test_products_do_not_depend_on_place():
    rng = np.random.default_rng(1)
    weights, columns = rng.normal(size=(5, 3)), rng.normal(size=(3, 37))
    near = combined(weights, columns)
    assert np.allclose(near, weights @ columns, rtol=1e-14, atol=1e-14) and np.isclose(dot(columns[0], columns[1]), columns[0] @ columns[1], rtol=1e-14)
    for shift in range(8, 72, 8):
        assert combined(placed(weights, shift), placed(columns, 3 * shift)).tobytes() == near.tobytes()
        assert dot(placed(columns[0], shift), placed(columns[1], 5 * shift)) == dot(columns[0], columns[1])


def mixed(source):
    """Lines of inner loops over all nodes or particles that both add up and store, of compiled functions."""
    for function in ast.walk(ast.parse(source)):
        if not isinstance(function, ast.FunctionDef) or not any(word in ast.unparse(one) for one in function.decorator_list for word in ("kernel", "register")):
            continue
        for loop in ast.walk(function):
            if not isinstance(loop, ast.For) or ast.unparse(loop.iter) not in {f"range({long})" for long in LONG}:
                continue
            inner = [node for line in loop.body for node in ast.walk(line)]
            adds = any(isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name) and not isinstance(node.value, ast.Constant) for node in inner)
            stores = any(isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Store) for node in inner)
            if adds and stores and not any(isinstance(node, ast.For | ast.While) for node in inner):
                yield loop.lineno


def test_loops_that_add_up_store_nothing():
    found = [f"{path}:{line}" for room in ROOMS for path in sorted((ROOT / "mpm" / room).glob("*.py")) for line in mixed(path.read_text(encoding="utf-8"))]
    assert not found


def test_mixed_loops_are_found():
    text = "@kernel\ndef f(x, y):\n    total = 0.0\n    for i in range(n):\n        y[i] = x[i]\n        total += x[i]\n    return total\n"
    assert list(mixed(text)) == [4] and not list(mixed(text.replace("        total", "    for i in range(n):\n        total")))

"""Compiling a kernel in less time (`.ci/compile_times.py` measures it): replacements of methods of Numba and llvmlite, installed by mpm.linking for the
versions that it was tested with. They act while a kernel of ours is built.

May use   numba, llvmlite                        May not  change what a kernel computes
To add    a function that gives what the stock one gives, in a line of SHORTCUTS of its module: tests/test_linking.py compares the code

Further files
    building     whether a kernel is being built
    once         what Numba works out anew for every instruction
    registers    arrays and tuples as values, without memory
    lent         variables as values; arrays of arguments, whose users are not counted: fewer instructions, so not in SHORTCUTS
"""

from mpm.shortcuts import once, registers
from mpm.shortcuts.building import building, stock
from mpm.shortcuts.lent import LENT

SHORTCUTS = once.SHORTCUTS + registers.SHORTCUTS  # the same code, to the instruction

__all__ = ["LENT", "SHORTCUTS", "building", "stock"]

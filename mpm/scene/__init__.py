"""Scenes: from a validated config to bodies, grids and quadratures.

shapes      Box, Ball, Cylinder, Ring, Polygon: signed distance, bounds, cut quadrature, cut cells
cut         exact quadrature of a shape cut by a grid
contents    what each cell holds of a shape, and one particle a cell
"""

from mpm.scene.contents import CutCells
from mpm.scene.cut import Quadrature, Surface
from mpm.scene.shapes import Ball, Box, Cylinder, Polygon, Ring, cells, cut_quadrature, on_side, shape

__all__ = ["Ball", "Box", "CutCells", "Cylinder", "Polygon", "Quadrature", "Ring", "Surface", "cells", "cut_quadrature", "on_side", "shape"]

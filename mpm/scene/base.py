"""Shape: where a body is, the role of every shape (mpm.scene.shapes, mpm.scene.mesh).

Role   distance(x (N, d)) -> (N,) [m], negative inside;  bounds() -> (lower, upper);  moved(shift) -> the same shape elsewhere
       cut(edges, order) -> (Quadrature, Surface): exact volume and surface points, cell by cell (mpm.scene.cut)
       contents(edges, radial) -> what each cell holds of it (mpm.scene.contents), by the cells that the surface crosses
Space  coordinates of the scene: (x), (x, y), (r, z) or (x, y, z). Weights are plain lengths, areas, volumes: an axisymmetric caller multiplies by r,
       which also takes away the part of a boundary that lies on the axis.
"""

import numpy as np

from mpm.scene import cut as cutting
from mpm.scene.contents import stacked, weigh
from mpm.scene.cut_boundary import plane
from mpm.scene.sides import on_side


class Shape:
    """What every shape shares."""

    @property
    def dimension(self) -> int:
        return len(self.bounds()[0])

    def inside(self, x: np.ndarray) -> np.ndarray:
        return self.distance(x) < 0

    def faces(self, surface, side: str, plane: bool = False) -> np.ndarray:
        """Which pieces of the shape's surface lie on a side: by `normal` (N, d), or by the number `side` (N,) of the smooth side that a piece lies on.

        In the plane inner and outer are those of a ring; else they face the axis, or away from it.
        """
        number = self.smooth_side(side, plane)
        return on_side(surface.normal, side) if number is None else surface.side == number

    def smooth_side(self, side: str, plane: bool) -> int | None:
        """The number of the smooth side that is called so; None for a side that is told by normals."""
        return None

    def pieces(self):
        """Boundary of a plane shape, the inside on the left."""
        raise NotImplementedError(f"{type(self).__name__} is not a plane shape")

    def prism(self):
        """(plane base, lowest, highest) of a body that is the same at every height; None for any other."""
        return None

    def cuts(self, edges, order: int):
        """Cuts (mpm.scene.cut.Cut) that make up the shape; no prism is asked."""
        return (plane(self.pieces(), self.distance, edges, order),)

    def cut(self, edges, order: int = 4):
        if len(edges) != self.dimension:
            raise ValueError(f"a shape in {self.dimension} directions, edges in {len(edges)}")
        if (prism := self.prism()) is None:
            return cutting.flat(self.cuts(edges, order), edges, order)
        base, low, high = prism
        upright = cutting.flat((cutting.line(low, high, edges[2], order),), edges[2:], order)
        return cutting.extrude(base.cut(edges[:2], order), upright, len(edges[2]) - 1)

    def contents(self, edges, radial: bool = False):
        """Volumes and first moments, with the weight r where `radial`: of order 2."""
        if (prism := self.prism()) is None:
            return weigh(self.cuts(edges, 2), edges, radial)
        base, low, high = prism
        return stacked(base.contents(edges[:2]), weigh((cutting.line(low, high, edges[2], 2),), edges[2:]), len(edges[2]) - 1)

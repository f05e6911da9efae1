"""Scenes: from a validated config to bodies, grids and quadratures.

shapes      Box, Ball, Cylinder, Ring, Polygon: signed distance, bounds, cut quadrature, cut cells
cut         exact quadrature of a shape cut by a grid
contents    what each cell holds of a shape, and one particle a cell

Further files
    asked              what a config asks of walls and pairs that never meet
    base               Shape, the role of every shape
    bearing            what bears a body: sides that it lies on, sides that hold it, how far it bends from them
    build              from a validated experiment to a scene of moving bodies
    conventions        what a dimension brings
    course             what a config lets change over time beside heat
    cut_boundary       plane regions on a grid
    exchange           surfaces of a config
    faded              tractions as the stress that they ask for, faded out inside
    fracture_surface   faces between the particle cells of a body that may tear
    framing            which frame `method.frame: auto` takes, and why
    groups             the dimensionless groups of a scene
    implicit           how a scene that asks for implicit mechanics begins
    inflow             inflow of a config
    inventory          what a config holds, from the config alone
    law                laws of materials
    meeting            which bodies of a config can meet which walls and each other, and the pieces of surface that they meet by
    mesh               closed triangle meshes as shapes
    menus              what the kinds of a menu of the config are to solvers
    outline            the outline of a sampled body
    over               from the total frame to the updated one within a run
    point              material points from validated experiments, and their Runs
    refusal            the error of a config that is valid but that no method here can run, and its place in the config
    rigid              A rigid scene from a validated experiment, and its Run
    scales             the scales of a scene's bodies, from the config alone
    scaling            slow scenes on a fast clock
    sides              sides of a surface by its outward normals
    sources            sources of a config
    sphere             exact quadrature of a ball cut by a three-dimensional grid
    still              bodies that do not move
    tools              tools of a config
    total              bodies of a config in the total frame
    traction           loads of a config to the run-time Load of a body
    weight             gravity of a config as one number a direction
"""

from mpm.scene.contents import CutCells
from mpm.scene.cut import Quadrature, Surface
from mpm.scene.shapes import Ball, Box, Cylinder, Polygon, Ring, cells, cut_quadrature, shape
from mpm.scene.sides import on_side

__all__ = ["Ball", "Box", "CutCells", "Cylinder", "Polygon", "Quadrature", "Ring", "Surface", "cells", "cut_quadrature", "on_side", "shape"]

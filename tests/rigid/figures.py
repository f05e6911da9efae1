"""The tables of rigid heat: `python tests/rigid/figures.py`. Not a test; seconds are the best of five, geometry kept between them."""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from conftest import cylinder, rms, slab, sphere
from test_loaf import MEASURED, by_the_minute, loaf

from mpm.rigid import Method, RigidBody, solve
from mpm.scene import Ball, Box

PROBE = ("centre", 368.15)
BIOTS = (0.1, 1.0, 10.0, np.inf)


def best(run, times=5):
    runs = [run() for _ in range(times)]
    return runs[0], 1e3 * min(r.wall_time for r in runs)


def unit(shape, bi):
    return [RigidBody(shape, 1.0, 1.0, 1.0, 1.0, (("all", bi, 0.0),))]


def slabs():
    print("slab, worst of five offsets, t = 0.2: rms error at n = 8, 16, 32, 64 (steps)")
    for name, method, biots in (
        ("implicit 1e-6", Method("implicit", tolerance=1e-6), BIOTS),
        ("implicit 1e-4", Method("implicit"), BIOTS),
        ("explicit 1e-6", Method("explicit", tolerance=1e-6), BIOTS[:3]),
    ):
        for bi in biots:
            row = []
            for n in (8, 16, 32, 64):
                runs = [solve(unit(Box((-1.0,), (1.0,)), bi), 1, 1 / n, [o / n], end=0.2, method=method) for o in (0, 0.13, 0.29, 0.5, 0.77)]
                row.append(f"{max(rms(r, lambda x, bi=bi: slab(x, 0.2, bi), lambda x: x[:, 0]) for r in runs):.1e} ({max(r.steps for r in runs)})")
            print(f"  {name}  Bi {bi:4g}  {'  '.join(row)}")


def discs():
    print("disc, t = 0.2: rms error, ms at n = 3, 4, 6, 8, 12 cells a radius")
    for name, method in (("4 steps", Method(step=0.05)), ("8 steps", Method(step=0.025)), ("1e-4", Method()), ("explicit 1e-4", Method("explicit"))):
        for bi in BIOTS[1:] if name[0] != "e" else BIOTS[1:3]:
            row = []
            for n in (3, 4, 6, 8, 12):
                run, ms = best(lambda n=n, bi=bi, method=method: solve(unit(Ball((0.013, 0.021), 1.0), bi), 2, 1 / n, end=0.2, method=method))
                error = rms(run, lambda r, bi=bi: cylinder(r, 0.2, bi), lambda x: np.hypot(x[:, 0] - 0.013, x[:, 1] - 0.021))
                row.append(f"{error:.1e} {ms:.1f}")
            print(f"  {name:13s} Bi {bi:4g}  {'   '.join(row)}")


def spheres():
    print("sphere, 6 cells a radius, t = 0.2: rms error, steps, ms")
    centre = np.array([0.013, 0.021, 0.037])
    for bi in BIOTS[1:]:
        run, ms = best(lambda bi=bi: solve(unit(Ball(tuple(centre), 1.0), bi), 3, 1 / 6, end=0.2), 2)
        flat, flat_ms = best(lambda bi=bi: solve(unit(Ball((0.0, 0.021), 1.0), bi), "axisymmetric", 1 / 6, end=0.2))
        errors = [
            rms(run, lambda r, bi=bi: sphere(r, 0.2, bi), lambda x: np.linalg.norm(x - centre, axis=1)),
            rms(flat, lambda r, bi=bi: sphere(r, 0.2, bi), lambda x: np.hypot(x[:, 0], x[:, 1] - 0.021)),
        ]
        print(f"  Bi {bi:4g}  3-D {errors[0]:.1e} {run.steps} {ms:.0f} ({run.unknowns} unknowns)", end="   ")
        print(f"axisymmetric {errors[1]:.1e} {flat.steps} {flat_ms:.1f} ({flat.unknowns})")


def loaves(cells=(2e-3, 1e-3, 0.5e-3)):
    print("loaf, 780 s: cell, method, order, tolerance: time to 95 degC, rmse centre and surface, steps, ms")
    choices = [("explicit", 2, t) for t in (1e-2, 1e-3, 1e-4)] + [("implicit", o, t) for o in (2, 4) for t in (1e-2, 1e-3)]
    for cell in cells:
        for kind, order, tolerance in choices:
            if kind == "implicit" and cell < 1e-3:
                continue
            run, ms = best(lambda c=cell, k=kind, o=order, t=tolerance: loaf(c, Method(k, 4 if k == "explicit" else o, t)), 5 if kind == "explicit" else 2)
            errors = [np.sqrt(np.mean((found - MEASURED[:, k]) ** 2)) for found, k in zip(by_the_minute(run), (1, 2), strict=True)]
            print(
                f"  {1e3 * cell:.1f} mm {kind} {order} {tolerance:.0e}  {run.crossings[PROBE]:.2f} s  {errors[0]:.2f} {errors[1]:.2f}  {run.steps}  {ms:.0f}",
                flush=True,
            )


if __name__ == "__main__":
    slabs()
    discs()
    spheres()
    loaves()

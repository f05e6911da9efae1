"""Triangle meshes as shapes: read and checked, cut as the shapes that they are, distances against formulas, and what is refused."""

import copy
import itertools

import numpy as np
import pytest

import mpm
from mpm.config.meshes import Unfit, checked
from mpm.contact.triangles import new_triangles, signed_to, together
from mpm.runner import run_named
from mpm.scene.build import build
from mpm.scene.mesh import Mesh
from mpm.scene.shapes import Box, cells, cut_quadrature
from mpm.triangles import packed, unpacked

CORNERS = np.array(list(itertools.product((0.0, 1.0), repeat=3)))
FACES = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])
EDGES = [np.arange(11) * 0.1] * 3


def cube(lower, upper) -> Mesh:
    return Mesh(np.array(lower) + CORNERS * np.subtract(upper, lower), FACES)


def ball(level: int, radius: float = 1.0, centre=(0.0, 0.0, 0.0)) -> tuple[np.ndarray, np.ndarray]:
    """An octahedron whose triangles are quartered `level` times, on the sphere."""
    octant = np.eye(3)
    faces = [(octant if np.prod(signs) > 0 else octant[::-1]) * signs for signs in itertools.product((1, -1), repeat=3)]
    for _ in range(level):
        new = []
        for a, b, c in faces:
            p, q, r = ((u + v) / np.linalg.norm(u + v) for u, v in ((a, b), (b, c), (c, a)))
            new += [np.array(t) for t in ((a, p, r), (p, b, q), (r, q, c), (p, q, r))]
        faces = new
    found, index = np.unique(np.round(np.concatenate(faces), 12), axis=0, return_inverse=True)
    return found * radius + centre, index.reshape(-1, 3)


def stl(vertices, faces) -> str:
    """ASCII STL: triangles that share no corners."""
    lines = ["solid s"]
    for t in faces:
        lines += ["facet normal 0 0 0", "outer loop", *(f"vertex {' '.join(map(repr, map(float, vertices[k])))}" for k in t), "endloop", "endfacet"]
    return "\n".join([*lines, "endsolid s"])


def obj(vertices, faces) -> str:
    return "\n".join([*(f"v {' '.join(map(repr, map(float, x)))}" for x in vertices), *(f"f {' '.join(str(k + 1) for k in t)}" for t in faces)])


SCENE = """grid: {{dimension: 3, size: [1, 1, 1], cell: 0.125}}
bodies:
  toy: {{shape: {{mesh: {{file: {file}, unit: {unit}}}}}, material: m}}
materials: {{m: {{density: 2, elastic: {{hencky: {{E: 100, nu: 0.3}}}}}}}}
time: {{end: 0.1}}
"""


def scene(folder, file="toy.stl", unit="1"):
    path = folder / "scene.yaml"
    path.write_text(SCENE.format(file=file, unit=unit))
    return mpm.load(path)


@pytest.mark.parametrize("shift", [(0, 0, 0), (0.05, 0.03, 0.04), (0.0137, -0.02, 0.0)])
def test_a_cube_is_cut_as_a_box(shift):
    """Cells, volumes, centroids, pieces: to rounding, whether its faces lie on grid planes or not."""
    low, high = np.add((0.2, 0.2, 0.3), shift), np.add((0.6, 0.7, 0.6), shift)
    one, two = cells(cube(low, high), EDGES), cells(Box(tuple(low), tuple(high)), EDGES)
    assert np.array_equal(one.cell, two.cell) and one.volume == pytest.approx(two.volume, abs=1e-15) and np.abs(one.centroid - two.centroid).max() < 1e-13
    order = [np.lexsort((*np.round(c.normal.T, 9), c.owner)) for c in (one, two)]
    for name in ("owner", "area", "point", "normal"):
        assert np.abs(getattr(one, name)[order[0]] - getattr(two, name)[order[1]]).max() < 1e-13


def test_volume_centroid_and_inertia_of_a_tessellated_ball():
    """Those of its triangles, by tetrahedra from the origin, to rounding; and of the ball itself as it is refined, of order 2."""
    off = []
    for level in (2, 3):
        vertices, faces = ball(level, 0.3, (0.5, 0.49, 0.51))
        a, b, c = np.moveaxis(vertices[faces], 1, 0)
        V = np.einsum("fa,fa->f", a, np.cross(b, c)) / 6
        Q, S = cut_quadrature(Mesh(vertices, faces), EDGES, 4)
        second = sum(np.einsum("f,fa,fb->ab", V, p, q) * (2 if k == m else 1) for k, p in enumerate((a, b, c)) for m, q in enumerate((a, b, c))) / 20
        assert Q.w.sum() == pytest.approx(V.sum(), rel=1e-13) and Q.w @ Q.x == pytest.approx(V @ (a + b + c) / 4, rel=1e-12)
        assert np.einsum("q,qa,qb->ab", Q.w, Q.x, Q.x) == pytest.approx(second, rel=1e-12)
        assert S.w @ S.normal == pytest.approx(np.zeros(3), abs=1e-14) and S.w.sum() == pytest.approx(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)
        one = cells(Mesh(vertices, faces), EDGES)
        assert one.volume.min() > 0 and one.volume.sum() == pytest.approx(V.sum(), rel=1e-13)
        off.append(abs(V.sum() / (4 / 3 * np.pi * 0.027) - 1))
    assert off[1] < 0.27 * off[0] and off[0] < 0.1


def test_distances():
    """A cube's by formula, inside, outside, beyond the cells; normals by differences; a tool's the same near it, and none far away."""
    low, high = np.array([0.2, 0.3, 0.4]), np.array([0.7, 0.6, 0.9])
    x = np.random.default_rng(1).uniform(-0.5, 1.5, (200, 3))
    one, box = cube(low, high), Box(tuple(low), tuple(high))
    assert one.distance(x) == pytest.approx(box.distance(x), abs=1e-14)
    vertices, faces = ball(3, 0.3, (0.5, 0.5, 0.5))
    gap = np.linalg.norm(x - 0.5, axis=1) - 0.3
    found = Mesh(vertices, faces).distance(x)
    assert (found - gap).min() > -1e-9 and (found - gap).max() < 0.3 * 0.02
    both = together([None, one.triangles(0.1), new_triangles(vertices, faces, 0.1)])
    n, near = np.zeros(3), np.abs(box.distance(x)) < 0.09
    for y in x[near]:
        assert signed_to(both, 1, y, False, n) == pytest.approx(box.distance(y[None])[0], abs=1e-14)
        slope = [(box.distance((y + d)[None]) - box.distance((y - d)[None]))[0] / 2e-6 for d in 1e-6 * np.eye(3)]
        assert n == pytest.approx(slope, abs=1e-6) or abs(np.sort(np.abs(y - (low + high) / 2) - (high - low) / 2)[-2:]).ptp() < 1e-5
    assert signed_to(both, 2, np.array([0.5, 0.5, 0.79]), False, n) == pytest.approx(-0.01, abs=0.006) and n[2] > 0.98
    assert signed_to(both, 1, np.array([5.0, 0.5, 0.5]), False, n) > 1e299


def test_a_file_is_read_and_is_the_box(tmp_path):
    """STL without shared corners, in mm, and OBJ: the particles and pieces of the box; the config holds the triangles and no path, and its point their sum."""
    vertices = 1e3 * (0.25 + 0.3 * CORNERS)
    (tmp_path / "toy.stl").write_text(stl(vertices, FACES[:, ::-1]))  # inside out: turned round
    (tmp_path / "toy.obj").write_text(obj(vertices, FACES))
    by = [scene(tmp_path, file, "1 mm") for file in ("toy.stl", "toy.obj")]
    data = by[0].resolved()
    data["bodies"]["toy"]["shape"] = {"box": {"lower": [0.25] * 3, "upper": [0.55] * 3}}
    box = build(mpm.load(data)).bodies[0]
    for one in by:
        body = build(one).bodies[0]
        assert body.particles.x == pytest.approx(box.particles.x, abs=1e-7) and body.particles.m == pytest.approx(box.particles.m, rel=1e-5)
    text = by[0].resolved()
    assert mpm.load(text).run_id == by[0].run_id and str(tmp_path) not in str(text)
    (tmp_path / "toy.stl").write_text(stl(vertices * 1.01, FACES))
    assert scene(tmp_path, "toy.stl", "1 mm").run_id != by[0].run_id
    again = unpacked(packed(vertices, FACES))
    assert np.array_equal(again[0], vertices) and np.array_equal(again[1], FACES)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda v, f: (v, f[1:]), "is not closed: 3 of its edges"),
        (lambda v, f: (v, np.concatenate([f[:1, ::-1], f[1:]])), "face different ways"),
        (lambda v, f: (np.concatenate([v, v + 0.5]), np.concatenate([f, f + 8])), "crosses itself, near"),
        (lambda v, f: (v, np.zeros((0, 3), int)), "holds no triangles"),
        (lambda v, f: (v * [1, 1, 1e-12], f), "holds no volume"),
    ],
)
def test_meshes_that_are_no_bodies(change, said):
    with pytest.raises(Unfit, match=said):
        checked(*change(CORNERS.copy(), FACES.copy()), "toy.stl")


def test_what_is_wrong_has_a_place(tmp_path):
    """A file that is not there, no mesh, open, too large for the domain, in a plane scene."""
    (tmp_path / "open.stl").write_text(stl(CORNERS, FACES[1:]))
    (tmp_path / "large.obj").write_text(obj(CORNERS * 2, FACES))
    (tmp_path / "text.stl").write_text("hello")
    (tmp_path / "toy.step").write_text("hello")
    told = {"none.stl": "cannot read 'none.stl'", "open.stl": "is not closed", "text.stl": "text.stl", "toy.step": "no file of triangles that is known",
            "large.obj": "leaves the domain"}  # fmt: skip
    for file, said in told.items():
        with pytest.raises(mpm.ConfigError, match=said) as found:
            scene(tmp_path, file)
        assert "scene.yaml:3:" in str(found.value), str(found.value)
    plane = copy.deepcopy(mpm.load(tmp_path / "scene.yaml", overrides={"bodies.toy.shape": {"ball": {"centre": [0.5] * 3, "radius": 0.2}}}).resolved())
    plane["grid"] |= {"dimension": 2, "size": [1, 1]}
    plane["method"]["offset"], plane["bodies"]["toy"]["shape"] = [0, 0], {"mesh": {"file": "toy.stl"}}
    with pytest.raises(mpm.ConfigError, match="there is no mesh in dimension 2"):
        mpm.load(plane)


@pytest.mark.slow
def test_a_ball_of_triangles_warms_as_the_ball():
    """512 triangles of the ball's volume, eight cells across, heat alone by implicit steps: mean temperature within 0.5 % of the rise."""
    vertices, faces = ball(3)
    volume = np.einsum("fa,fa->", vertices[faces][:, 0], np.cross(vertices[faces][:, 1], vertices[faces][:, 2])) / 6
    round_one = {"ball": {"centre": [0.5] * 3, "radius": 0.3}}
    tessellated = {"mesh": {"file": "ball.stl", "data": packed(0.5 + 0.3 * (4 / 3 * np.pi / volume) ** (1 / 3) * vertices, faces)}}
    found = []
    for shape in (round_one, tessellated):
        scene = {
            "grid": {"dimension": 3, "size": [14 * 0.075] * 3, "cell": 0.075},
            "bodies": {"b": {"shape": shape, "temperature": 300, "material": "m"}},
            "materials": {"m": {"density": 1, "heat": {"fourier": {"kappa": 1, "alpha": 1}}}},
            "surfaces": [{"of": "b", "convection": {"beta": 5, "outside": 400}}],
            "time": {"end": 0.05}, "output": {"every": 0.01}, "method": {"rigid": "implicit"},
        }  # fmt: skip
        run = run_named(mpm.load(scene))
        assert run.outcome.ok, run.outcome
        found.append(run.series["temperature_mean"])
    assert found[1][-1] - 300 == pytest.approx(found[0][-1] - 300, rel=5e-3)

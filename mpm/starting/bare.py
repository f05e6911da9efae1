"""A commented config of a dimension and of some physics: the least that runs, to be filled with a user's own numbers."""

import re

PHYSICS = ("heat", "elastic", "flow", "expansion")
NEEDS = {"flow": ("elastic",), "expansion": ("elastic", "heat")}
DIMENSIONS = ("0", "1", "2", "axisymmetric", "3")
SHAPES = {
    "0": "point",
    "1": "{box: {lower: [0], upper: [20 mm]}}",
    "2": "{box: {lower: [0, 0], upper: [20 mm, 20 mm]}}  # also ball, ring, polygon",
    "axisymmetric": "{cylinder: {radius: 20 mm, height: 20 mm, base: [0, 0]}}  # coordinates are r and z; also box, ball, ring, polygon",
    "3": "{box: {lower: [0, 0, 0], upper: [20 mm, 20 mm, 20 mm]}}  # also ball, cylinder",
}
SIDES = {"1": "left", "2": "bottom", "axisymmetric": "bottom", "3": "bottom"}
DIRECTIONS = {"0": 0, "1": 1, "2": 2, "axisymmetric": 2, "3": 3}
MATERIAL = {
    "elastic": ("    elastic: {hencky: {E: 12 kPa, nu: 0.15}}  # with this section the body moves\n"),
    "flow": ("    flow: {ellipse: {M: 300 Pa, p0: 0.6, eta: 200}}  # yield stress in shear (von Mises), yield pressure over M, viscosity [Pa s]\n"),
    "heat": "    heat: {fourier: {kappa: 0.35, alpha: 2300}}  # conductivity [W/m/K], specific heat [J/kg/K]; a law of temperature may stand in its place\n",
    "expansion": "    expansion: {linear: {coefficient: 1e-4, reference: 25 degC}}  # [1/K]\n",
}


def whole(physics: list[str]) -> list[str]:
    """The physics with what it needs, in the order of the config."""
    wanted = set(physics) | {need for one in physics for need in NEEDS.get(one, ())}
    return [one for one in PHYSICS if one in wanted]


def bare(dimension: str, physics: list[str]) -> str:
    """The config's text. `dimension` is one of DIMENSIONS, `physics` are some of PHYSICS."""
    physics, n = whole(physics), DIRECTIONS[dimension]
    heat, moves, flows = "heat" in physics, "elastic" in physics, "flow" in physics
    point = dimension == "0"
    end = "60" if point and flows else "1" if moves and not point else "20 min" if heat else "10"
    lines = [
        "# Purpose  what do you want to know?\n",
        "# Cost     see `mpm plan` for this config\n",
        "# Source   where do the numbers come from? Those below are of the order of a bread dough, and stand for your own.\n",
        f'title: "My experiment: {", ".join(physics)}"\n',
        "# Numbers are SI. Text may have any unit: 2 mm, 190 degC, 0.35 W/m/K. A section that is absent is physics that does not exist.\n",
        "grid: {dimension: 0}  # a material point: no grid\n"
        if point
        else f"grid: {{dimension: {dimension}, size: [{', '.join(['40 mm'] * n)}], cell: 2 mm}}  # begins at 0; a finer cell costs more and errs less\n",
        "bodies:\n  body:\n",
        f"    shape: {'{point: {surface_to_volume: 300}}  # its surface over its volume [1/m]' if point and heat else SHAPES[dimension]}\n",
        *(["    temperature: 25 degC  # at the start\n"] if heat else []),
        "    material: dough\n",
        "materials:\n  dough:\n    density: 500\n",
        *(MATERIAL[one] for one in ("elastic", "flow", "heat", "expansion") if one in physics),
    ]
    if heat:
        lines.append("surfaces:\n  - {of: body, convection: {beta: 20, outside: 190 degC}}  # also fixed, flux, radiation; of one side: side: top\n")
    if moves and not point:
        lines.append(f"walls: {{{SIDES[dimension]}: stick}}  # sides that are not named let the body slide along them\n")
        lines.append(f"gravity: [{', '.join([*['0'] * (n - 1), '-9.81'])}]\n")
    if moves and point:
        lines.append("loading:  # pressed to 80 % of its height, then held; free at the sides\n")
        lines.append("  - {until: 5, strain_rate: {zz: -0.04}, stress: {xx: 0, yy: 0}}\n  - {stress: {xx: 0, yy: 0}}\n")
    stepping = "  # steps choose themselves; for minutes of motion see method.mechanics and time.scale" if moves and not point else ""
    lines.append(f"time: {{end: {end}}}{stepping}\n")
    return aligned("".join(lines + output(dimension, heat, moves)))


def aligned(text: str) -> str:
    """Comments behind what they are of, in one column."""
    return re.sub(r"^(.*\S)  (# .*)$", lambda line: f"{line[1]:<70}  {line[2]}", text, flags=re.MULTILINE)


def output(dimension: str, heat: bool, moves: bool) -> list[str]:
    """What is recorded, what varies, and the short form."""
    centre = f"[{', '.join(['0' if dimension == 'axisymmetric' and k == 0 else '10 mm' for k in range(DIRECTIONS[dimension])])}]"
    point = dimension == "0"
    probe = heat and not point
    names = (["temperature.mean"] if heat else []) + (["time_to.centre.60_degC"] if probe and not moves else [])
    names += ["stress.zz", "strain.zz"] if moves and point else []
    if moves and not point:
        names += [f"position.max_{({'1': 'x', '2': 'y'}).get(dimension, 'z')}", "velocity.max", "energy.kinetic"]
    axis = "beta: [10, 20, 40]" if heat else "E: [6 kPa, 12 kPa]"
    return [
        "output:  # `every` may say how often; a hundredth of the run unless given\n",
        *([f"  probes: {{centre: {centre}}}  # points that are followed, by name\n"] if probe else []),
        f"  observables: [{', '.join(names)}]  # mpm explain observables lists them\n",
        "sweep:  # what varies; mpm sweep runs every combination, mpm run the first\n",
        f"  axes: {{{axis}}}\n",
        f"smoke: {{time.end: {'0.05' if moves and not point else '10'}}}\n",
    ]

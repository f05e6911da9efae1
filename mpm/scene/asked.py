"""What a config asks of walls and pairs that its bodies never meet: nothing acts there, and that is told; or refused where it is not known."""

from mpm.boundary import CONTACT
from mpm.scene.refusal import SceneError

TOLD = ("force", "torque", "area")


def unmet(experiment, meets, sides) -> tuple[str, ...]:
    """Dataset names of forces, torques and areas that are asked for where nothing can meet. SceneError for those of a mirror, and of bodies that are one.

    meets   mpm.scene.meeting.Meets; None in the total frame
    """
    from mpm.records.variables import dataset_name, met

    names, found = list(experiment.bodies), []
    pairs = {f"{one}_{two}": (a, a + 1 + k) for a, one in enumerate(names) for k, two in enumerate(names[a + 1 :])}
    for index, asked in enumerate(experiment.output.observables):
        what, of, _ = met(asked) or ("", "", "")
        if what not in TOLD or of in experiment.tools:
            continue
        at = ("output", "observables", index)
        if meets is None:
            raise SceneError(at, f"the total frame holds bodies at its walls and tells no {what} there: take method.frame: updated, and `contact` walls")
        if of in sides:
            wall = divmod(sides.index(of), 2)
            bonded = [name for name, kinds in zip(names, meets.walls, strict=True) if kinds[wall] < CONTACT]
            if bonded:
                said = f"{of} is a mirror to {bonded[0]}, which starts at it, and a mirror tells no {what}: take walls: {{{of}: contact}}"
                raise SceneError(at, said)
            nothing = not (meets.stops[(slice(None), *wall)] >= 0).any()
        else:
            a, b = pairs[of]
            if meets.fields[a] == meets.fields[b]:
                raise SceneError(at, f"{names[a]} and {names[b]} are welded, one body to motion, and no {what} is known between them: take `stick`")
            nothing = meets.pairs[a, b] < 0
        if nothing:
            found.append(dataset_name(asked))
    return tuple(dict.fromkeys(found))

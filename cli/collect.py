"""mpm collect: the points that are there to one dataset."""

from mpm_cli.options import Folder, Json
from mpm_cli.talk import document, say


def collect(out: Folder, as_json: Json = False) -> None:
    """Assemble OUT/sweep.nc from what is there.

    Also while a sweep runs: what has not run is `pending`.
    """
    from mpm.sweep.api import collect_folder

    path, written, found = collect_folder(out)
    if as_json:
        document({"dataset": path, "written": written, "counts": found})
    else:
        say(", ".join(f"{count} {name}" for name, count in found.items() if count))
        say(f"{path}{'' if written else ' (up to date)'}")

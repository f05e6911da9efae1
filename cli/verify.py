"""mpm verify: checksums; what is damaged is set aside and runs again."""

from typing import Annotated

import typer
from mpm_cli.options import Folder, Jobs, Json, Quiet
from mpm_cli.progress import reporter
from mpm_cli.talk import document, say

Check = Annotated[bool, typer.Option("--check", help="Only check: rename nothing and run nothing.")]


def verify(out: Folder, check: Check = False, jobs: Jobs = "auto", as_json: Json = False, quiet: Quiet = False) -> None:
    """Check every file of a folder against its checksum.

    A damaged file is renamed (nothing is deleted), its points are run again, and the dataset is rebuilt.
    Exit codes: 0 all files are sound, or have been repaired; 1 something is still damaged; 2 usage, or the folder is in use.
    """
    from mpm.sweep.engine import Options
    from mpm.sweep.verify import in_words
    from mpm.sweep.verify import verify as verified

    teller = reporter(as_json, quiet)
    found = verified(out, Options(jobs), teller, check)
    if as_json:
        document(found.document())
    else:
        say(in_words(found), quiet=quiet and found.sound)
    raise typer.Exit(0 if found.sound else 1)

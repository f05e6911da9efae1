"""mpm verify: checksums; what is damaged is set aside and runs again."""

from typing import Annotated

import typer
from mpm_cli.options import Folder, Jobs, Json, Quiet
from mpm_cli.progress import reporter
from mpm_cli.talk import document, say

Check = Annotated[bool, typer.Option("--check", help="Only look: set nothing aside, run nothing.")]


def verify(out: Folder, check: Check = False, jobs: Jobs = "auto", as_json: Json = False, quiet: Quiet = False) -> None:
    """Check every file of a folder against its checksum.

    A damaged file is set aside (nothing is deleted), its points run again, and the dataset is made anew.
    Exit codes: 0 all sound, or sound again; 1 something is damaged still; 2 usage, or the folder is in use.
    """
    from mpm.sweep.engine import Options
    from mpm.sweep.verify import said
    from mpm.sweep.verify import verify as verified

    teller = reporter(as_json, quiet)
    found = verified(out, Options(jobs), teller, check)
    if as_json:
        document(found.document())
    else:
        say(said(found), quiet=quiet and found.sound)
    raise typer.Exit(0 if found.sound else 1)

"""mpm status: what is done."""

from mpm_cli.options import Folder, Json
from mpm_cli.talk import document, say


def status(out: Folder, as_json: Json = False) -> None:
    """Print what a sweep's folder holds.

    Counts by status, failures grouped by reason, the slowest points, results from other source code, and the process that is working there.
    """
    from mpm.sweep.status import in_words
    from mpm.sweep.status import status as status_of

    found = status_of(out)
    document(found) if as_json else say(in_words(found))

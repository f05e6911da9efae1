"""Commands and flags as entries of the reference, read from the command line itself."""

import re
from typing import Any


def commands() -> list[Any]:
    """Every command and every flag."""
    import typer
    from mpm_cli.main import app

    from mpm.reference.entry import Entry

    found = []
    group: Any = typer.main.get_command(app)  # of an app with several commands
    for name, command in group.commands.items():
        context = typer.Context(command, info_name=f"mpm {name}")
        first, _, rest = (command.help or "").partition("\n\n")
        found.append(Entry(f"mpm {name}", "command", " ".join(first.split()), {"usage": context.get_usage().removeprefix("Usage: ")}, rest.strip()))
        found += [flag(f"mpm {name}", option, context) for option in command.params if option.name != "help"]
    return found


def flag(command: str, option: Any, context: Any) -> Any:
    """An argument or option of a command."""
    from mpm.reference.entry import Entry

    kind = "flag" if option.param_type_name == "option" else "argument"
    spoken, said = option.get_help_record(context)
    spoken = re.sub(r" <[^>]+>$", "", spoken) if kind == "argument" else spoken  # some versions of typer add its type
    return Entry(f"{command} {spoken}", kind, said, {"names": " ".join(option.opts) if kind == "flag" else ""})

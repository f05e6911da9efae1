"""mpm ask: what value gives an answer, from a finished sweep."""

from typing import Annotated

import typer
from mpm_cli.options import Folder, Json, overrides
from mpm_cli.talk import document, say

AT = "Value of another parameter; repeat for more.  [default: the config's]"


def ask(
    out: Folder,
    question: Annotated[str, typer.Argument(metavar="QUESTION", help="NAME = VALUE, as 'time_to_centre_95_degC = 660'.", show_default=False)],
    by: Annotated[str | None, typer.Option("--by", metavar="PARAMETER", help="The parameter that answers, where several vary.", show_default=False)] = None,
    at: Annotated[list[str] | None, typer.Option("--at", metavar="NAME=VALUE", help=AT, show_default=False)] = None,
    as_json: Json = False,
) -> None:
    """Answer what value of a parameter gives an observable, with an interval.

    A surrogate runs through the points of a finished sweep; its cross-validated error makes the interval. Refused where that error is larger than an
    answer. Exit codes: 0 answered; 2 usage, or no answer.
    """
    from mpm.sensitivity.api import opened
    from mpm.sensitivity.sample import read
    from mpm.sensitivity.surrogate import ask as answer
    from mpm.sensitivity.surrogate import number

    sample = read(opened(out))
    units = {parameter.name: parameter.units for parameter in sample.parameters}
    fixed = {name: number(str(text), units.get(name, "1")) for name, text in overrides(at).items()}
    found, surrogate, held = answer(sample, question, by, fixed)
    if as_json:
        document({"question": question, "answers": [vars(one) for one in found], "held": held, "surrogate_error": surrogate.error, "points": surrogate.points})
        return
    others = f" at {', '.join(f'{name} = {value:.4g}' for name, value in held.items())}" if held else ""
    for one in found:
        unit = "" if one.units in ("", "1") else f" {one.units}"
        say(f"{one.parameter} = {one.value:.4g}{unit} ({one.low:.4g} to {one.high:.4g}){others}")
    asked = sample.units[question.partition("=")[0].strip().replace(".", "_")]
    of_answer = "" if asked in ("", "1") else f" {asked}"
    say(f"from a surrogate through {surrogate.points} points, off by {surrogate.error:.3g}{of_answer} (95 % of the points that it was not shown)")

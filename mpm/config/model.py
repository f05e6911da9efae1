"""Which model answers the config: the one it names, or the smallest that will do within a tolerance (mpm.reduce)."""

from typing import Annotated, ClassVar

from mpm.config.base import Kind, doc, one_of
from mpm.config.quantities import Quantity


class Full(Kind):
    """The model that the config names."""

    kind: ClassVar[str] = "full"


class Auto(Kind):
    """The smallest model whose answers to what is asked for stay within a tolerance; the dataset says what was dropped and how much that matters."""

    kind: ClassVar[str] = "auto"
    tolerance: Annotated[float, Quantity("", "tolerance", above=0, most=1)] = doc(
        0.01, description="of temperatures, as a share of the driving difference; of all else, of how much it changes"
    )


MODELS: tuple[type[Kind], ...] = (Full, Auto)
Which = one_of("model", *MODELS)

"""The folders of configs and docs: `mpm_configs` and `mpm_docs` beside an installed package, `configs` and `docs` in a checkout."""

from pathlib import Path


class Missing(Exception):
    """An installation without its configs or docs."""


def folder(name: str) -> Path:
    """The folder of `configs` or `docs`; Missing says where it was looked for."""
    site = Path(__file__).parents[2]
    found = [site / there for there in (f"mpm_{name}", name) if (site / there / "__init__.py").is_file()]
    if not found:
        raise Missing(f"there is no mpm_{name} in {site}; install mpm again")
    return found[0]

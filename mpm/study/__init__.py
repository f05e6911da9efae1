"""Studies: they name their cases, run them, and say what came out.

verification   every config under configs/verification/ at three resolutions -> the table in its README
"""

from pathlib import Path

CONFIGS = Path(__file__).parents[2] / "configs"  # of a checkout: an installed package has no studies to make

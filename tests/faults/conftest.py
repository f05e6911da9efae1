import sys
from pathlib import Path

FOLDERS = Path(__file__).parent, Path(__file__).parents[1] / "fakes"
sys.path[:0] = [str(folder) for folder in FOLDERS if str(folder) not in sys.path]  # workers get their parent's module path

"""Scenes in which bodies meet run in plain Python (`plain` of tests/conftest.py): compiling would take a minute."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))  # for contact_scenes.py

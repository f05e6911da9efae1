"""Studies: they name their cases, run them, and say what came out.

verification   every config under configs/verification/ at three resolutions -> the table in its README
"""

"""Benchmarks: what only measures, each by `python -m mpm.benchmarks.NAME`. No command of the shell reaches them.

May use   every room      May not  be used by any other room
To add    a module with a `main`, its line below, and where its figures stand in docs/

Files
    affine         affine FLIP over random arrangements
    contact_parts  what each part of contact takes
    contact_sheet  all pictures of all scenes and studies, to look at one by one
    costs          what `mpm plan` says a point costs, beside what it costs
    coupled        one whole step of 1-D thermoelastic particles as a matrix, and its spectral radius
    figures        the figures of docs/accuracy.md, by one command
    frames         what the total frame costs beside the updated one
    house          the house in numbers, of any checkout
    implicit       implicit mechanics beside explicit steps, error against time
    mutants        do the tests bite? One place of the source is changed, and the nearest tests are run
    operators      critical steps of particle arrangements, exactly
    promises       does `mpm plan --tol` keep its promise? `python -m mpm.benchmarks.promises [NAME...]` prints the table
    reduction      no more model than a scene needs, measured
    return_map     return maps
    showing        what showing results costs: movie, report, export, help, memory of a sweep's parent
    single         the verification problems in single precision
    speed          the table of docs/speed.md
    speed_models   our side of the rows of mpm.benchmarks.speed that are not the thrown cube
    surfaces       three ways to exchange heat at a free surface, measured on bodies at rest
    theory         what transfers do to a field by themselves, measured beside the line of theory
    verification   every config under configs/verification/ at three resolutions -> the table in its README
    wave           which transfer keeps a thermoelastic wave
"""

from pathlib import Path

CONFIGS = Path(__file__).parents[2] / "configs"  # of a checkout: an installed package has no studies to make

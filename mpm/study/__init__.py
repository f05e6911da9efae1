"""Studies: they name their cases, run them, and say what came out.

verification   every config under configs/verification/ at three resolutions -> the table in its README

Further files
    affine         affine FLIP over random arrangements
    bench          `mpm bench` without a config
    boundary       from the verdicts of a map to its dataset, and to sentences
    chart          speed against accuracy (`mpm chart`)
    choose         method, cell and step for a tolerance (`mpm plan --tol 1%`)
    contact_sheet  all pictures of all scenes and studies, to look at one by one
    costs          what `mpm plan` says a point costs, beside what it costs
    coupled        one whole step of 1-D thermoelastic particles as a matrix, and its spectral radius
    figures        the figures of "Speed against accuracy" in the README, by one command
    front          which settings are worth their time, and what may be ranked
    house          the house in numbers, of any checkout
    implicit       implicit mechanics beside explicit steps, error against time
    limits         how far the machine's own limits are
    menu           the usual methods and refinements of a chart, by what physics a config has
    mutants        do the tests bite? One place of the source is changed, and the nearest tests are run
    operators      critical steps of particle arrangements, exactly
    phases         `mpm bench CONFIG`
    pilots         a user's own scene with ever more cells, until one keeps a tolerance or says which cell would (study/choose.py
    promises       does `mpm plan --tol` keep its promise? `python -m mpm.study.promises [NAME...]` prints the table
    reduction      no more model than a scene needs, measured
    return_map     return maps
    richardson     A reference where there is no exact solution
    showing        what showing results costs: movie, report, export, help, memory of a sweep's parent
    single         the verification problems in single precision
    speed          the table of speed
    speed_models   our side of the rows of mpm.study.speed that are not the thrown cube
    stability      `mpm stability`
    surfaces       three ways to exchange heat at a free surface, measured on bodies at rest
    theory         what transfers do to a field by themselves, measured beside the line of theory
    timing         time of runs, fairly
    watch          `mpm bench --compare REV`
    wave           which transfer keeps a thermoelastic wave
"""

from pathlib import Path

CONFIGS = Path(__file__).parents[2] / "configs"  # of a checkout: an installed package has no studies to make

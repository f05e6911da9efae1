"""Studies: they name their cases, run them, and say what came out.

Further files
    bench          `mpm bench` without a config
    boundary       from the verdicts of a map to its dataset, and to sentences
    chart          speed against accuracy (`mpm chart`)
    choose         method, cell and step for a tolerance (`mpm plan --tol 1%`)
    front          which settings are worth their time, and what may be ranked
    limits         how far the machine's own limits are
    menu           the usual methods and refinements of a chart, by what physics a config has
    phases         `mpm bench CONFIG`
    pilots         a user's own scene with ever more cells, until one keeps a tolerance or says which cell would (study/choose.py)
    richardson     A reference where there is no exact solution
    stability      `mpm stability`
    timing         time of runs, fairly
    watch          `mpm bench --compare REV`
"""

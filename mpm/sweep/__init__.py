"""Sweep: from an experiment to its points, over processes, to one dataset.

cases     `plan`: axes, zips, samples and lists of points -> cases with an id that depends on their content alone
designs   Sobol, Latin hypercube, Halton and uniform samples
"""

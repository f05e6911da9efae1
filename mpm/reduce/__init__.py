"""Reduce: the smallest model that will do. From an experiment to smaller ones, each an ordinary config that could have been written by hand.

Role      offer(experiment, left) -> Offer, or a sentence that says why it does not apply; `left` is what is left of the tolerance
Offer     the smaller experiment, what was dropped, the error that its own estimate predicts, and how its results go back under the names that were asked for
          `error` is a share of the scene's driving temperature difference (what is asked is heat) or of how much a quantity changes (motion);
          None where there is no honest estimate: then a pilot, coarse full against coarse reduced, is run instead
offers.py     Offer, what a config asks for, how results go back
physics.py    rigid (heat without motion), no flow, one way (no heating by deformation), no heat
dimension.py  axisymmetric for a round body, fewer directions for a slab or a bar
moving.py     the same for bodies that move
lumped.py     one temperature (dimension 0)
change.py     how much a quantity changes in a run: what errors are a share of
difference.py        how far two runs lie apart in what was asked for; pilots
choose.py     which of them a tolerance allows; `model: auto`
To add    a function in one of these, listed in choose.MENU; tests/reduce ranges over the menu

Further files
    listing   the smaller models of an experiment side by side, for `mpm plan`
"""

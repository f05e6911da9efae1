"""Short names and paths."""

import pytest

from mpm.config import load
from mpm.config.names import Names, UnknownName


@pytest.mark.parametrize(
    ("name", "path"),
    [
        ("kappa", "materials.dough.heat.fourier.kappa"),
        ("κ", "materials.dough.heat.fourier.kappa"),
        ("alpha", "materials.dough.heat.fourier.alpha"),
        ("materials.dough.heat.fourier.kappa.constant", "materials.dough.heat.fourier.kappa"),
        ("α.bump.width", "materials.dough.heat.fourier.alpha.bump.width"),
        ("β", "surfaces.0.convection.beta"),
        ("cell", "grid.cell"),
        ("method.transfer", "method.transfer"),
        ("loaf.temperature", "bodies.loaf.temperature"),
        ("output.probes.centre", "output.probes.centre"),
        ("output.probes.centre.1", "output.probes.centre.1"),
        ("materials.dough.heat.fourier", "materials.dough.heat.fourier"),
    ],
)
def test_resolve(loaf, name, path):
    assert ".".join(map(str, Names(load(loaf)).resolve(name)[0])) == path


@pytest.mark.parametrize(("name", "path"), [("η", "eta"), ("p0", "p0"), ("eta", "eta"), ("M", "M")])
def test_flow_names(block, name, path):
    assert Names(load(block)).resolve(name)[0] == ("materials", "dough", "flow", "ellipse", path)


@pytest.mark.parametrize(
    ("name", "message", "suggestion"),
    [
        ("temperature", "could be any of 2 parameters", ""),
        ("kapa", "nothing in this file is called", "'kappa'"),
        ("η", r"nothing in this file is called 'η'; it would be materials.<name>.flow.ellipse.eta", ""),
        ("every.", "nothing in this file is called", ""),
        ("materials.dough.heat.fourier.kapa", "nothing in this file is called", "'materials.dough.heat.fourier.kappa'"),
        ("chart", "nothing in this file is called", ""),
        ("sweep.axes", "nothing in this file is called", ""),
        ("", "nothing in this file is called", ""),
        ("..", "nothing in this file is called", ""),
        ("surfaces.1.convection.beta", "nothing in this file is called", "'surfaces.0.convection.beta'"),
    ],
)
def test_unknown(loaf, name, message, suggestion):
    with pytest.raises(UnknownName, match=message) as caught:
        Names(load(loaf)).resolve(name)
    assert caught.value.suggestion == suggestion and caught.value.allowed


def test_ambiguous_names_list_every_path(loaf):
    loaf["materials"]["crust"] = loaf["materials"]["dough"]
    with pytest.raises(UnknownName) as caught:
        Names(load(loaf)).resolve("κ")
    assert caught.value.allowed == ["materials.dough.heat.fourier.kappa", "materials.crust.heat.fourier.kappa"]


def test_target_may_be_absent(loaf):
    names = Names(load(loaf))
    assert names.target("output.snapshots.every") == ("output", "snapshots", "every")
    assert names.target("surfaces.0.side") == ("surfaces", 0, "side")
    assert names.target("materials.crumb") == ("materials", "crumb")
    for wrong in ("output.snapshot.every", "materials.crumb.density", "surfaces.1.side", "surfaces.top.side", "grid.size.5.x", "nothing"):
        with pytest.raises(UnknownName):
            names.target(wrong)

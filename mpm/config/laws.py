"""Laws of temperature: the few kinds by which a material parameter may depend on temperature T [K].

Constant   v                                                        written as a number, or `{constant: v}`
Table      values over temperatures, linear or PCHIP between them, constant outside
Bump       base + heat/(width sqrt(2 pi)) exp(-(T - at)^2/(2 width^2))     latent heat as apparent specific heat; `heat` is the integral of the bump
Logistic   low + (high - low)/(1 + exp(-(T - at)/width))
Set        raw + X (baked - raw), X the degree of setting of the material (M, eta, E; mpm.materials.setting)
Arrhenius  k0 exp(-Ea/(R T)), the rate of setting alone
Porosity   of the aspect ratio p0 alone: by the plastic Poisson ratio (mpm.materials.porous)

After validation a law is always one of these classes: dispatch with `isinstance` (each parameter has subclasses of its own that carry its unit: `values` are
the fields in that unit, `areas` those in that unit times kelvin, and time scaling multiplies both).
"""

import copy
import functools
from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal

from pydantic import create_model, model_validator

from mpm.config.base import Choice, Kind, Menu, doc, problem
from mpm.config.quantities import Quantity, Temperature, TemperatureDifference


class Constant(Kind):
    """The same value at every temperature."""

    kind: ClassVar[str] = "constant"
    values: ClassVar[tuple[str, ...]] = ("value",)
    value: float = doc(description="the value")

    @model_validator(mode="before")
    @classmethod
    def number(cls, value: Any) -> Any:
        """`{constant: 0.35}`: the value lies right under the kind's name."""
        return {"value": value} if not isinstance(value, dict) else value


class Table(Kind):
    """Values over increasing temperatures, constant outside the table."""

    kind: ClassVar[str] = "table"
    values: ClassVar[tuple[str, ...]] = ("value",)
    temperature: tuple[Temperature, ...] = doc(description="increasing temperatures", min_length=2)
    value: tuple[float, ...] = doc(description="value at each temperature")
    interpolation: Annotated[Literal["linear", "pchip"], Choice()] = doc("linear", description="between the entries: straight lines, or monotone cubics")

    @model_validator(mode="after")
    def shape(self) -> "Table":
        """As many values as temperatures, temperatures increasing."""
        if len(self.temperature) != len(self.value):
            raise problem("table", f"{len(self.temperature)} temperatures but {len(self.value)} values", "lists of the same length", at=("value",))
        for index, (low, high) in enumerate(zip(self.temperature, self.temperature[1:], strict=False)):
            if high <= low:
                raise problem("table", "temperatures must increase", "each above the one before", at=("temperature", index + 1))
        return self


class Bump(Kind):
    """base + heat/(width sqrt(2 pi)) exp(-(T - at)^2/(2 width^2)): latent heat spread over a few kelvin."""

    kind: ClassVar[str] = "bump"
    values: ClassVar[tuple[str, ...]] = ("base",)
    areas: ClassVar[tuple[str, ...]] = ("heat",)
    base: float = doc(description="value far from the bump")
    heat: float = doc(description="integral of the bump over temperature: the latent heat, of a specific heat")
    at: Temperature = doc(description="temperature of the peak")
    width: TemperatureDifference = doc(description="standard deviation of the bump")


class Logistic(Kind):
    """low + (high - low)/(1 + exp(-(T - at)/width)): a smooth step."""

    kind: ClassVar[str] = "logistic"
    values: ClassVar[tuple[str, ...]] = ("low", "high")
    low: float = doc(description="value far below the step")
    high: float = doc(description="value far above the step")
    at: Temperature = doc(description="temperature of the middle of the step")
    width: TemperatureDifference = doc(description="e-folding width of the step")


LAWS = (Constant, Table, Bump, Logistic)  # the menu of every parameter; others add to it
Lawful = Constant | Table | Bump | Logistic


class Porosity(Kind):
    """By the plastic Poisson ratio nu_p = 1/2 (1 - porosity)^exponent, 1/3 sqrt((1 + nu_p)/(1/2 - nu_p)); the pores take up every change of volume."""

    kind: ClassVar[str] = "porosity"
    initial: Annotated[float, Quantity("", "porosity", least=0, most=0.999)] = doc(description="share of pores in the undeformed volume")
    exponent: Annotated[float, Quantity("", "exponent", above=0, most=10)] = doc(2.0, description="exponent; about 2 in compacted powders")


class Arrhenius(Kind):
    """k0 exp(-activation/(R T)), R = 8.314 J/(mol K)."""

    kind: ClassVar[str] = "arrhenius"
    values: ClassVar[tuple[str, ...]] = ("k0",)
    k0: Annotated[float, Quantity("1/s", "frequency factor", above=0)] = doc(description="rate at infinite temperature")
    activation: Annotated[float, Quantity("J/mol", "activation energy", least=0)] = doc(description="activation energy")


class Set(Kind):
    """raw + X (baked - raw): X grows from 0 to 1 by dX/dt = rate (1 - X), and never falls. One X for all that a material sets."""

    kind: ClassVar[str] = "set"


def of_unit(base: type[Kind], quantity: Quantity, home: dict[str, Any], /, **fields: Any) -> type[Kind]:
    """A law's class for one quantity; a name of the module whose globals `home` are, so that experiments can be sent to other processes."""
    name = base.__name__ + "".join(letter for letter in quantity.name.title() if letter.isalpha())
    made = create_model(name, __base__=base, __doc__=base.__doc__, __module__=home["__name__"], **fields)
    if name in home:
        raise ValueError(f"two parameters are called {quantity.name!r}")
    home[name] = made
    return made


def described_as(base: type[Kind], field: str) -> Any:
    """A required field that is described as in the base."""
    return doc(description=base.model_fields[field].description)


def fields_of(base: Any, value: Any, area: Any) -> Any:
    """(name, (type, field)) of what carries the unit in a law: numbers, or lists of them."""
    for name in (*base.values, *getattr(base, "areas", ())):
        one = value if name in base.values else area
        several = base.model_fields[name].annotation is not float
        yield name, (tuple[one, ...] if several else one, described_as(base, name))  # type: ignore[valid-type]  # a type of pydantic's, made here


class Law(Menu):
    """Annotation of a parameter that is a number or a function of temperature; every value in it has the parameter's unit and bounds."""

    def __init__(self, quantity: Quantity, *more: type[Kind]):
        value = Annotated[float, quantity]
        # the integral of the bump over temperature: J/kg for a specific heat in J/kg/K
        integral = quantity.unit.removesuffix("/K") if quantity.unit.endswith("/K") else f"{quantity.unit}*K" if quantity.unit else "K"
        area = Annotated[float, Quantity(integral, f"{quantity.name} times kelvin", least=0, difference=True)]
        self.constant, *others = (of_unit(base, quantity, globals(), **dict(fields_of(base, value, area))) for base in LAWS)
        super().__init__(f"law of the {quantity.name}", self.constant, *others, *more)
        self.quantity = quantity

    def check(self, value: Any) -> Any:
        """A number or text with a unit becomes a Constant; a mapping names its kind."""
        if isinstance(value, dict | Kind):
            return super().check(value)
        if isinstance(value, str) and value in self.kinds:
            return super().check(value)
        return self.constant.model_construct(value=self.quantity.validate(value))

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict:
        kinds = super().__get_pydantic_json_schema__(schema, handler)
        number = self.quantity.__get_pydantic_json_schema__(schema, handler)
        constant = {"type": "object", "properties": {"constant": number}, "required": ["constant"], "additionalProperties": False}
        return {**number, "anyOf": [*number["anyOf"], {"oneOf": [constant, *kinds["oneOf"][1:]]}]}

    def along(self, kind: type[Kind]) -> "Law":
        """The same menu with one kind more."""
        found = copy.copy(self)
        found.kinds = {**self.kinds, kind.kind: kind}
        return found


Rate = Annotated[Lawful | Arrhenius, Law(Quantity("1/s", "rate of setting", least=0, difference=True), Arrhenius)]


@functools.cache
def law(unit: str, name: str, **bounds: Any) -> Any:
    """The type of a parameter that may depend on temperature: `kappa: law("W/m/K", "conductivity", least=0)`."""
    return Annotated[Lawful, Law(replace(Quantity(unit, name), difference=True, **bounds))]


@functools.cache
def porous(unit: str, name: str, **bounds: Any) -> Any:
    """The type of a parameter that may depend on temperature, or on porosity."""
    return Annotated[Lawful | Porosity, Law(replace(Quantity(unit, name), difference=True, **bounds), Porosity)]


@functools.cache
def settable(unit: str, name: str, **bounds: Any) -> Any:
    """The type of a parameter that may depend on temperature, or on a degree of setting between two such laws."""
    quantity = replace(Quantity(unit, name), difference=True, **bounds)
    menu = Law(quantity)
    end = Annotated[Lawful, menu]
    told = "rate of setting; one for the whole material, said once"
    fields = {"raw": (end, doc(description="before")), "baked": (end, doc(description="after")), "rate": (Rate | None, doc(None, description=told))}
    kind = of_unit(Set, quantity, globals(), **fields)
    return Annotated[Lawful | Set, menu.along(kind)]


def sets(material: Any) -> dict[tuple[str, str, str], Any]:
    """The parameters of a material that set, by where they stand in it."""
    places = ((section, getattr(material, section), name) for section, name in (("elastic", "E"), ("flow", "M"), ("flow", "eta")))
    found = ((section, law.kind, name, getattr(law, name, None)) for section, law, name in places if law is not None)
    return {(section, kind, name): one for section, kind, name, one in found if issubclass(type(one), Set)}


def rate_of(material: Any) -> Any:
    """The rate at which a material sets; None where nothing of it does."""
    return next((one.rate for one in sets(material).values() if one.rate is not None), None)

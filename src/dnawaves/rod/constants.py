"""Rods from constants that a user gives, in the units of the literature, checked for slips."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, NamedTuple, Self

import numpy as np
import yaml
from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    ValidationError,
    ValidationInfo,
    model_validator,
)

from dnawaves.errors import InputError
from dnawaves.rod.rod import FloatArray, Rod
from dnawaves.units import A_PER_NM, KJ_PER_MOL_PER_PN_NM

Three = tuple[float, float, float]
Matrix = tuple[Three, Three, Three]
Six = tuple[float, float, float, float, float, float]
Rows = tuple[Six, Six, Six, Six, Six, Six]
STIFFNESS_FIELDS = ("shear_pN", "extension_pN", "bend_pN_nm2", "twist_pN_nm2")


class Allowed(NamedTuple):
    """What a constant may be: how many numbers, in which range and unit."""

    numbers: str
    low: float
    high: float
    unit: str

    def __str__(self) -> str:
        limits = f"{self.low:g} to {self.high:g} {self.unit}"
        return f"{self.numbers}, {limits}" if self.numbers else limits


# A base pair weighs 616 Da without ions, 662 with sodium, 882 with caesium.
PAIR_MASS = Allowed("", 500.0, 900.0, "Da a base pair")
# Radius of gyration. No mass lies much further out than the duplex's radius, 10 A. The least one
# measured is 1.8 A, that of a base pair about its long axis (crystal 355D).
GYRATION = Allowed("three moments or a matrix, radii of gyration", 1.5, 10.0, "A")
# Wide enough for what is published, narrow enough that a tenth of any of it, or ten times as much,
# lies outside. Stretch: 1000 to 1200 pN in optical tweezers (Smith et al., Science 271, 795 (1996):
# 1087), 2160 in the paper. Shear: 354 to 567 pN in simulations, 816 in the paper. Bend and twist:
# persistence lengths of 20 to 200 nm at 300 K; 155 to 290 pN nm^2 for bend, 206 (the paper) to 410
# (Bryant et al., Nature 424, 338 (2003)) for twist.
SHEAR = Allowed("one number or two", 90.0, 3400.0, "pN")
EXTENSION = Allowed("one number", 300.0, 9000.0, "pN")
BEND = Allowed("one number or two", 83.0, 828.0, "pN nm^2")
TWIST_STIFFNESS = BEND._replace(numbers="one number")
SPACING = Allowed("one number", 2.0, 5.0, "A")
TURN = Allowed("one number", 10.0, 60.0, "degrees either way, or 0")
OMEGA = Allowed("three numbers", 0.4, 5.0, "rad/nm in all, or 0")
MATRIX = "six rows of six numbers, in pN, pN nm and pN nm^2"
UNUSUAL = "`unusual: true` lifts the ranges"


def _check(found: Any, size: float, allowed: Allowed, info: ValidationInfo) -> None:
    if not (info.data.get("unusual") or allowed.low <= size <= allowed.high):
        raise ValueError(f"found {found}; allowed: {allowed}; {UNUSUAL}")


def _within(allowed: Allowed) -> AfterValidator:
    def check(value: Any, info: ValidationInfo) -> Any:
        for number in np.ravel(value):
            _check(f"{number:g}", number, allowed, info)
        return value

    return AfterValidator(check)


def _turns(allowed: Allowed) -> AfterValidator:
    def check(value: Any, info: ValidationInfo) -> Any:
        if np.any(value):
            _check(value, float(np.linalg.norm(value)), allowed, info)
        return value

    return AfterValidator(check)


def _weighs_as_a_base_pair(value: float, info: ValidationInfo) -> float:
    if "spacing_A" in info.data:
        mass = value * info.data["spacing_A"] / A_PER_NM
        _check(f"{value:g} Da/nm, {mass:g} Da a base pair", mass, PAIR_MASS, info)
    return value


def _is_of_a_body(value: Three | Matrix, info: ValidationInfo) -> Three | Matrix:
    matrix = np.array(value, dtype=float)
    moments = np.linalg.eigvalsh(matrix) if matrix.ndim == 2 else np.sort(matrix)
    if moments[0] <= 0 or moments[2] > moments[0] + moments[1]:
        raise ValueError(
            f"found principal moments {', '.join(f'{one:g}' for one in moments)}; allowed: "
            "positive ones, the largest not above the sum of the other two, as of any body"
        )
    if info.data.get("density_Da_per_nm", 0) > 0:
        for radius in A_PER_NM * np.sqrt(moments / info.data["density_Da_per_nm"]):
            _check(f"{value}, a radius of {radius:.3g} A", radius, GYRATION, info)
    return value


def _has_a_diagonal_of_dna(value: tuple[Six, ...], info: ValidationInfo) -> tuple[Six, ...]:
    limits = [SHEAR, SHEAR, EXTENSION, BEND, BEND, TWIST_STIFFNESS]
    for index, allowed in enumerate(limits):
        number, element = value[index][index], f"element {index + 1} of the diagonal"
        _check(f"{number:g}", number, allowed._replace(numbers=element), info)
    return value


class RodConstants(BaseModel):
    """The constants of a rod, each in the range that DNA can have unless it is `unusual`.

    Transverse constants are one number for both axes or one for each; axis 1 points into the major
    groove, axis 2 along the base pair, axis 3 along the rod. A rod with couplings gives `stiffness`
    instead of the four stiffnesses, over (shear 1, shear 2, extension, bend 1, bend 2, twist).
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    unusual: bool = Field(
        False, description="true or false: take constants that no DNA is known to have"
    )
    spacing_A: Annotated[float, _within(SPACING)] = Field(
        3.4, description="distance between base pairs along the rod"
    )
    density_Da_per_nm: Annotated[float, AfterValidator(_weighs_as_a_base_pair)] = Field(
        description="mass per length: 1934 is 3.21e-15 kg/m"
    )
    inertia_Da_nm: Annotated[Three | Matrix, AfterValidator(_is_of_a_body)] = Field(
        description="inertia per length about the centre of mass, three moments about the axes or "
        "a matrix: 243 is 4.03e-34 kg m"
    )
    shear_pN: Annotated[float | tuple[float, float], _within(SHEAR)] | None = Field(
        None, description="shear stiffness: 816 is 8.16e-10 N"
    )
    extension_pN: Annotated[float, _within(EXTENSION)] | None = Field(
        None, description="stretch stiffness"
    )
    bend_pN_nm2: Annotated[float | tuple[float, float], _within(BEND)] | None = Field(
        None, description="bend stiffness: 270 is 2.7e-28 N m^2, a persistence length of 65 nm"
    )
    twist_pN_nm2: Annotated[float, _within(TWIST_STIFFNESS)] | None = Field(
        None, description="twist stiffness"
    )
    stiffness: Annotated[Rows, AfterValidator(_has_a_diagonal_of_dna)] | None = Field(
        None, description="all of it: pN, off-diagonal blocks pN nm, lower right pN nm^2"
    )
    twist_deg_per_bp: Annotated[float, _turns(TURN)] | None = Field(
        None, description="intrinsic twist about the rod's axis"
    )
    omega0_rad_per_nm: Annotated[Three, _turns(OMEGA)] | None = Field(
        None, description="intrinsic rotation per length, for a rod that is also bent"
    )
    gamma0: Three = Field(
        (0.0, 0.0, 1.0), description="intrinsic d(position)/d(arc length), three numbers"
    )
    centre_A: Three = Field(
        (0.0, 0.0, 0.0),
        description="centre of mass from the origin of the base-pair frame, three numbers",
    )

    @model_validator(mode="after")
    def _is_a_rod(self) -> Self:
        given = [name for name in STIFFNESS_FIELDS if getattr(self, name) is not None]
        if self.stiffness is not None and given:
            raise ValueError(
                f"found stiffness and {', '.join(given)}; allowed: the matrix alone, or the four "
                "stiffnesses"
            )
        if self.stiffness is None and len(given) < len(STIFFNESS_FIELDS):
            missing = [name for name in STIFFNESS_FIELDS if name not in given]
            raise ValueError(f"found no {', '.join(missing)}; allowed: all four, or stiffness")
        if self.twist_deg_per_bp is not None and self.omega0_rad_per_nm is not None:
            raise ValueError("found twist_deg_per_bp and omega0_rad_per_nm; allowed: one of them")
        usual = 0.5 <= self.gamma0[2] <= 1.5 and np.hypot(*self.gamma0[:2]) <= 1.0
        if not (usual or self.unusual):
            raise ValueError(
                f"gamma0: found {self.gamma0}; allowed: 0.5 to 1.5 along the rod, up to 1 across it"
            )
        if np.linalg.norm(self.centre_A) > 5.0 and not self.unusual:
            raise ValueError(f"centre_A: found {self.centre_A}; allowed: up to 5 A from the origin")
        try:
            self.rod()
        except InputError as error:
            raise ValueError(str(error).removeprefix("rod: ")) from None
        return self

    def rod(self) -> Rod:
        """Return the rod. Raises `InputError` if its stiffness is not positive definite."""
        inertia = np.array(self.inertia_Da_nm)
        omega0 = np.zeros(3) if self.omega0_rad_per_nm is None else self.omega0_rad_per_nm
        if self.twist_deg_per_bp is not None:
            omega0 = np.radians([0.0, 0.0, self.twist_deg_per_bp]) / (self.spacing_A / A_PER_NM)
        return Rod(
            density_Da_per_nm=self.density_Da_per_nm,
            inertia_Da_nm=inertia if inertia.ndim == 2 else np.diag(inertia),
            stiffness=KJ_PER_MOL_PER_PN_NM * self._stiffness_pN_nm(),
            spacing_nm=self.spacing_A / A_PER_NM,
            gamma0=np.array(self.gamma0),
            omega0_rad_per_nm=np.array(omega0),
            centre_nm=np.array(self.centre_A) / A_PER_NM,
        )

    def _stiffness_pN_nm(self) -> FloatArray:
        if self.stiffness is not None:
            return np.array(self.stiffness)
        numbers = [self.shear_pN, self.extension_pN, self.bend_pN_nm2, self.twist_pN_nm2]
        both_axes = [2, 1, 2, 1]
        diagonal = [
            np.ones(axes) * np.array(number, dtype=float)
            for number, axes in zip(numbers, both_axes, strict=True)
        ]
        return np.diag(np.concatenate(diagonal))


# what a constant that is no number at all should have been
FORMS: dict[str, object] = {
    "spacing_A": SPACING,
    "density_Da_per_nm": f"one number in Da/nm, {PAIR_MASS}",
    "inertia_Da_nm": f"in Da nm, {GYRATION}",
    "shear_pN": SHEAR,
    "extension_pN": EXTENSION,
    "bend_pN_nm2": BEND,
    "twist_pN_nm2": TWIST_STIFFNESS,
    "stiffness": MATRIX,
    "twist_deg_per_bp": TURN,
    "omega0_rad_per_nm": OMEGA,
}


def rod_from_constants(constants: Mapping[str, Any], where: str = "rod") -> Rod:
    """Return the rod of a mapping with the fields of `RodConstants`.

    Raises `InputError`, one line for each fault, starting with `where`.
    """
    try:
        return RodConstants.model_validate(dict(constants)).rod()
    except ValidationError as error:
        faults = {str(one["loc"][0]) if one["loc"] else "": one for one in error.errors()[::-1]}
        lines = [_explain(where, name, faults[name], constants) for name in reversed(faults)]
        raise InputError("\n".join(lines)) from None


def read_rod(path: Path) -> Rod:
    """Return the rod of a YAML file with the fields of `RodConstants`; raises `InputError`."""
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise InputError(f"{path}: cannot be read as YAML: {error}") from None
    if not isinstance(content, Mapping):
        raise InputError(
            f"{path}: found no mapping; allowed: {', '.join(RodConstants.model_fields)}"
        )
    return rod_from_constants(content, str(path))


def _explain(where: str, name: str, error: Mapping[str, Any], constants: Mapping[str, Any]) -> str:
    start = f"{where}: {name}: " if name else f"{where}: "
    if error["type"] == "value_error":
        return start + error["msg"].removeprefix("Value error, ")
    if error["type"] == "extra_forbidden":
        return f"{start}found no such constant; allowed: {', '.join(RodConstants.model_fields)}"
    if name not in constants:
        return f"{start}found nothing; allowed: it must be given"
    allowed = FORMS.get(name, RodConstants.model_fields[name].description)
    return f"{start}found {constants[name]!r}; allowed: {allowed}"

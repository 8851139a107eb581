"""Rods from constants that a user gives, in the units of the literature, checked for slips."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Self

import numpy as np
import yaml
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError, model_validator

from dnawaves.errors import InputError
from dnawaves.rod.rod import FloatArray, Rod
from dnawaves.units import A_PER_NM, KJ_PER_MOL_PER_PN_NM

Three = tuple[float, float, float]
Matrix = tuple[Three, Three, Three]
Six = tuple[float, float, float, float, float, float]
STIFFNESS_FIELDS = ("shear_pN", "extension_pN", "bend_pN_nm2", "twist_pN_nm2")

# What DNA can have, some 5 times to either side of what theory, experiment and simulation give:
# wide enough for another force field, too narrow for a power of ten in a unit. Forces up to the
# 13 nN of a stretched duplex without solvent.
DENSITY = (500.0, 8000.0, "Da/nm")
INERTIA = (15.0, 5000.0, "Da nm")
SHEAR = (30.0, 2e4, "pN")
EXTENSION = (100.0, 1e5, "pN")
ANGULAR = (50.0, 3000.0, "pN nm^2")
SPACING = (2.0, 5.0, "A")
TWIST = (10.0, 60.0, "degrees either way, or 0")
OMEGA = (0.4, 5.0, "rad/nm in all, or 0")


def _plausible(limits: tuple[float, float, str]) -> AfterValidator:
    low, high, unit = limits

    def check(value: Any) -> Any:
        array = np.asarray(value, dtype=float)
        # of a matrix only the diagonal has a size of its own
        for number in np.diag(array) if array.ndim == 2 else np.ravel(array):
            if not low <= number <= high:
                raise ValueError(f"found {number:g}; allowed: {low:g} to {high:g} {unit}")
        return value

    return AfterValidator(check)


def _twist_or_none(value: float) -> float:
    _check_turn(abs(value), value, TWIST)
    return value


def _turn_or_none(value: Three) -> Three:
    _check_turn(float(np.linalg.norm(value)), value, OMEGA)
    return value


def _check_turn(size: float, found: object, limits: tuple[float, float, str]) -> None:
    low, high, unit = limits
    if size != 0 and not low <= size <= high:
        raise ValueError(f"found {found}; allowed: {low:g} to {high:g} {unit}")


class RodConstants(BaseModel):
    """The constants of a rod, each in the range that DNA can have.

    Transverse constants are one number for both axes or one for each; axis 1 points into the major
    groove, axis 2 along the base pair, axis 3 along the rod. A rod with couplings gives `stiffness`
    instead of the four stiffnesses, over (shear 1, shear 2, extension, bend 1, bend 2, twist).
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    density_Da_per_nm: Annotated[float, _plausible(DENSITY)] = Field(
        description="mass per length: 1934 is 3.21e-15 kg/m"
    )
    inertia_Da_nm: Annotated[Three | Matrix, _plausible(INERTIA)] = Field(
        description="inertia per length about the centre of mass, three moments about the axes or "
        "a matrix: 243 is 4.03e-34 kg m"
    )
    spacing_A: Annotated[float, _plausible(SPACING)] = Field(
        3.4, description="distance between base pairs along the rod"
    )
    shear_pN: Annotated[float | tuple[float, float], _plausible(SHEAR)] | None = Field(
        None, description="shear stiffness: 816 is 8.16e-10 N"
    )
    extension_pN: Annotated[float, _plausible(EXTENSION)] | None = Field(
        None, description="stretch stiffness"
    )
    bend_pN_nm2: Annotated[float | tuple[float, float], _plausible(ANGULAR)] | None = Field(
        None, description="bend stiffness: 270 is 2.7e-28 N m^2, a persistence length of 65 nm"
    )
    twist_pN_nm2: Annotated[float, _plausible(ANGULAR)] | None = Field(
        None, description="twist stiffness"
    )
    stiffness: tuple[Six, Six, Six, Six, Six, Six] | None = Field(
        None, description="all of it: pN, off-diagonal blocks pN nm, lower right pN nm^2"
    )
    twist_deg_per_bp: Annotated[float, AfterValidator(_twist_or_none)] | None = Field(
        None, description="intrinsic twist about the rod's axis"
    )
    omega0_rad_per_nm: Annotated[Three, AfterValidator(_turn_or_none)] | None = Field(
        None, description="intrinsic rotation per length, for a rod that is also bent"
    )
    gamma0: Three = Field((0.0, 0.0, 1.0), description="intrinsic d(position)/d(arc length)")
    centre_A: Three = Field(
        (0.0, 0.0, 0.0), description="centre of mass from the origin of the base-pair frame"
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
        if self.stiffness is not None:
            self._check_diagonal()
        if self.twist_deg_per_bp is not None and self.omega0_rad_per_nm is not None:
            raise ValueError("found twist_deg_per_bp and omega0_rad_per_nm; allowed: one of them")
        if not (0.5 <= self.gamma0[2] <= 1.5 and np.hypot(*self.gamma0[:2]) <= 1.0):
            raise ValueError(
                f"gamma0: found {self.gamma0}; allowed: 0.5 to 1.5 along the rod, up to 1 across it"
            )
        if np.linalg.norm(self.centre_A) > 5.0:
            raise ValueError(f"centre_A: found {self.centre_A}; allowed: up to 5 A from the origin")
        try:
            self.rod()
        except InputError as error:
            raise ValueError(str(error).removeprefix("rod: ")) from None
        return self

    def _check_diagonal(self) -> None:
        limits = [SHEAR, SHEAR, EXTENSION, ANGULAR, ANGULAR, ANGULAR]
        for index, (value, (low, high, unit)) in enumerate(
            zip(np.diag(np.array(self.stiffness)), limits, strict=True)
        ):
            if not low <= value <= high:
                raise ValueError(
                    f"stiffness, diagonal element {index + 1}: found {value:g}; allowed: {low:g} "
                    f"to {high:g} {unit}"
                )

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
    allowed = RodConstants.model_fields[name].description
    return f"{start}found {constants[name]!r}; allowed: {allowed}"

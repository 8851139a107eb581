"""The elastic rod: its constants, its mass and strain operators, its limiting speeds."""

from __future__ import annotations

import csv
from dataclasses import dataclass, field, replace
from importlib import resources

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray

from dnawaves.errors import InputError
from dnawaves.units import (
    A_PER_NM,
    DA_NM_PER_KG_M,
    DA_PER_NM_PER_KG_PER_M,
    KJ_NM_PER_MOL_PER_N_M2,
    KJ_PER_MOL_NM_PER_N,
)

FloatArray = NDArray[np.float64]

SHEAR_1, SHEAR_2, EXTENSION, BEND_1, BEND_2, TWIST = range(6)
AXIAL = [EXTENSION, TWIST]

# of the eigenvalues of a 6x6 matrix with a diagonal of ones
ROUND_OFF = 1e-15


def cross_matrix(vector: ArrayLike) -> FloatArray:
    """Return the 3x3 matrix that maps y to vector x y."""
    x, y, z = np.asarray(vector, dtype=float)
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


@dataclass(frozen=True, eq=False)
class Rod:
    """Uniform elastic rod whose cross-sections are rigid bodies.

    Axes 0 and 1 are transverse, 2 is axial, all in the frame of the cross-section.
    Six-vectors are (u1, u2, u3, th1, th2, th3); their strains are two shears, extension, two
    bends, twist.

    Parameters
    ----------
    density_Da_per_nm : float
    inertia_Da_nm : (3, 3)
        Moment of inertia per length about the centre of mass, Da nm^2/nm.
    stiffness : (6, 6)
        Energy per length is half of strain . stiffness . strain. Upper left kJ/mol/nm,
        off-diagonal blocks kJ/mol, lower right kJ nm/mol.
    gamma0 : (3,)
        Intrinsic d(position)/d(arc length), dimensionless.
    omega0_rad_per_nm : (3,)
        Intrinsic rotation per arc length.
    spacing_nm : float
        Distance between base pairs, used wherever the rod is a lattice.
    centre_nm : (3,)
        Centre of mass of a cross-section, seen from the origin of its frame.

    Raises
    ------
    InputError
        If a shape is wrong, or density, inertia, stiffness or spacing is not positive definite.
    """

    density_Da_per_nm: float
    inertia_Da_nm: FloatArray
    stiffness: FloatArray
    spacing_nm: float
    gamma0: FloatArray = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    omega0_rad_per_nm: FloatArray = field(default_factory=lambda: np.zeros(3))
    centre_nm: FloatArray = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        for name, shape in (
            ("inertia_Da_nm", (3, 3)),
            ("stiffness", (6, 6)),
            ("gamma0", (3,)),
            ("omega0_rad_per_nm", (3,)),
            ("centre_nm", (3,)),
        ):
            object.__setattr__(self, name, _frozen_array(name, getattr(self, name), shape))
        for name in ("density_Da_per_nm", "spacing_nm"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise InputError(f"rod: {name} is {value}; it must be positive and finite")
        _require_positive_definite("inertia_Da_nm", self.inertia_Da_nm)
        _require_positive_definite("stiffness", self.stiffness)

    @classmethod
    def paper(cls, *, twisted: bool = False) -> Rod:
        """Return the rod with the constants of Bishop & Zhmudsky; untwisted unless asked for."""
        si = _paper_constants_SI()
        stiffness = np.zeros(6)
        stiffness[[SHEAR_1, SHEAR_2]] = si["shear_stiffness"] * KJ_PER_MOL_NM_PER_N
        stiffness[EXTENSION] = si["extension_stiffness"] * KJ_PER_MOL_NM_PER_N
        stiffness[[BEND_1, BEND_2]] = si["bend_stiffness"] * KJ_NM_PER_MOL_PER_N_M2
        stiffness[TWIST] = si["twist_stiffness"] * KJ_NM_PER_MOL_PER_N_M2
        inertia = np.array(
            [si["inertia_transverse"], si["inertia_transverse"], si["inertia_axial"]]
        )
        return cls(
            density_Da_per_nm=si["density"] * DA_PER_NM_PER_KG_PER_M,
            inertia_Da_nm=np.diag(inertia * DA_NM_PER_KG_M),
            stiffness=np.diag(stiffness),
            spacing_nm=si["spacing"] * 1e9,
            omega0_rad_per_nm=np.array([0.0, 0.0, si["intrinsic_twist"] * 1e-9 * twisted]),
        )

    @property
    def mass(self) -> FloatArray:
        """Mass matrix per length (6, 6): Da/nm, off-diagonal blocks Da, lower right Da nm.

        Of the velocity of the frame's origin: a centre of mass beside it couples the two blocks.
        """
        offset = self.density_Da_per_nm * cross_matrix(self.centre_nm)
        inertia = self.inertia_Da_nm - offset @ cross_matrix(self.centre_nm)
        return np.block([[self.density_Da_per_nm * np.eye(3), -offset], [offset, inertia]])

    @property
    def connection(self) -> FloatArray:
        """The matrix A (6, 6) of the linear strain d/ds + A, with [[W, G], [0, W]] in 1/nm."""
        rotation = cross_matrix(self.omega0_rad_per_nm)
        return np.block([[rotation, cross_matrix(self.gamma0)], [np.zeros((3, 3)), rotation]])

    def averaged_about_axis(self) -> Rod:
        """Return the untwisted, transversely isotropic rod seen by waves longer than the pitch.

        Of a rod twisted about a straight axis, in the laboratory frame. A long wave loads each
        orientation of the cross-section alike, so compliances average: 1/D_eff = (1/D1 + 1/D2)/2.
        The coupling of extension and twist is kept; couplings of shear and bend are dropped.
        The centre of mass goes round the axis: its distance adds to the moments of inertia.
        """
        compliance = np.linalg.inv(self.stiffness)
        stiffness = np.zeros((6, 6))
        for pair in ([SHEAR_1, SHEAR_2], [BEND_1, BEND_2]):
            stiffness[pair, pair] = 1 / compliance[pair, pair].mean()
        stiffness[np.ix_(AXIAL, AXIAL)] = axial_stiffness(self)
        inertia = np.diag(self.mass)[3:]
        transverse = inertia[:2].mean()
        return replace(
            self,
            stiffness=stiffness,
            inertia_Da_nm=np.diag([transverse, transverse, inertia[2]]),
            gamma0=np.array([0.0, 0.0, self.gamma0[2]]),
            omega0_rad_per_nm=np.zeros(3),
            centre_nm=np.zeros(3),
        )


def axial_stiffness(rod: Rod) -> FloatArray:
    """Return the (2, 2) stiffness of (extension, twist) for waves longer than the pitch.

    All other strains relax: the Schur complement ((K^-1)_axial)^-1 of a rod with a straight axis.
    Without intrinsic twist only the shears relax: a uniform bend would need a deflection that
    grows as the wavelength squared, and the inertia of that deflection keeps it away.
    """
    strains = [*AXIAL, SHEAR_1, SHEAR_2] + ([BEND_1, BEND_2] if _twisted(rod) else [])
    compliance = np.linalg.inv(rod.stiffness[np.ix_(strains, strains)])
    return np.linalg.inv(compliance[:2, :2])


def axial_mass(rod: Rod) -> FloatArray:
    """Return the (2, 2) mass of (extension, twist), Da/nm and Da nm, for those waves.

    A rod with intrinsic twist turns about the axis through the origins of its frames, one without
    about its centres of mass: its axis gives way to a force across it at no cost.
    """
    twist_inertia = rod.mass[TWIST, TWIST] if _twisted(rod) else rod.inertia_Da_nm[2, 2]
    return np.diag([rod.density_Da_per_nm, twist_inertia])


def _twisted(rod: Rod) -> bool:
    return bool(rod.omega0_rad_per_nm[2] != 0)


def short_wave_speeds_A_per_ps(rod: Rod) -> dict[str, float]:
    """Return the speeds of waves much shorter than the pitch and the radius of gyration.

    Keys extension, twist, bend, shear. Couplings are left out; bend and shear use the mean of
    the two transverse axes (Bishop & Zhmudsky: sqrt(C/rho), sqrt(D/I)).
    """
    stiffness = np.diag(rod.stiffness)
    inertia = np.diag(rod.inertia_Da_nm)
    squared = {
        "extension": stiffness[EXTENSION] / rod.density_Da_per_nm,
        "twist": stiffness[TWIST] / inertia[2],
        "bend": stiffness[[BEND_1, BEND_2]].mean() / inertia[:2].mean(),
        "shear": stiffness[[SHEAR_1, SHEAR_2]].mean() / rod.density_Da_per_nm,
    }
    return {name: float(np.sqrt(value)) * A_PER_NM for name, value in squared.items()}


def long_wave_speeds_A_per_ps(rod: Rod) -> dict[str, float]:
    """Return the speeds of extension and twist waves longer than the pitch (straight axis).

    Extension and twist mix when they are coupled; each key names the wave in which that motion
    carries most of the kinetic energy.
    """
    mass = axial_mass(rod)
    squared, shapes = scipy.linalg.eigh(axial_stiffness(rod), mass)
    extension = int(np.argmax(mass[0, 0] * shapes[0] ** 2))
    speeds = np.sqrt(squared) * A_PER_NM
    return {"extension": float(speeds[extension]), "twist": float(speeds[1 - extension])}


def _paper_constants_SI() -> dict[str, float]:
    text = resources.files(__package__).joinpath("data/paper_constants.csv").read_text()
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    return {row["quantity"]: float(row["value"]) for row in csv.DictReader(lines)}


def _frozen_array(name: str, value: ArrayLike, shape: tuple[int, ...]) -> FloatArray:
    array = np.array(value, dtype=float)
    if array.shape != shape:
        raise InputError(f"rod: {name} has shape {array.shape}; it must be {shape}")
    if not np.isfinite(array).all():
        raise InputError(f"rod: {name} holds numbers that are not finite")
    array.setflags(write=False)
    return array


def _require_positive_definite(name: str, matrix: FloatArray) -> None:
    if not np.allclose(matrix, matrix.T, rtol=1e-8, atol=1e-10 * np.abs(matrix).max()):
        raise InputError(f"rod: {name} is not symmetric")
    scale = np.sqrt(np.abs(np.diag(matrix)))
    # on a diagonal of ones the units of force and of torque no longer matter
    with_unit_diagonal = matrix / np.outer(scale, scale) if scale.all() else matrix
    smallest = np.linalg.eigvalsh(with_unit_diagonal)[0]
    if smallest <= ROUND_OFF:
        raise InputError(
            f"rod: {name} is not positive definite; scaled to a diagonal of ones its smallest "
            f"eigenvalue is {smallest:.3g}, and {ROUND_OFF:g} is round-off"
        )

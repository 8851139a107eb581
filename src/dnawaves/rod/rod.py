"""The elastic rod: its constants, its mass and strain operators, its axis."""

from __future__ import annotations

import csv
from dataclasses import dataclass, field, replace
from importlib import resources

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

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


def require_positive_definite(name: str, matrices: FloatArray) -> None:
    """Raise InputError unless the matrix, or each of a stack, is symmetric positive definite."""
    transposed = np.swapaxes(matrices, -1, -2)
    size = np.abs(matrices).max(axis=(-1, -2), keepdims=True)
    if np.any(np.abs(matrices - transposed) > 1e-8 * np.abs(transposed) + 1e-10 * size):
        raise InputError(f"{name} is not symmetric")
    scale = np.sqrt(np.abs(np.diagonal(matrices, axis1=-2, axis2=-1)))[..., np.newaxis]
    scale = np.where(scale > 0, scale, 1.0)
    # on a diagonal of ones the units of force and of torque no longer matter
    smallest = np.linalg.eigvalsh(matrices / scale / np.swapaxes(scale, -1, -2))[..., 0].min()
    if smallest <= ROUND_OFF:
        raise InputError(
            f"{name} is not positive definite; scaled to a diagonal of ones its smallest "
            f"eigenvalue is {smallest:.3g}, and {ROUND_OFF:g} is round-off"
        )


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
        require_positive_definite("rod: inertia_Da_nm", self.inertia_Da_nm)
        require_positive_definite("rod: stiffness", self.stiffness)

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

    def on_axis(self) -> Rod:
        """Return the same rod, described by frames whose third axis is the axis of its screw.

        Gamma0 and Omega0 make every rod a helix about a straight axis. Here the origins lie on
        that axis and d3 points along it; of an untwisted rod d3 points along Gamma0. Frequencies
        are those of the rod as it was. Raises InputError if the rod closes into a ring.
        """
        turn = self.omega0_rad_per_nm
        rate = np.linalg.norm(turn)
        along = turn / rate if rate > 0 else self.gamma0
        advance = along @ self.gamma0
        if abs(advance) <= ROUND_OFF * np.linalg.norm(self.gamma0) or not self.gamma0.any():
            raise InputError(f"rod: gamma0 {self.gamma0} has no part along the axis of its helix")
        axis = along * np.sign(advance) / np.linalg.norm(along)
        origin = np.cross(turn, self.gamma0) / rate**2 if rate > 0 else np.zeros(3)
        frame = Rotation.align_vectors([axis], [[0.0, 0.0, 1.0]])[0].as_matrix()
        arm = cross_matrix(origin)
        adjoint = np.block([[frame, arm @ frame], [np.zeros((3, 3)), frame]])
        stiffness, inertia = (
            root.T @ matrix @ root
            for root, matrix in ((adjoint, self.stiffness), (frame, self.inertia_Da_nm))
        )
        return replace(
            self,
            stiffness=(stiffness + stiffness.T) / 2,
            inertia_Da_nm=(inertia + inertia.T) / 2,
            # across the axis nothing is left but round-off
            gamma0=np.array([0.0, 0.0, axis @ self.gamma0]),
            omega0_rad_per_nm=np.array([0.0, 0.0, axis @ turn]),
            centre_nm=frame.T @ (self.centre_nm - origin),
        )

    def averaged_about_axis(self) -> Rod:
        """Return the untwisted, transversely isotropic rod seen by waves longer than the pitch.

        Of a twisted rod, in the laboratory frame, its axis that of the helix (`on_axis`). A long
        wave loads each orientation of the cross-section alike, so compliances average:
        1/D_eff = (1/D1 + 1/D2)/2. The coupling of extension and twist is kept; couplings of shear
        and bend are dropped. The centre of mass goes round the axis: its distance adds to the
        moments of inertia. Raises InputError for a rod without twist, which nothing averages.
        """
        if not self.omega0_rad_per_nm.any():
            raise InputError("rod: without intrinsic twist nothing is averaged about the axis")
        rod = self.on_axis()
        compliance = np.linalg.inv(rod.stiffness)
        stiffness = np.zeros((6, 6))
        for pair in ([SHEAR_1, SHEAR_2], [BEND_1, BEND_2]):
            stiffness[pair, pair] = 1 / compliance[pair, pair].mean()
        stiffness[np.ix_(AXIAL, AXIAL)] = axial_stiffness(rod)
        inertia = np.diag(rod.mass)[3:]
        transverse = inertia[:2].mean()
        return replace(
            rod,
            stiffness=stiffness,
            inertia_Da_nm=np.diag([transverse, transverse, inertia[2]]),
            omega0_rad_per_nm=np.zeros(3),
            centre_nm=np.zeros(3),
        )


def axial_stiffness(rod: Rod) -> FloatArray:
    """Return the (2, 2) stiffness of (extension, twist) of a straight rod for long waves.

    All other strains relax: the Schur complement ((K^-1)_axial)^-1. Without intrinsic twist only
    the shears relax: a uniform bend would need a deflection that grows as the wavelength squared,
    and the inertia of that deflection keeps it away. A rod that is not straight: `Rod.on_axis`.
    """
    twisted = rod.omega0_rad_per_nm[2] != 0
    strains = [*AXIAL, SHEAR_1, SHEAR_2] + ([BEND_1, BEND_2] if twisted else [])
    compliance = np.linalg.inv(rod.stiffness[np.ix_(strains, strains)])
    return np.linalg.inv(compliance[:2, :2])


def short_wave_speeds_A_per_ps(rod: Rod) -> dict[str, float]:
    """Return the short-wave speeds of an isotropic rod without couplings: Bishop & Zhmudsky's.

    Keys extension, twist, bend, shear: sqrt(C/rho), sqrt(D/I). Couplings are left out, and the two
    transverse axes averaged; the waves of any rod are those of `limits.short_waves`.
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

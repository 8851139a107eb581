"""Where the bodies of a chain are and how they move."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from dnawaves.rod.rod import FloatArray


@dataclass(frozen=True, eq=False)
class State:
    """State of a chain of rigid bodies, or of many: leading axes for time, batch, ... .

    Parameters
    ----------
    origins_nm : (..., bodies, 3)
    quaternions : (..., bodies, 4)
        (x, y, z, w), from a body's axes to those of the laboratory.
    momenta : (..., bodies, 6)
        Laboratory: linear, Da nm/ps, and angular about the centre of mass, Da nm^2/ps.
    """

    origins_nm: FloatArray
    quaternions: FloatArray
    momenta: FloatArray

    @property
    def leading(self) -> tuple[int, ...]:
        return self.origins_nm.shape[:-2]

    @property
    def axes(self) -> FloatArray:
        """Rotation matrices (..., bodies, 3, 3) from body to laboratory: columns are the axes."""
        matrices = _rotations(self.quaternions).as_matrix()
        return matrices.reshape(*self.quaternions.shape[:-1], 3, 3)

    def __getitem__(self, index: object) -> State:
        """Return some of the states, by their leading axes."""
        return State(*(getattr(self, name)[index] for name in self.__dataclass_fields__))

    def copies(self, *leading: int) -> Self:
        """Return many of this state along new leading axes."""
        return replace(
            self,
            **{
                name: np.broadcast_to(array, (*leading, *array.shape))
                for name, array in vars(self).items()
            },
        )

    def displaced(self, displacements: ArrayLike) -> Self:
        """Return this state with bodies moved by (..., bodies, 6) in their own frames: nm, rad."""
        step = np.asarray(displacements, dtype=float)
        shape = np.broadcast_shapes(self.momenta.shape, step.shape)
        start, step = self.copies(*shape[: len(shape) - self.momenta.ndim]), np.zeros(shape) + step
        turned = _rotations(start.quaternions) * Rotation.from_rotvec(step[..., 3:].reshape(-1, 3))
        return replace(
            start,
            origins_nm=start.origins_nm + np.einsum("...ij,...j->...i", self.axes, step[..., :3]),
            quaternions=turned.as_quat().reshape(start.quaternions.shape),
        )

    def displacements_from(self, reference: State) -> FloatArray:
        """Return the displacements (..., bodies, 6) that carry `reference` here; see `displaced`.

        Rotations by more than pi come back as their complement.
        """
        moved = self.origins_nm - reference.origins_nm
        before = np.broadcast_to(reference.quaternions, self.quaternions.shape)
        turn = _rotations(before).inv() * _rotations(self.quaternions)
        vectors = np.einsum("...ji,...j->...i", reference.axes, moved)
        return np.concatenate([vectors, turn.as_rotvec().reshape(moved.shape)], axis=-1)


def _rotations(quaternions: FloatArray) -> Rotation:
    return Rotation.from_quat(np.array(quaternions).reshape(-1, 4))

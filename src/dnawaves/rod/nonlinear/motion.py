"""Chains of rigid bodies laid out to be moved in time by kicks and drifts."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.spatial.transform import Rotation

from dnawaves.errors import InputError, SimulationError
from dnawaves.rod.nonlinear.bodies import Bodies
from dnawaves.rod.nonlinear.chain import NonlinearChain
from dnawaves.rod.nonlinear.fields import Field, Rotator, cross
from dnawaves.rod.nonlinear.links import Links
from dnawaves.rod.nonlinear.state import State
from dnawaves.rod.rod import FloatArray

# bodies worked on at a time: the arrays of one step then stay in the processor's cache
BODIES_AT_A_TIME = 6400
# of pi: beyond pi the rotation vector of a link turns round, and its energy with it
LARGEST_ROTATION = 0.9


def motions(chain: NonlinearChain, state: State) -> Iterator[tuple[slice, Motion]]:
    """Yield portions of the states, flattened along their leading axes, as `Motion`."""
    if state.origins_nm.shape[-2:] != (chain.bodies, 3):
        raise InputError(f"the state has {state.origins_nm.shape[-2]} bodies, not {chain.bodies}")
    total = int(np.prod(state.leading))
    size = max(1, BODIES_AT_A_TIME // chain.bodies)
    flat = State(
        state.origins_nm.reshape(total, chain.bodies, 3),
        state.quaternions.reshape(total, chain.bodies, 4),
        state.momenta.reshape(total, chain.bodies, 6),
    )
    for start in range(0, total, size):
        portion = slice(start, min(start + size, total))
        yield portion, Motion(chain, flat[portion])


class Motion:
    """Chains of one kind, from their states (batch, bodies, ...), laid out as `Links` says."""

    def __init__(self, chain: NonlinearChain, state: State) -> None:
        self.batch = len(state.origins_nm)
        n = chain.bodies * self.batch
        aligned = np.array_equal(chain.principal, np.broadcast_to(np.eye(3), (chain.bodies, 3, 3)))
        principal = Rotation.from_matrix(chain.principal).as_quat()
        self.bodies = Bodies(
            self._spread(chain.mass[:, np.newaxis]),
            self._spread(chain.moments),
            None if aligned else self._spread(principal),
            n,
        )
        offset = np.any(chain.centres_nm)
        self._centre = Field.of(self._spread(chain.centres_nm)) if offset else None
        self._arm, self._moment, self._scratch = (Field.empty(3, n) for _ in range(3))
        self._rotator = Rotator(n)
        self._origins = Field.empty(3, n) if offset else self.bodies.centres
        self._held = np.flatnonzero(~chain.free)
        self.impulses = Field.empty(6, n)
        self._fill(state)
        self.links = Links(
            chain.stiffness[0] if np.ptp(chain.stiffness, axis=0).max() == 0 else chain.stiffness,
            self._spread(chain.rest_strains),
            self._origins,
            self.bodies.quaternions,
            self.batch,
        )

    def strain(self, time_ps: float = 0.0, first_rod: int = 0) -> None:
        """Take the strains of the links from where the bodies are.

        Raises SimulationError if a link is rotated too far or its strain is not finite.
        """
        if self._centre is not None:
            self._rotator.to_laboratory(self._centre, self.bodies.quaternions, self._arm)
            np.subtract(self.bodies.centres.all, self._arm.all, out=self._origins.all)
        self.links.strain()
        cosine = self.links.cosine
        # also false where the cosine is not a number
        if not cosine.min() > np.cos(LARGEST_ROTATION * np.pi / 2):
            link, rod = divmod(int(np.argmin(cosine)), self.batch)
            angle = 2 * np.arccos(np.clip(cosine[link * self.batch + rod], -1, 1)) / np.pi
            found = (
                f"is rotated by {angle:.2f} pi" if np.isfinite(angle) else "has no finite strain"
            )
            raise SimulationError(
                f"link {link} (bodies {link} and {link + 1}) of rod {first_rod + rod} {found} at "
                f"{time_ps:.6g} ps; up to {LARGEST_ROTATION} pi is allowed"
            )

    def pull(self, stiffness: FloatArray, load: FloatArray | None = None) -> None:
        """Set the impulses of the links, at the last strains, and of a load (6, n), on the bodies.

        Force and torque about the centre of mass, along the laboratory's axes; `stiffness` is that
        of the links times a time. Held bodies get none.
        """
        impulses = self.impulses
        self.links.impulses(stiffness, impulses.all)
        if load is not None:
            np.add(impulses.all, load, out=impulses.all)
        if self._centre is not None:
            cross(impulses.vector, self._arm, self._moment, self._scratch)
            np.add(impulses.all[3:], self._moment.all, out=impulses.all[3:])
        if self._held.size:
            impulses.all.reshape(6, -1, self.batch)[:, self._held] = 0.0

    def kick(self) -> None:
        """Add the impulses to the momenta."""
        np.add(self.bodies.momenta.all, self.impulses.all, out=self.bodies.momenta.all)

    def state(self) -> State:
        """Return the states (batch, bodies, ...)."""
        bodies = self.bodies
        if self._centre is not None:
            self._rotator.to_laboratory(self._centre, bodies.quaternions, self._arm)
            np.subtract(bodies.centres.all, self._arm.all, out=self._origins.all)
        arrays = self._origins.all, bodies.quaternions.all, bodies.momenta.all
        return State(*(self.user_shape(array) for array in arrays))

    def user_shape(self, array: FloatArray) -> FloatArray:
        """Return (batch, bodies, components) of (components, bodies batch)."""
        return array.reshape(len(array), -1, self.batch).transpose(2, 1, 0).copy()

    def laid_out(self, array: FloatArray) -> FloatArray:
        """Return (components, bodies batch) of (batch, bodies, components)."""
        return np.ascontiguousarray(array.transpose(2, 1, 0)).reshape(array.shape[2], -1)

    def _spread(self, values: FloatArray) -> FloatArray:
        """Return (components, bodies batch), or (components, 1) if equal, of (bodies, comp.)."""
        if np.ptp(values, axis=0).max() == 0:
            return values[:1].T.copy()
        return np.repeat(values.T, self.batch, axis=1)

    def _fill(self, state: State) -> None:
        bodies = self.bodies
        bodies.momenta.all[:] = self.laid_out(state.momenta)
        quaternions = state.quaternions / np.linalg.norm(state.quaternions, axis=-1, keepdims=True)
        # of the two quaternions of a rotation, those on one side: their middle is then the nearer
        turns = np.sum(quaternions[:, 1:] * quaternions[:, :-1], axis=-1)
        quaternions[:, 1:] *= np.cumprod(np.where(turns < 0, -1.0, 1.0), axis=1)[..., np.newaxis]
        bodies.quaternions.all[:] = self.laid_out(quaternions)
        self._origins.all[:] = self.laid_out(state.origins_nm)
        if self._centre is not None:
            self._rotator.to_laboratory(self._centre, bodies.quaternions, self._arm)
            np.add(self._origins.all, self._arm.all, out=bodies.centres.all)

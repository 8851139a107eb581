"""The links of a chain of rigid bodies: their strains, their energy and its exact gradient.

Link j joins bodies j and j + 1. With psi = log(R_j^T R_{j+1}) and R_mid = R_j exp(psi/2) its strain
is (R_mid^T (x_{j+1} - x_j), psi) and its energy 1/2 (strain - rest) . K (strain - rest).

Gradient. Seen in the mid-frame, let the bodies turn by a and b. With the quaternion (v, w) of the
link's rotation by the angle t, f = (t/2)/sin(t/2) and u = v/(1 + w):
psi changes by S (b - a), S = f across the axis and 1 along it;
the mid-frame turns by (a + b)/2 - u x (b - a)/2.
"""

from __future__ import annotations

import numpy as np

from dnawaves.rod.nonlinear.fields import Field, cross
from dnawaves.rod.rod import FloatArray

# squares to a normal number, and vanishes beside the square of any angle
TINY = 1e-300


class Links:
    """The links of `batch` chains of `bodies` bodies, and room to work on them.

    Arrays run over (components, bodies, batch), the last two flattened.

    Parameters
    ----------
    stiffness : (6, 6) or (bodies - 1, 6, 6)
    rest : (6, 1) or (6, (bodies - 1) batch)
        Strains at rest: nm, rad.
    origins, quaternions : Field (3, bodies batch), (4, bodies batch)
        Where the bodies are; looked at anew by `strain`.
    """

    def __init__(
        self,
        stiffness: FloatArray,
        rest: FloatArray,
        origins: Field,
        quaternions: Field,
        batch: int,
    ) -> None:
        n = origins.all.shape[1] - batch
        self.stiffness, self._rest, self._batch = stiffness, rest, batch
        self._left, self._right = slice(None, -batch), slice(batch, None)
        self._x = origins.columns(self._left), origins.columns(self._right)
        self._q = quaternions.columns(self._left), quaternions.columns(self._right)
        self.cosine = np.empty(n)
        self._deviation = np.empty((6, n))
        self._displacement, self._gamma = Field.empty(3, n), Field.empty(3, n)
        self._sine, self._half_tangent = Field.empty(3, n), Field.empty(3, n)
        self._scratch = Field.empty(3, n), Field.empty(3, n)
        self._quaternion = Field.empty(4, n)
        self._per_sine, self._inverse, self._number = (np.empty(n) for _ in range(3))
        self._axes = np.empty((3, 3, n))
        self._axes_part = tuple(tuple(row) for row in self._axes)
        # force, half its moment and the torque along the mid-frame; then in the laboratory
        self._loads, self._loads_out, self._loads_scratch = (np.empty((3, 3, n)) for _ in range(3))
        self._load_fields = tuple(Field.of(load) for load in self._loads)

    def strain(self) -> None:
        """Take the strains of all links from where the bodies are."""
        (x0, x1), (q0, q1) = self._x, self._q
        a, b = self._scratch
        w, v, inverse, number = self.cosine, self._sine, self._inverse, self._number
        middle = self._quaternion
        np.multiply(q0.all, q1.all, out=middle.all)
        np.add.reduce(middle.all, axis=0, out=w)
        # v = w0 v1 - w1 v0 - v0 x v1
        cross(q1.vector, q0.vector, v, a)
        np.multiply(q0.parts[3], q1.all[:3], out=a.all)
        np.add(v.all, a.all, out=v.all)
        np.multiply(q1.parts[3], q0.all[:3], out=a.all)
        np.subtract(v.all, a.all, out=v.all)
        np.add(w, 1.0, out=inverse)
        np.divide(1.0, inverse, out=inverse)
        # |q0 + q1|^2 = 2 (1 + w): the middle of the shortest way between the two
        np.add(q0.all, q1.all, out=middle.all)
        self._set_axes(middle, inverse)
        np.subtract(x1.all, x0.all, out=self._displacement.all)
        gamma = self._gamma
        d0, d1, d2 = self._displacement.parts
        np.multiply(self._axes[0], d0, out=gamma.all)
        np.multiply(self._axes[1], d1, out=a.all)
        np.add(gamma.all, a.all, out=gamma.all)
        np.multiply(self._axes[2], d2, out=a.all)
        np.add(gamma.all, a.all, out=gamma.all)
        # f = (t/2)/sin(t/2); without TINY 0/0 at t = 0
        np.multiply(v.all, v.all, out=a.all)
        np.add.reduce(a.all, axis=0, out=number)
        np.add(number, TINY, out=number)
        np.sqrt(number, out=number)
        np.arctan2(number, w, out=self._per_sine)
        np.divide(self._per_sine, number, out=self._per_sine)
        np.multiply(number, number, out=number)
        deviation = self._deviation
        np.add(self._per_sine, self._per_sine, out=b.parts[0])
        np.multiply(v.all, b.parts[0], out=deviation[3:])
        deviation[:3] = gamma.all
        np.subtract(deviation, self._rest, out=deviation)

    def energy(self) -> FloatArray:
        """Return the energy (links, batch) at the last strains."""
        loads = np.empty_like(self._deviation)
        self._multiply(self.stiffness, loads)
        return np.einsum("in,in->n", loads, self._deviation).reshape(-1, self._batch) / 2

    def impulses(self, stiffness: FloatArray, out: FloatArray) -> None:
        """Set `out` (6, bodies batch) to minus the gradient at the last strains.

        Force and torque about each body's origin, along the laboratory's axes; `stiffness` in
        place of that of the links, so that a time can be multiplied in.
        """
        force, moment, torque = self._load_fields
        v, number = self._sine, self._number
        a, b = self._scratch
        self._multiply(stiffness, self._loads.reshape(9, -1)[:6])
        # torque = S moment = f moment + (1 - f) (v . moment) v/v^2
        np.multiply(v.all, moment.all, out=a.all)
        np.add.reduce(a.all, axis=0, out=b.parts[0])
        np.subtract(1.0, self._per_sine, out=b.parts[1])
        np.multiply(b.parts[0], b.parts[1], out=b.parts[0])
        np.divide(b.parts[0], number, out=b.parts[0])
        np.multiply(v.all, b.parts[0], out=a.all)
        np.multiply(moment.all, self._per_sine, out=torque.all)
        np.add(torque.all, a.all, out=torque.all)
        # half the moment of the force, which the mid-frame's turn does work against
        cross(force, self._gamma, moment, a)
        np.multiply(moment.all, 0.5, out=moment.all)
        np.multiply(v.all, self._inverse, out=self._half_tangent.all)
        cross(moment, self._half_tangent, b, a)
        np.subtract(torque.all, b.all, out=torque.all)
        lab, scratch, axes, loads = self._loads_out, self._loads_scratch, self._axes, self._loads
        np.multiply(axes[:, 0], loads[:, 0, np.newaxis], out=lab)
        for k in (1, 2):
            np.multiply(axes[:, k], loads[:, k, np.newaxis], out=scratch)
            np.add(lab, scratch, out=lab)
        out[:, : self._batch] = 0.0
        np.negative(lab[0], out=out[:3, self._right])
        np.add(lab[1], lab[2], out=scratch[0])
        np.negative(scratch[0], out=out[3:, self._right])
        left = out[:, self._left]
        np.add(left[:3], lab[0], out=left[:3])
        np.subtract(lab[2], lab[1], out=scratch[0])
        np.add(left[3:], scratch[0], out=left[3:])

    def _set_axes(self, quaternion: Field, factor: FloatArray) -> None:
        """Set the mid-frames' matrices from any multiple q of their quaternion; factor 2/|q|^2."""
        x, y, z, _ = quaternion.parts
        (xx, xy, xz), (wx, wy, wz) = (scratch.parts for scratch in self._scratch)
        scaled = self._half_tangent
        np.multiply(quaternion.all[:3], factor, out=scaled.all)
        np.multiply(quaternion.parts[3], scaled.all, out=self._scratch[1].all)
        np.multiply(x, scaled.all, out=self._scratch[0].all)
        (m00, m01, m02), (m10, m11, m12), (m20, m21, m22) = self._axes_part
        np.subtract(xy, wz, out=m01)
        np.add(xy, wz, out=m10)
        np.add(xz, wy, out=m02)
        np.subtract(xz, wy, out=m20)
        np.subtract(1.0, xx, out=m00)
        yy, yz, zz = xy, xz, wy
        np.multiply(y, scaled.parts[1], out=yy)
        np.multiply(y, scaled.parts[2], out=yz)
        np.multiply(z, scaled.parts[2], out=zz)
        np.subtract(yz, wx, out=m12)
        np.add(yz, wx, out=m21)
        np.subtract(m00, yy, out=m22)
        np.subtract(m00, zz, out=m11)
        np.add(yy, zz, out=zz)
        np.subtract(1.0, zz, out=m00)

    def _multiply(self, stiffness: FloatArray, out: FloatArray) -> None:
        if stiffness.ndim == 2:
            np.matmul(stiffness, self._deviation, out=out)
            return
        shape = (6, -1, self._batch)
        deviation = self._deviation.reshape(shape).transpose(1, 0, 2)
        np.matmul(stiffness, deviation, out=out.reshape(shape).transpose(1, 0, 2))

"""Noise of a record: white, of a given covariance, or learnt from quiet data; and whitening by it.

Every kind of noise whitens fields (..., time, channel) to (..., direction, time), in which the
noise of a record is a set of independent standard normal numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray

from dnawaves.errors import InputError
from dnawaves.rod.modal import ModalChain, impulse_response

Array = NDArray[np.float64]

# Of the coefficients that predict a sample from the ones before it; Akaike's criterion chooses.
# Many: a velocity sampled finely has no power at frequency zero, which few coefficients miss.
LARGEST_ORDER = 60
FEWEST_QUIET_FRAMES = 40


class Noise(Protocol):
    """What a fit needs to know of the noise.

    `level_known` says whether a residual can be compared with it, `quiet_samples` from how many
    samples of each direction it was learnt (infinite if it was given).
    """

    @property
    def level_known(self) -> bool: ...

    @property
    def quiet_samples(self) -> float: ...

    def whiten(self, field: Array) -> Array: ...


@dataclass(frozen=True, eq=False)
class WhiteNoise:
    """Independent noise of every sample; `sd` is a number or one for each channel.

    Without `sd` the level is unknown and taken from the residual of the fit.
    """

    sd: ArrayLike | None = None
    quiet_samples: float = np.inf

    @property
    def level_known(self) -> bool:
        return self.sd is not None

    def whiten(self, field: Array) -> Array:
        scaled = field / np.asarray(1.0 if self.sd is None else self.sd, dtype=float)
        return np.swapaxes(scaled, -1, -2)


@dataclass(frozen=True, eq=False)
class ColouredNoise:
    """Noise stationary in time and independent in each of some combinations of the channels.

    Parameters
    ----------
    directions : (direction, channel)
        The combinations; of thermal motion the normal modes, see `mode_directions`.
    whitener : (direction, time, time)
        Lower triangular inverse of the Cholesky factor of each direction's covariance.
    """

    directions: Array
    whitener: Array
    quiet_samples: float = np.inf
    level_known: bool = True

    @classmethod
    def of_covariance(cls, autocovariance: Array, directions: Array) -> ColouredNoise:
        """Return the noise of a given autocovariance (direction, lag), one lag for each frame."""
        whitener = []
        for covariance in autocovariance:
            try:
                root = np.linalg.cholesky(scipy.linalg.toeplitz(covariance))
            except np.linalg.LinAlgError as error:
                raise InputError(
                    "the noise's autocovariance is not positive definite; add the white noise of "
                    "the measurement to its lag 0"
                ) from error
            unit = np.eye(len(covariance))
            whitener.append(scipy.linalg.solve_triangular(root, unit, lower=True))
        return cls(directions, np.array(whitener))

    @classmethod
    def of_thermal_motion(
        cls,
        chain: ModalChain,
        times_ps: Array,
        friction_per_ps: float,
        energy: float,
        white_sd: float = 0.0,
    ) -> ColouredNoise:
        """Return the noise of the thermal velocities of a chain's moving channels.

        `energy` is kT divided by the number of independent runs that were averaged. By fluctuation
        and dissipation the autocovariance of a mode's velocity is kT times its answer to a unit
        impulse. `white_sd` is the measurement's own noise, for unit masses.
        """
        lags = times_ps - times_ps[0]
        motion = impulse_response(lags, chain.frequencies_rad_per_ps, friction_per_ps)[1]
        covariance = energy * motion.T
        covariance[:, 0] += white_sd**2
        return cls.of_covariance(covariance, mode_directions(chain))

    @classmethod
    def of_quiet_data(
        cls, quiet: Array, frames: int, directions: Array | None = None
    ) -> ColouredNoise:
        """Return the noise learnt from quiet data (time, channel) or (run, time, channel).

        `frames` is the length of the records to be whitened, sampled at the same interval. Each
        direction is an autoregressive process: Burg's method, its order by Akaike's criterion and
        its level by Akaike's final prediction error, so that it fits new data.
        """
        runs = quiet if quiet.ndim == 3 else quiet[np.newaxis]
        directions = np.eye(runs.shape[-1]) if directions is None else directions
        samples = runs.shape[0] * runs.shape[1]
        if runs.shape[1] < FEWEST_QUIET_FRAMES:
            raise InputError(
                f"quiet data of {runs.shape[1]} frames; at least {FEWEST_QUIET_FRAMES} are needed"
            )
        whitener = [_predictor_rows(*_burg(runs @ direction), frames) for direction in directions]
        return cls(directions, np.array(whitener), samples)

    def only(self, chosen: Sequence[int]) -> ColouredNoise:
        """Return the noise of the amplitudes (time, chosen) along some of the directions."""
        unit = np.eye(len(chosen))
        return ColouredNoise(unit, self.whitener[list(chosen)], self.quiet_samples)

    def whiten(self, field: Array) -> Array:
        projected = np.swapaxes(field @ self.directions.T, -1, -2)
        return (self.whitener @ projected[..., np.newaxis])[..., 0]


def mode_directions(chain: ModalChain) -> Array:
    """Return what projects moving channels on the mass-normalised modes, (mode, channel)."""
    free = np.flatnonzero(chain.free)
    mass = np.diag(chain.mass) if chain.mass.ndim == 1 else chain.mass
    shapes = chain.shapes.reshape(len(chain.frequencies_rad_per_ps), -1)[:, free]
    return np.asarray(shapes @ mass[np.ix_(free, free)])


def _burg(runs: Array) -> tuple[list[Array], list[float]]:
    """Return predictors of order 0, 1, ... and the standard deviation of what each leaves.

    Burg's recursion for series (run, time) without a mean; cut at the order of least AIC.
    """
    samples = runs.size
    forward, backward = runs[:, 1:], runs[:, :-1]
    predictors, variances = [np.zeros(0)], [float(np.mean(runs**2))]
    for _ in range(min(LARGEST_ORDER, runs.shape[1] // 4)):
        power = float(np.sum(forward**2) + np.sum(backward**2))
        reflection = 2 * float(np.sum(forward * backward)) / power if power else 0.0
        last = predictors[-1]
        predictors.append(np.append(last - reflection * last[::-1], reflection))
        variances.append(variances[-1] * (1 - reflection**2))
        forward, backward = (
            (forward - reflection * backward)[:, 1:],
            (backward - reflection * forward)[:, :-1],
        )
    orders = np.arange(len(variances))
    criterion = samples * np.log(variances) + 2 * orders
    order = int(np.argmin(criterion))
    prediction = (1 + orders / samples) / (1 - orders / samples)
    spread = np.sqrt(np.array(variances) * prediction)
    return predictors[: order + 1], [float(sd) for sd in spread[: order + 1]]


def _predictor_rows(predictors: list[Array], spread: list[float], frames: int) -> Array:
    """Return the whitener (time, time): each sample less its prediction, over the spread."""
    rows = np.zeros((frames, frames))
    for frame in range(frames):
        order = min(frame, len(predictors) - 1)
        rows[frame, frame] = 1.0
        rows[frame, frame - order : frame] = -predictors[order][::-1]
        rows[frame] /= spread[order]
    return rows

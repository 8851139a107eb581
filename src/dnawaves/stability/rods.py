"""Rods at their hard limits: nearly singular, shortest, overdamped, degenerate, at a mode."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dnawaves.rod.chain import FiniteChain, ScalarChain
from dnawaves.rod.dispersion import dispersion
from dnawaves.rod.nonlinear.chain import NonlinearChain
from dnawaves.rod.nonlinear.energy import energy
from dnawaves.rod.nonlinear.run import run
from dnawaves.rod.oscillator import impulse_response, sine_drive_response
from dnawaves.rod.rod import EXTENSION, TWIST, Rod
from dnawaves.stability.case import Found
from dnawaves.stability.judge import stopped


def nearly_singular(one_less: float) -> Found:
    """Return the error of the slow axial wave, of the fastest, with C²/(S D) short of 1 so far.

    From 2x2 matrices by hand: the product of the two squared speeds is det K/(rho I), their sum
    S/rho + D/I, so that the small one is found without a difference.
    """
    paper = Rod.paper()
    stiffness = np.array(paper.stiffness)
    s, d = stiffness[EXTENSION, EXTENSION], stiffness[TWIST, TWIST]
    coupling = np.sqrt(s * d) * np.sqrt(1 - one_less)
    stiffness[EXTENSION, TWIST] = stiffness[TWIST, EXTENSION] = coupling
    rod = replace(paper, stiffness=stiffness)
    rho, inertia, k = rod.density_Da_per_nm, rod.inertia_Da_nm[2, 2], 0.5
    total = s / rho + d / inertia
    # One minus the square of what was rounded, not `one_less`.
    product = s * d * (1 - (coupling / np.sqrt(s * d)) ** 2) / (rho * inertia)
    large = (total + np.sqrt(total**2 - 4 * product)) / 2
    found = dispersion(rod, [k], lattice=False)[0]
    errors = [np.abs(found - k * np.sqrt(squared)).min() for squared in (large, product / large)]
    slow = k * np.sqrt(product / large)
    return Found(
        "holds",
        float(max(errors) / found.max()),
        f"slow wave at {slow:.3g} rad/ps beside {found.max():.3g} rad/ps",
    )


def singular(one_less: float) -> Found:
    """Return how a stiffness that is singular to round-off is refused."""
    return stopped(lambda: nearly_singular(one_less), "stiffness", "not positive definite")


def shortest() -> Found:
    """Return the largest relative error of the frequencies of chains of two base pairs."""
    mass, link = 3.0, 7.0
    free = ScalarChain([mass, mass], link).frequencies_rad_per_ps
    held = ScalarChain([mass, mass], link, held=[0]).frequencies_rad_per_ps
    exact = np.sqrt([2 * link / mass, link / mass])
    errors = np.abs(np.array([free[1], held[0]]) / exact - 1)
    whole = FiniteChain(Rod.paper(twisted=True), 2).frequencies_rad_per_ps
    rigid = int(np.sum(whole < 1e-9 * whole.max()))
    return Found("holds", float(max([*errors, abs(rigid - 6)])), f"{rigid} rigid motions, free")


def too_short() -> Found:
    """Return how a chain of one base pair is refused."""
    return stopped(lambda: FiniteChain(Rod.paper(), 1), "at least 2 base pairs")


def overdamped(friction_per_ps: float) -> Found:
    """Return the largest relative error of an overdamped mode against its slow decay.

    With friction far above the frequency, after a kick q = (exp(-slow t) - exp(-fast t))/(fast -
    slow) with slow = 2 w²/(g + sqrt(g² - 4 w²)).
    """
    w, t = 2.0, np.array([0.0, 1e-9, 1e-3, 1.0, 1e3, 1e7])
    root = np.sqrt(friction_per_ps**2 - 4 * w**2)
    fast = (friction_per_ps + root) / 2
    slow = w**2 / fast
    # The longer time first: exp(-slow t) (1 - exp(-root t)) has no cancellation.
    exact = np.exp(-slow * t) * -np.expm1(-root * t) / root
    found = impulse_response(t, [w], friction_per_ps)[0][:, 0]
    error = np.abs(found - exact)[1:] / exact[1:].max()
    return Found(
        "holds", float(error.max()), f"slow rate {slow:.1e} per ps, fast {fast:.1e} per ps"
    )


def degenerate(pairs: int) -> Found:
    """Return how far the modes of an isotropic chain are from orthonormal."""
    chain = FiniteChain(Rod.paper(), pairs, held=[0, -1])
    shapes = chain.shapes.reshape(len(chain.frequencies_rad_per_ps), -1)
    w = chain.frequencies_rad_per_ps
    twins = int(np.sum(np.diff(w) < 1e-9 * w.max()))
    return Found(
        "holds",
        float(np.abs(shapes @ chain.mass @ shapes.T - np.eye(len(shapes))).max()),
        f"{twins} frequencies equal to the next one of {len(w)}",
    )


def at_a_mode(detuning: float, periods: int) -> Found:
    """Return the largest error of an undamped mode driven at or beside itself, of the largest.

    At the mode q = (sin wt - wt cos wt)/(2 w²); beside it, q = (w sin pt - p sin wt)/(w (w² - p²)).
    """
    w = 3.0
    t = np.linspace(0, periods * 2 * np.pi / w, 4001)
    p = w * (1 + detuning)
    found = sine_drive_response(t, [w], 0.0, p)[0][:, 0]
    exact = (np.sin(w * t) - w * t * np.cos(w * t)) / (2 * w**2)
    if abs(detuning) > 1e-9:
        half = w * detuning / 2
        middle = w + half
        # The beat, written without the difference of two nearly equal sines.
        exact = (np.sin(w * t) / w - np.cos(middle * t) * np.sin(half * t) / half) / (w + p)
    return Found(
        "holds",
        float(np.abs(found - exact).max() / np.abs(exact).max()),
        f"amplitude {np.abs(found).max():.3g} after {periods} periods",
    )


def nonlinear_timestep(share: float, steps: int) -> Found:
    """Return the fluctuation of the energy, of what was put in, at a share of the Courant limit."""
    chain = NonlinearChain.uniform(Rod.paper(), 12)
    kick = np.zeros((12, 6))
    kick[0, EXTENSION] = 0.01
    start = chain.kicked(chain.at_rest(), kick)
    record = run(chain, start, share * chain.timestep_limit_ps, steps, record_every=10)
    found = energy(chain, record.states)
    return Found(
        "holds",
        float(np.ptp(found) / found[0]),
        f"limit {chain.timestep_limit_ps:.3g} ps; energy at the end {found[-1] / found[0]:.4f}",
    )


def nonlinear_timestep_refused(share: float) -> Found:
    """Return how a timestep at or beyond the Courant limit is refused."""
    return stopped(lambda: nonlinear_timestep(share, 10), "timestep", r"below \S+ ps")


def nonlinear_overturned() -> Found:
    """Return how a link that is turned by nearly half a turn is stopped."""

    def turn() -> None:
        chain = NonlinearChain.uniform(Rod.paper(), 3)
        spin = np.zeros((3, 6))
        spin[2, 4] = 400.0
        run(chain, chain.kicked(chain.at_rest(), spin), 0.1 * chain.timestep_limit_ps, 400)

    return stopped(turn, "link", "ps")

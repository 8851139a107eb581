"""The integrator of a scene: with or without a drive, with or without a thermostat."""

from __future__ import annotations

import openmm

from dnawaves.scene.excitations import PULSE_DELAY_WIDTHS, Periodic, Pulse
from dnawaves.scene.models import SceneSpec
from dnawaves.system.effects.thermostat import langevin_middle
from dnawaves.trajectory.plan import Plan
from dnawaves.trajectory.verlet import (
    Bath,
    driven_leapfrog,
    gaussian_course,
    leapfrog,
    sine_course,
    steps_per_sum,
)

# Of constrained distances, relative: at OpenMM's 1e-5 the energy drifts.
CONSTRAINT_TOLERANCE = 1e-7


def integrator_of(scene: SceneSpec, plan: Plan) -> openmm.Integrator:
    """Return the integrator that a scene needs; its noise has no seed yet."""
    environment, thermostat = scene.system.environment, scene.thermostat
    course = course_of(scene, plan)
    integrator: openmm.Integrator
    if course is not None:
        bath = None
        if thermostat is not None:
            bath = Bath(environment.temperature_K, thermostat.friction_per_ps)
        integrator = driven_leapfrog(
            plan.timestep_ps,
            course,
            steps_per_sum=steps_per_sum(plan.steps_per_frame),
            bath=bath,
            constrained=is_constrained(scene),
        )
    elif thermostat is not None:
        integrator = langevin_middle(
            environment.temperature_K, thermostat.friction_per_ps, plan.timestep_ps, seed=1
        )
    else:
        integrator = leapfrog(plan.timestep_ps)
    if is_constrained(scene):
        integrator.setConstraintTolerance(CONSTRAINT_TOLERANCE)
    return integrator


def is_constrained(scene: SceneSpec) -> bool:
    """Return whether a scene's System has constraints: on bonds to hydrogen, or in its water."""
    return scene.system.explicit or scene.system.environment.constraints != "none"


def course_of(scene: SceneSpec, plan: Plan) -> str | None:
    """Return the drive's course in the time `t` in ps, as OpenMM's expression; None without."""
    if isinstance(scene.excitation, Periodic):
        assert plan.frequency_GHz is not None
        return sine_course(plan.frequency_GHz, plan.ramp_ps)
    if isinstance(scene.excitation, Pulse):
        assert plan.pulse_width_ps is not None
        width_ps = plan.pulse_width_ps
        return gaussian_course(PULSE_DELAY_WIDTHS * width_ps, width_ps)
    return None

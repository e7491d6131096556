"""From a result to what is watched when the axis is let go."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.pipeline.certification import Result
from nrs_design.pipeline.design import Designed
from nrs_design.proof.system import Output, SwitchedSystem, Time

if TYPE_CHECKING:
    from nrs_design.simulation.release import Outputs


def physical_outputs(result: Result) -> Outputs | None:
    """Return force and velocity as rows over the state, with the limits of the spec.

    None where the state of the system does not hold the deflection of a contact, or a run from it
    would need rules that are not kept: for controllers that command a position, laws with a memory
    or a mass, two periods, and where contact may be lost at any deflection.

    Parameters
    ----------
    result : Result
        Of the certification.
    """
    designed, system = result.designed, result.certification.system
    if designed is None or not system.is_uniform or system.clock is not None:
        return None
    rules, contacts = system.switching, designed.design.contacts
    plain = all(c.law.commands == "velocity" for c in designed.design.controllers)
    ruled = bool(rules.resets) or (system.contact is not None and not rules.is_arbitrary)
    heavy = any(environment.law.has_mass for environment in designed.plant.among(contacts))
    if not plain or ruled or heavy or not contacts or system.states[-1] != "delta [rad]":
        return None
    anywhere = system.contact is None and designed.spec.contact == "losable"
    if anywhere and system.time is Time.DISCRETE:
        return None
    import numpy as np

    from nrs_design.simulation.release import Outputs

    limits = designed.spec.limits
    force, velocity = _outputs(designed, system)
    return Outputs(
        np.array([row.floats()[0] for row in force.rows]),
        np.array(velocity.rows[0].floats()[0]),
        limits.torque.si,
        limits.velocity.si,
        tuple(i for i, name in enumerate(system.states) if name.endswith("[N*m]")),
    )


def _outputs(designed: Designed, system: SwitchedSystem) -> tuple[Output, Output]:
    """Return force and velocity of the state of a system, which ends with the deflection."""
    spec, plant, motion = designed.spec, designed.plant, designed.design.motion
    touched = plant.among(designed.design.contacts)
    if system.time is Time.DISCRETE:
        from nrs_design.switched import sampled_inputs

        force, velocity = sampled_inputs.outputs_of(
            system.states, touched, spec.limits.torque.exact
        )
        return force, velocity
    from nrs_design.models.motion_loop import realize
    from nrs_design.switched.commanded import outputs_of
    from nrs_design.switched.joint import Joint

    joint = Joint.of(plant, motion)
    loop = realize(plant.motion_loop(motion.Kp, motion.Kd)) if joint is None else joint.nominal
    return outputs_of(system.states, loop, spec, touched)

"""From a result to what is watched when the axis is let go."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.pipeline.certification import Result
from nrs_design.proof.system import Time

if TYPE_CHECKING:
    from nrs_design.simulation.release import Outputs


def physical_outputs(result: Result) -> Outputs | None:
    """Return force and velocity as rows over the state, with the limits of the spec.

    None where the state of the system does not hold the deflection of a contact, or a run from it
    would need rules that are not kept: in discrete time, for controllers that command a position,
    and for laws with a memory.

    Parameters
    ----------
    result : Result
        Of the certification.
    """
    designed, system = result.designed, result.certification.system
    if designed is None or system.time is not Time.CONTINUOUS or not system.is_uniform:
        return None
    rules, contacts = system.switching, designed.design.contacts
    plain = all(c.law.commands == "velocity" for c in designed.design.controllers)
    ruled = bool(rules.resets) or (system.contact is not None and not rules.is_arbitrary)
    if not plain or ruled or not contacts or system.states[-1] != "delta [rad]":
        return None
    import numpy as np

    from nrs_design.models.motion_loop import realize
    from nrs_design.simulation.release import Outputs
    from nrs_design.switched.commanded import outputs_of
    from nrs_design.switched.joint import Joint

    spec, plant, motion = designed.spec, designed.plant, designed.design.motion
    joint = Joint.of(plant, motion)
    loop = realize(plant.motion_loop(motion.Kp, motion.Kd)) if joint is None else joint.nominal
    force, velocity = outputs_of(system.order, loop, spec, plant.among(contacts))
    return Outputs(
        np.array([row.floats()[0] for row in force.rows]),
        np.array(velocity.rows[0].floats()[0]),
        spec.limits.torque.si,
        spec.limits.velocity.si,
    )

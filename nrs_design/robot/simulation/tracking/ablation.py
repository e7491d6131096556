"""Why one controller tracks better: one thing changed at a time.

Both controllers without balance do the same three experiments, so that they can be compared.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from nrs_design.robot.controllers.motion_laws import ComputedTorque, IndependentJoint
from nrs_design.robot.models.robot import Robot
from nrs_design.robot.simulation.tracking.track import Track, build_track
from nrs_design.spec import RobotSpec

# Period of thesis 4.20 to 4.22 in s.
PERIOD = 10.0
# A guess at the gains that the robot had: it brings four of its measured errors within 13 %.
GUESSED = 30


def ablation_tracks(
    spec: RobotSpec, robot: Robot, period: float | None = None
) -> list[tuple[str, Track]]:
    """Return what is changed, and the track with that change; ``as designed`` first by controller.

    All sines have the period in s; by default 10 s, as in thesis 4.20 to 4.22.
    """
    period = PERIOD if period is None else period
    torque = build_track(spec, robot, "computed-torque", period)
    joint = build_track(spec, robot, "independent-joint", period)
    return [*_plant(torque), *_torque_laws(torque), *_plant(joint), *_joint_laws(joint)]


def _plant(track: Track) -> Iterator[tuple[str, Track]]:
    yield "as designed", track
    yield "no Coulomb friction", replace(track, drive=replace(track.drive, coulomb_friction=0.0))
    yield "encoder without counts", replace(track, encoder=replace(track.encoder, counts=None))


def _torque_laws(track: Track) -> Iterator[tuple[str, Track]]:
    law, drive = track.law, track.drive
    assert isinstance(law, ComputedTorque)
    full = replace(law, load=replace(law.load, correction=None))
    yield "full dynamics in the law", replace(track, law=full)
    rotor = replace(law, rotor_inertia=drive.inertia)
    yield "rotor inertia in the law", replace(track, law=rotor)
    both = replace(rotor, motor_damping=drive.damping)
    yield "rotor inertia and motor damping in the law", replace(track, law=both)
    stiff = replace(law, Kp=GUESSED * law.Kp, Kd=GUESSED * law.Kd)
    yield f"both gains times {GUESSED}", replace(track, law=stiff)


def _joint_laws(track: Track) -> Iterator[tuple[str, Track]]:
    law = track.law
    assert isinstance(law, IndependentJoint)
    assert law.load is not None
    exact = replace(law, load=replace(law.load, correction=None))
    yield "exact weight in the law", replace(track, law=exact)
    yield "no weight in the law", replace(track, law=replace(law, load=None))

"""Which features of an interaction design are not modelled beside which others: one table."""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.spec.check import Feature, Row, not_together
from nrs_design.spec.features import (
    ANGLE,
    AT_ONCE,
    BLEEDING,
    COMMAND,
    CONSTANT_MOTOR,
    CONSTANT_TISSUE,
    CONTACT_RULES,
    CONTINUOUS,
    DAMPED,
    DAMPED_FORCE,
    DISTURBED,
    DWELL,
    FILTER,
    GIVEN_LOOP,
    HAND,
    HEAVY_AT_ONCE,
    IDLE,
    IDLE_RESET,
    LAGGING_AT_ONCE,
    LIMITED,
    LOADED,
    LOSABLE,
    MEMORY,
    MISSES,
    MODE_LOGIC,
    MOTOR_RANGE,
    NOT_KEPT,
    OFFSET,
    OTHERS,
    PLACED,
    PRELOADED,
    RULES,
    SAMPLED,
    SAMPLED_DWELL,
    SATURATED,
    SEVERAL_CONTACTS,
    SLIDING,
    SPRUNG,
    STREAMED,
    TIMED,
    TISSUE_RANGE,
    TOOL,
    TORQUES,
    TWO_PERIODS,
    UNSPRUNG,
    VELOCITIES,
    ZEROED,
)
from nrs_design.spec.interaction_parts import AbstractInteractionSpec as Spec


def _beside(first: Feature[Spec], *others: Feature[Spec]) -> Iterator[Row[Spec]]:
    """Yield a row for the first feature beside each of the others."""
    return (not_together(first, other) for other in others)


# What may change while one controller is active, although a proof with a dwell time holds for
# constant modes only: environments obey no rule of ours.
CHANGING: tuple[tuple[Feature[Spec], ...], ...] = (
    (LOSABLE, SPRUNG),
    (MOTOR_RANGE,),
    (SEVERAL_CONTACTS,),
    (AT_ONCE,),
    (TISSUE_RANGE,),
)

COMBINATIONS: tuple[Row[Spec], ...] = (
    *_beside(HAND, LOSABLE, SAMPLED, DISTURBED, IDLE, LOADED),
    *_beside(PRELOADED, LOSABLE, DISTURBED),
    *_beside(MEMORY, SAMPLED, IDLE),
    # Its command would depend on itself.
    not_together(DAMPED_FORCE, CONTINUOUS),
    not_together(HEAVY_AT_ONCE),
    not_together(LOSABLE, LAGGING_AT_ONCE),
    not_together(OFFSET, IDLE),
    not_together(IDLE_RESET, BLEEDING),
    not_together(FILTER, OTHERS, CONTINUOUS),
    # The motor. Under a preload, one that carries what is touched rests elsewhere for every gain.
    *_beside(GIVEN_LOOP, MOTOR_RANGE, LOADED),
    not_together(LOADED, MOTOR_RANGE, PRELOADED),
    # It would lose what slows it within a period, too.
    not_together(LOADED, LOSABLE, SAMPLED),
    not_together(LOADED, SATURATED, SAMPLED),
    not_together(MOTOR_RANGE, OTHERS, CONTINUOUS),
    not_together(LOADED, OTHERS, CONTINUOUS),
    # No proof that rests on constants knows these, or they hold what is not constant.
    *_beside(CONSTANT_MOTOR, LOSABLE, TWO_PERIODS),
    *_beside(CONSTANT_TISSUE, LOSABLE, TWO_PERIODS, AT_ONCE, MEMORY, PRELOADED),
    # The sampled loop.
    not_together(OFFSET, SAMPLED),
    not_together(GIVEN_LOOP, SAMPLED),
    not_together(SAMPLED_DWELL, SAMPLED),
    *(not_together(DWELL, *features) for features in CHANGING),
    *_beside(TWO_PERIODS, OTHERS, RULES),
    # The rule for misses decides what may follow what.
    *_beside(MISSES, TWO_PERIODS, RULES, CONSTANT_MOTOR, CONSTANT_TISSUE),
    # A position of zero is a place of the robot, and nothing says where the contact is from there.
    not_together(ZEROED, PLACED),
    # Its command is a velocity, and nothing stands where a reference would.
    *_beside(VELOCITIES, OTHERS, SPRUNG, IDLE),
    *_beside(STREAMED, TWO_PERIODS, SATURATED),
    not_together(STREAMED, MOTOR_RANGE, CONTINUOUS),
    not_together(LIMITED, STREAMED),
    # Its law makes the torque, and what is touched brakes the joint between two samples.
    *_beside(TORQUES, TWO_PERIODS, CONTINUOUS, COMMAND),
    not_together(TIMED, CONTINUOUS),
    # What is about a pivot, or has units of a rotation in its words.
    *_beside(SLIDING, MODE_LOGIC, TOOL),
    not_together(COMMAND, OTHERS, SAMPLED),
    # It would move the position that the spring draws to.
    not_together(COMMAND, SPRUNG, SAMPLED),
    # An integral has to be balanced by a force.
    not_together(LOSABLE, BLEEDING, SAMPLED),
    not_together(LOSABLE, IDLE, SAMPLED),
    not_together(LOSABLE, SPRUNG, UNSPRUNG),
    # The position is added to the reference at every sample, which rounds an angle once more.
    not_together(ANGLE, IDLE, SAMPLED),
    # Modes are not made one by one beside these; free motion is a mode that no rule names.
    *_beside(CONTACT_RULES, IDLE, SAMPLED, OFFSET),
    not_together(CONTACT_RULES, LOSABLE, SPRUNG),
    not_together(SATURATED, OTHERS, CONTINUOUS),
    *_beside(SATURATED, TWO_PERIODS, GIVEN_LOOP, SPRUNG, IDLE_RESET),
    *_beside(SATURATED, AT_ONCE, TORQUES, MISSES),
    *_beside(SATURATED, MEMORY, HAND, PRELOADED),
    not_together(SATURATED, DAMPED, NOT_KEPT),
)

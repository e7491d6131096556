"""Which features of an interaction design are not modelled beside which others: one table."""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.spec.check import Feature, Row, not_together
from nrs_design.spec.features import (
    ANGLE,
    ANY_CONTACT,
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
    LONGEST_STAY,
    LOSABLE,
    MEMORY,
    MISSES,
    MODE_LOGIC,
    MOTOR_RANGE,
    NOT_KEPT,
    OFFSET,
    OTHER_TISSUE,
    OTHERS,
    PLACED,
    PRELOADED,
    RELAXED,
    RESTLESS,
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
    UNFILTERED,
    VELOCITIES,
    ZEROED,
)
from nrs_design.spec.interaction_parts import AbstractInteractionSpec as Spec


def _beside(first: Feature[Spec], *others: Feature[Spec], because: str = "") -> Iterator[Row[Spec]]:
    """Yield a row for the first feature beside each of the others."""
    return (not_together(first, other, because=because) for other in others)


# Beside these it counts what is touched by a controller that takes no force.
_FELT = FILTER, LOADED, MEMORY
# What may change while one controller is active.
CHANGING: tuple[tuple[Feature[Spec], ...], ...] = (
    (LOSABLE, SPRUNG),
    (MOTOR_RANGE,),
    (SEVERAL_CONTACTS,),
    (AT_ONCE,),
    (TISSUE_RANGE,),
    *((ANY_CONTACT, felt) for felt in _FELT),
)
_DWELLS = "a dwell time holds for a mode that stays as it is"
_CONSTANTS = "a proof about a constant lets every mode follow every other"
_MISSES = "the rule for misses decides what may follow what"

COMBINATIONS: tuple[Row[Spec], ...] = (
    not_together(HAND, LOSABLE, because="let go, its mass moves on by itself"),
    not_together(
        HAND, SAMPLED, because="a force sample would show the acceleration that its command makes"
    ),
    *_beside(
        HAND, DISTURBED, IDLE, because="a command that jumps accelerates its mass without bound"
    ),
    not_together(HAND, LOADED, because="its mass and the load would move as one"),
    not_together(PRELOADED, LOSABLE, because="without a force it is not what the spec knows of it"),
    not_together(PRELOADED, DISTURBED, because="what disturbs may lead out of its preload"),
    *(
        not_together(
            MEMORY,
            comes,
            SAMPLED,
            because="it would remember a contact that comes and goes within a period",
        )
        for comes in (LOSABLE, OTHER_TISSUE, ANY_CONTACT)
    ),
    *_beside(
        RESTLESS,
        SAMPLED,
        OTHERS,
        because="positions count from the place where it rests, and it has none",
    ),
    not_together(
        RESTLESS,
        OTHER_TISSUE,
        because="without a place of rest it shares no deflection with another",
    ),
    not_together(
        DAMPED_FORCE,
        CONTINUOUS,
        UNFILTERED,
        because="its command would depend on itself at once",
    ),
    not_together(
        HEAVY_AT_ONCE,
        because="what is touched at once has one deflection, and it has a motion of its own",
    ),
    not_together(
        LOSABLE, LAGGING_AT_ONCE, because="what lags is lost at another moment than the others"
    ),
    *_beside(
        OFFSET,
        IDLE,
        FILTER,
        LOADED,
        MEMORY,
        because="an offset moves the place of rest, which only the motion loop does not feel",
    ),
    not_together(IDLE_RESET, BLEEDING, because="what bleeds is not zero after a switch"),
    *_beside(GIVEN_LOOP, MOTOR_RANGE, LOADED, because="its motor is not known"),
    not_together(
        LOADED,
        MOTOR_RANGE,
        PRELOADED,
        because="a motor that carries a preload rests elsewhere for every gain",
    ),
    not_together(
        LOADED,
        LOSABLE,
        RELAXED,
        SAMPLED,
        because="what slows the motor is lost within a period, too",
    ),
    not_together(
        MOTOR_RANGE,
        OTHERS,
        CONTINUOUS,
        because="at a switch the reference jumps, and with it the speed, by numbers of the motor "
        "that are not known",
    ),
    *_beside(CONSTANT_MOTOR, LOSABLE, TWO_PERIODS, because=_CONSTANTS),
    *_beside(CONSTANT_TISSUE, LOSABLE, TWO_PERIODS, because=_CONSTANTS),
    *_beside(
        CONSTANT_TISSUE,
        AT_ONCE,
        MEMORY,
        PRELOADED,
        because="sums or rates of its numbers take their place",
    ),
    *(
        not_together(
            CONSTANT_TISSUE,
            carried,
            OTHER_TISSUE,
            SAMPLED,
            because="within a period the load may go from one to another",
        )
        for carried in (LOADED, TORQUES)
    ),
    # The sampled loop.
    not_together(OFFSET, SAMPLED, because="the program that ships stores no offset"),
    not_together(GIVEN_LOOP, SAMPLED, because="its program is not known"),
    not_together(
        LONGEST_STAY, SAMPLED, because="what must be left may grow, and parameters change in it"
    ),
    *_beside(SAMPLED_DWELL, CONSTANT_MOTOR, CONSTANT_TISSUE, because=_CONSTANTS),
    *_beside(SAMPLED_DWELL, IDLE_RESET, SATURATED, because="samples of a stay are counted instead"),
    *(not_together(DWELL, *features, because=_DWELLS) for features in CHANGING),
    not_together(
        TWO_PERIODS, OTHERS, because="it is not said in which of them a position is taken"
    ),
    not_together(TWO_PERIODS, RULES, because="it is not said in which of them a rule counts"),
    *_beside(MISSES, TWO_PERIODS, RULES, because=_MISSES),
    *_beside(MISSES, CONSTANT_MOTOR, CONSTANT_TISSUE, because=_CONSTANTS),
    not_together(
        ZEROED,
        PLACED,
        because="zero is a place of the robot, and nothing says where the contact is from there",
    ),
    *_beside(
        VELOCITIES,
        OTHERS,
        IDLE,
        because="a robot that takes velocities keeps no position reference",
    ),
    not_together(
        VELOCITIES,
        SPRUNG,
        CONTINUOUS,
        because="there a spring draws to the commanded position, which no sample holds",
    ),
    *_beside(STREAMED, TWO_PERIODS, SATURATED, because="its motion loop is not ours"),
    not_together(
        STREAMED,
        MOTOR_RANGE,
        CONTINUOUS,
        because="a change of it would move the states of its transfer function",
    ),
    not_together(LIMITED, STREAMED, because="nothing is known of the motor"),
    *_beside(
        TORQUES, TWO_PERIODS, COMMAND, because="its law makes the torque, and moves no reference"
    ),
    not_together(TORQUES, CONTINUOUS, because="its law counts the error from sample to sample"),
    not_together(TIMED, CONTINUOUS, because="what is on its way for a time is no state there"),
    *_beside(SLIDING, MODE_LOGIC, TOOL, because="it is about a pivot"),
    not_together(
        COMMAND,
        OTHERS,
        SAMPLED,
        because="the hand then commands a position, and nothing is said of its size",
    ),
    not_together(
        COMMAND, SPRUNG, SAMPLED, because="it would move the position that the spring draws to"
    ),
    not_together(LOSABLE, BLEEDING, SAMPLED, because="an integral has to be balanced by a force"),
    not_together(
        LOSABLE, IDLE, RELAXED, SAMPLED, because="in the air its reference stays where it is"
    ),
    not_together(
        LOSABLE, SPRUNG, RELAXED, because="in the air one rests in its place, the other anywhere"
    ),
    not_together(
        ANGLE,
        IDLE,
        SAMPLED,
        because="the position is added to the reference at every sample, which rounds once more",
    ),
    *(
        not_together(
            CONTACT_RULES, ANY_CONTACT, felt, because="what it touches counts, and obeys no rule"
        )
        for felt in _FELT
    ),
    not_together(
        CONTACT_RULES, SAMPLED, because="contact changes between samples, which no rule keeps"
    ),
    not_together(
        CONTACT_RULES, LOSABLE, SPRUNG, because="free motion is a mode that no rule names"
    ),
    not_together(
        SATURATED,
        OTHERS,
        CONTINUOUS,
        because="a reference that jumps commands the motor without bound",
    ),
    *_beside(SATURATED, TWO_PERIODS, MISSES, because="what is held was cut off in a period before"),
    not_together(SATURATED, GIVEN_LOOP, because="what it commands its motor is not known"),
    not_together(SATURATED, SPRUNG, because="where the spring draws to at first is not said"),
    not_together(SATURATED, IDLE_RESET, because="a reset takes the state out of its region"),
    not_together(SATURATED, AT_ONCE, because="which of them carries the first force is not said"),
    not_together(SATURATED, TORQUES, because="the limit is that of a motor, and it takes torques"),
    *_beside(
        SATURATED, MEMORY, HAND, because="its first force depends on more than the deflection"
    ),
    not_together(SATURATED, PRELOADED, because="its motion ends outside of the preload"),
    not_together(
        SATURATED, DAMPED, NOT_KEPT, because="what is damped lets go while its spring still pushes"
    ),
)

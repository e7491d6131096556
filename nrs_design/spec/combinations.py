"""Which features of an interaction design are not modelled beside which others: one table."""

from __future__ import annotations

from itertools import product
from typing import Any

from nrs_design.spec import features as has
from nrs_design.spec.check import Feature, Row, not_together
from nrs_design.spec.interaction_parts import AbstractInteractionSpec as Spec

# Beside these it counts what is touched by a controller that takes no force.
_FELT = (has.FILTER, has.LOADED, has.MEMORY)
# What may change while one controller is active.
CHANGING: tuple[tuple[Feature[Spec], ...], ...] = (
    (has.LOSABLE, has.SPRUNG),
    (has.MOTOR_RANGE,),
    (has.SEVERAL_CONTACTS,),
    (has.AT_ONCE,),
    (has.TISSUE_RANGE,),
    *((has.ANY_CONTACT, felt) for felt in _FELT),
)
_DWELLS = "a dwell time holds for a mode that stays as it is"
_CONSTANTS = "a proof about a constant lets every mode follow every other"
_MISSES = "the rule for misses decides what may follow what"

# A reason, and the features that are not modelled together; of those in brackets, each by itself.
_TABLE: tuple[tuple[Any, ...], ...] = (
    ("let go, its mass moves on by itself", has.HAND, has.LOSABLE),
    ("a force sample would show the acceleration that its command makes", has.HAND, has.SAMPLED),
    (
        "a command that jumps accelerates its mass without bound",
        has.HAND,
        (has.DISTURBED, has.IDLE),
    ),
    ("its mass and the load would move as one", has.HAND, has.LOADED),
    ("without a force it is not what the spec knows of it", has.PRELOADED, has.LOSABLE),
    ("what disturbs may lead out of its preload", has.PRELOADED, has.DISTURBED),
    (
        "it would remember a contact that comes and goes within a period",
        has.MEMORY,
        (has.LOSABLE, has.OTHER_TISSUE, has.ANY_CONTACT),
        has.SAMPLED,
    ),
    (
        "positions count from the place where it rests, and it has none",
        has.RESTLESS,
        (has.SAMPLED, has.OTHERS),
    ),
    (
        "without a place of rest it shares no deflection with another",
        has.RESTLESS,
        has.OTHER_TISSUE,
    ),
    (
        "its command would depend on itself at once",
        has.DAMPED_FORCE,
        has.CONTINUOUS,
        has.UNFILTERED,
    ),
    (
        "what is touched at once has one deflection, and it has a motion of its own",
        has.HEAVY_AT_ONCE,
    ),
    ("what lags is lost at another moment than the others", has.LOSABLE, has.LAGGING_AT_ONCE),
    (
        "an offset moves the place of rest, which only the motion loop does not feel",
        has.OFFSET,
        (has.IDLE, has.FILTER, has.LOADED, has.MEMORY),
    ),
    ("what bleeds is not zero after a switch", has.IDLE_RESET, has.BLEEDING),
    ("its motor is not known", has.GIVEN_LOOP, (has.MOTOR_RANGE, has.LOADED)),
    (
        "a motor that carries a preload rests elsewhere for every gain",
        has.LOADED,
        has.MOTOR_RANGE,
        has.PRELOADED,
    ),
    (
        "what slows the motor is lost within a period, too",
        has.LOADED,
        has.LOSABLE,
        has.RELAXED,
        has.SAMPLED,
    ),
    (
        "at a switch the reference jumps, and with it the speed, by numbers of the motor that are "
        "not known",
        has.MOTOR_RANGE,
        has.OTHERS,
        has.CONTINUOUS,
    ),
    (
        _CONSTANTS,
        (has.CONSTANT_MOTOR, has.CONSTANT_TISSUE),
        (has.LOSABLE, has.TWO_PERIODS),
    ),
    (
        "sums or rates of its numbers take their place",
        has.CONSTANT_TISSUE,
        (has.AT_ONCE, has.MEMORY, has.PRELOADED),
    ),
    (
        "within a period the load may go from one to another",
        has.CONSTANT_TISSUE,
        (has.LOADED, has.TORQUES),
        has.OTHER_TISSUE,
        has.SAMPLED,
    ),
    # The sampled loop.
    ("the program that ships stores no offset", has.OFFSET, has.SAMPLED),
    ("its program is not known", has.GIVEN_LOOP, has.SAMPLED),
    ("what must be left may grow, and parameters change in it", has.LONGEST_STAY, has.SAMPLED),
    (_CONSTANTS, has.SAMPLED_DWELL, (has.CONSTANT_MOTOR, has.CONSTANT_TISSUE), has.SAMPLED),
    (
        "samples of a stay are counted instead",
        has.SAMPLED_DWELL,
        (has.IDLE_RESET, has.SATURATED),
        has.SAMPLED,
    ),
    *((_DWELLS, has.DWELL, *features) for features in CHANGING),
    ("it is not said in which of them a position is taken", has.TWO_PERIODS, has.OTHERS),
    ("it is not said in which of them a rule counts", has.TWO_PERIODS, has.RULES),
    (_MISSES, has.MISSES, (has.TWO_PERIODS, has.RULES)),
    (_CONSTANTS, has.MISSES, (has.CONSTANT_MOTOR, has.CONSTANT_TISSUE)),
    (
        "zero is a place of the robot, and nothing says where the contact is from there",
        has.ZEROED,
        has.PLACED,
    ),
    (
        "a robot that takes velocities keeps no position reference",
        has.VELOCITIES,
        (has.OTHERS, has.IDLE),
    ),
    (
        "there a spring draws to the commanded position, which no sample holds",
        has.VELOCITIES,
        has.SPRUNG,
        has.CONTINUOUS,
    ),
    ("its motion loop is not ours", has.STREAMED, (has.TWO_PERIODS, has.SATURATED)),
    (
        "a change of it would move the states of its transfer function",
        has.STREAMED,
        has.MOTOR_RANGE,
        has.CONTINUOUS,
    ),
    ("nothing is known of the motor", has.LIMITED, has.STREAMED),
    (
        "its law makes the torque, and moves no reference",
        has.TORQUES,
        (has.TWO_PERIODS, has.COMMAND),
    ),
    ("its law counts the error from sample to sample", has.TORQUES, has.CONTINUOUS),
    ("what is on its way for a time is no state there", has.TIMED, has.CONTINUOUS),
    ("it is about a pivot", has.SLIDING, has.MODE_LOGIC),
    (
        "the hand then commands a position, and nothing is said of its size",
        has.COMMAND,
        has.OTHERS,
        has.SAMPLED,
    ),
    ("it would move the position that the spring draws to", has.COMMAND, has.SPRUNG, has.SAMPLED),
    ("an integral has to be balanced by a force", has.LOSABLE, has.BLEEDING, has.SAMPLED),
    ("in the air its reference stays where it is", has.LOSABLE, has.IDLE, has.RELAXED, has.SAMPLED),
    ("in the air one rests in its place, the other anywhere", has.LOSABLE, has.SPRUNG, has.RELAXED),
    (
        "the position is added to the reference at every sample, which rounds once more",
        has.ANGLE,
        has.IDLE,
        has.SAMPLED,
    ),
    ("what it touches counts, and obeys no rule", has.CONTACT_RULES, has.ANY_CONTACT, _FELT),
    ("contact changes between samples, which no rule keeps", has.CONTACT_RULES, has.SAMPLED),
    ("free motion is a mode that no rule names", has.CONTACT_RULES, has.LOSABLE, has.SPRUNG),
    (
        "a reference that jumps commands the motor without bound",
        has.SATURATED,
        has.OTHERS,
        has.CONTINUOUS,
    ),
    ("what is held was cut off in a period before", has.SATURATED, (has.TWO_PERIODS, has.MISSES)),
    ("what it commands its motor is not known", has.SATURATED, has.GIVEN_LOOP),
    ("where the spring draws to at first is not said", has.SATURATED, has.SPRUNG),
    ("a reset takes the state out of its region", has.SATURATED, has.IDLE_RESET),
    ("which of them carries the first force is not said", has.SATURATED, has.AT_ONCE),
    ("the limit is that of a motor, and it takes torques", has.SATURATED, has.TORQUES),
    ("its first force depends on more than the deflection", has.SATURATED, (has.MEMORY, has.HAND)),
    ("its motion ends outside of the preload", has.SATURATED, has.PRELOADED),
    (
        "what is damped lets go while its spring still pushes",
        has.SATURATED,
        has.DAMPED,
        has.NOT_KEPT,
    ),
)


def _rows(because: str, *features: Any) -> tuple[Row[Spec], ...]:
    each = (item if isinstance(item, tuple) else (item,) for item in features)
    return tuple(not_together(*together, because=because) for together in product(*each))


COMBINATIONS: tuple[Row[Spec], ...] = tuple(row for line in _TABLE for row in _rows(*line))

"""The assumptions of a certificate as a register: what each bounds, breaks and how it is tested.

A certificate holds sentences. Here each sentence is recognized by its words and becomes a noun
with what a reader must know to test it; docs/certificates/taken-for-granted.md is the same in
prose. A sentence that nobody has entered is listed too, as open.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from nrs_design.spec import InteractionDesignSpec


class Standing(StrEnum):
    """How well an assumption is supported."""

    TESTED = "tested"
    ARGUED = "argued"
    OPEN = "open"


@dataclass(frozen=True, slots=True)
class Assumption:
    """One thing that a certificate takes for granted.

    Parameters
    ----------
    name : str
        In a few words.
    statement : str
        As the certificate says it.
    bound : str
        Within what it must hold.
    breaks : str
        What no longer follows if it is false.
    test : str
        How to test it on the robot.
    standing : Standing
        Tested by records that the spec names, argued from how the product is made, or open.
    """

    name: str
    statement: str
    bound: str
    breaks: str
    test: str
    standing: Standing


MOTOR = "the motor is linear, in its ranges"
TISSUE = "environments follow their models in their ranges"
_NOTHING = "Nothing of the statement holds."
_READ = "read it back from the controller, or check the code that is generated"
_STAYS = "nrs-design audit LOG SPEC compares stays and transitions with the spec"
# Name, words that a sentence holds, bound, what breaks, test, standing; the first that fits counts.
_KINDS: tuple[tuple[str, str, str, str, str, Standing], ...] = (
    (
        "the identification is in doubt",
        r"^The identification of .* is in doubt",
        "the doubts that are listed",
        "The true values may lie outside the ranges, and then nothing is said about them.",
        "record what the doubt asks for, and identify again",
        Standing.OPEN,
    ),
    (
        "the force signal",
        r"force signal|gets the force|tool on the sensor",
        "filter and errors of the spec",
        "An error of the force moves the point of rest, or adds a lag.",
        "nrs-design identify tool, and the data sheet of the sensor",
        Standing.OPEN,
    ),
    (
        "what an identified range holds",
        r"was identified to hold",
        "the coverage that is named, for such specimens or motors",
        "Specimens or motors outside the coverage are not covered.",
        "identify from more specimens",
        Standing.OPEN,
    ),
    (
        "motions about a linearization are small",
        r"is the linearization about",
        "the deflections that were fitted",
        "Larger motions meet another stiffness than those of the range.",
        "log the deflection and compare it with the records",
        Standing.OPEN,
    ),
    (
        "the deflection stays within its preload",
        r"is a Hunt-Crossley law",
        "the preload of the environment",
        "Beyond the preload the force is not that of the ranges; nothing is said.",
        "log the deflection: nrs-design audit LOG SPEC",
        Standing.OPEN,
    ),
    (
        "no jitter",
        r"^The law runs every",
        "the period of the spec, exactly",
        "The modes are those of another period; a longer one may be unstable.",
        "log the time of every tick: nrs-design audit LOG SPEC",
        Standing.OPEN,
    ),
    (
        "age of the force sample",
        r"^The law uses (a|the) force sample",
        "the samples that are named",
        "An older sample is dead time that no mode holds.",
        "nrs-design identify delay LOG --command RAW --measured USED",
        Standing.OPEN,
    ),
    (
        MOTOR,
        r"linear actuator model|transfer function G\(s\)",
        "gain and time constant of the spec",
        "Motors outside are not covered.",
        "nrs-design identify actuator on steps and sinusoids",
        Standing.OPEN,
    ),
    (
        "what is touched does not load the motor",
        r"does not (load|slow) the motor",
        "torque of contact far below that of the motor",
        "The motor is slower in contact than in the modes.",
        "compare time constants identified in the air and in contact",
        Standing.OPEN,
    ),
    (
        "the load acts against a known inertia",
        r"torque of what is touched acts on the axis",
        "the load inertia of the spec",
        "The motor meets another load than in the modes.",
        "compare time constants identified in the air and in contact",
        Standing.OPEN,
    ),
    (
        "spring of the admittance",
        r"spring Kt|the spring takes the q",
        "position reference as described",
        "The spring draws to another place than in the modes.",
        "log reference and command across switches",
        Standing.ARGUED,
    ),
    (
        "inputs are zero, or bounded where that is said",
        r"^(Otherwise, a|A)ll inputs are zero|^Under a constant command|disturbance acts where|"
        r"velocity command acts where",
        "zero, or the bounds of the spec's disturbances",
        "Points of rest move; how far states then go is not said.",
        "log command and reference; their sizes against those of the spec",
        Standing.OPEN,
    ),
    (
        "friction keeps its sign over a period",
        r"friction changes its sign",
        "one period",
        "The bound under friction may be left.",
        "log the speed: it must not reverse within a period",
        Standing.OPEN,
    ),
    (
        "the bound is at the samples",
        r"bound on the force holds at the samples",
        "times of sampling",
        "Between two samples the force may be larger.",
        "log the force faster than the law runs",
        Standing.OPEN,
    ),
    (
        "axes do not act on each other",
        r"axes of the robot do not act",
        "zero coupling",
        "Another axis may take the place of an input, and feed back.",
        "command one axis with a step, and read the others' errors",
        Standing.OPEN,
    ),
    (
        "links stay within their bounds",
        r"^The axes act on each other through|matrix of inertia|Coriolis",
        "inertia, speed and torques that are declared",
        "Axes may drive each other further than the proof allows.",
        "nrs-design robot at the poses that are used, and a log of joint speeds",
        Standing.OPEN,
    ),
    (
        "gravity is compensated",
        r"^Gravity|torque of gravity",
        "its declared change over poses",
        "Gravity is a spring or a push that no mode holds.",
        "read the motors' torques at rest in the poses that are used",
        Standing.OPEN,
    ),
    (
        "each axis is touched by itself",
        r"What is touched acts on every axis by itself",
        "no torque from the deflection of another axis",
        "Tissue couples the axes, which is not modelled.",
        "push one axis into the tissue, and read the torques on the others",
        Standing.OPEN,
    ),
    (
        "nothing else is touched",
        r"nothing but .* is touched|any of the environments may be touched|touched at once|"
        r"touched from one side",
        "the contacts that the spec lists for a controller",
        "Any other contact is a mode that nothing is said about.",
        "by procedure: which tissue is met with which controller active",
        Standing.OPEN,
    ),
    (
        TISSUE,
        r"^In contact, the environment follows",
        "the ranges of the spec",
        "A stiffness outside, or a force of another form, is not covered.",
        "nrs-design identify tissue on presses at several places, depths and speeds",
        Standing.OPEN,
    ),
    (
        "contact is kept, or lost as described",
        r"[Cc]ontact (is|may be) (not )?lost",
        "as the sentence says",
        "Free motion where there is none in the modes, or a surface that lags behind.",
        "log the force: where contact is kept it must not reach zero; film the release elsewhere",
        Standing.OPEN,
    ),
    (
        "the memory of tissue is continuous",
        r"keeps (its|their) .* (at a switch|when)|^The damper of|has no rest position|"
        r"is free of force",
        "as the law of the environment says",
        "Switches kick the state of the tissue.",
        "fit records of holding and release: nrs-design identify tissue",
        Standing.OPEN,
    ),
    (
        "what a switch does to the state",
        r"deflection is continuous at a switch|the force stays and the deflection jumps|"
        r"(S|s)tates? (is|are) (continuous|mapped)|continuous at a switch|state is mapped|"
        r"reference that the motion loop follows|lead is set to zero|X_i is taken|"
        r"While a gain changes|coefficients of retuned gains|set to zero",
        "no jump beyond those that are named",
        "A jump at a switch adds up over fast switching.",
        "log position, velocity and vm across a switch: no jump but those named",
        Standing.ARGUED,
    ),
    (
        "what idle states do",
        r"act on nothing|integrate their velocity|a sample leaves",
        "decay of the spec while another controller is active",
        "A stale state is a jump at the next switch.",
        "log velocity and reference of the admittance while another controller is active",
        Standing.ARGUED,
    ),
    (
        "where position is counted from",
        r"commanded position is that at which|set the reference before the error|"
        r"state is the motion of the loop",
        "rest of the contact",
        "The axis comes to rest elsewhere, with another force.",
        "count the samples between a step of the force and one of the command",
        Standing.ARGUED,
    ),
    (
        "how controllers may be switched",
        r"[Aa]ny switching signal|may follow any other",
        "none: every signal is covered",
        "Nothing: there is no rule to break.",
        "not needed",
        Standing.ARGUED,
    ),
    (
        "the rules of switching are kept",
        r"changes only|never changes|stays active for|"
        r"is left after|a switch happens at a sample|may change among its|"
        r"environment that is touched does not change again",
        "the rules of the spec",
        "A faster or other switch is outside of what is proved.",
        _STAYS,
        Standing.OPEN,
    ),
    (
        "the mode logic keeps its times",
        r"timer of the mode logic|which signals the logic sees|That rests on an axis",
        "thresholds, noise and speeds of the spec",
        "Switches come earlier, or a wrong controller stays longer.",
        _STAYS,
        Standing.ARGUED,
    ),
    (
        "no sampling, friction or saturation",
        r"are not modelled",
        "delays far below the delay margin; commands below the limit of the driver",
        "The loop has dynamics that no mode holds; delay can destabilize it.",
        "declare sampling in the spec; log the command: it must stay below the driver's limit",
        Standing.OPEN,
    ),
    (
        "numbers on the robot are those listed",
        r"single-precision numbers( listed here|:)|gains are the single-precision",
        "the last bit",
        "The proof is about other gains.",
        "nrs-design verify CERT SPEC --deployed FILE",
        Standing.ARGUED,
    ),
    (
        "arithmetic rounds as stated",
        r"arithmetic is that of single precision|single-precision numbers of limited|"
        r"Joint angle and reference stay",
        "operations that are counted, and the largest angle",
        "Rounding may add up to more than is allowed for.",
        "count the operations in the source; maximum of a log of the angle",
        Standing.ARGUED,
    ),
    (
        "unit of the motor's command",
        r"motor takes commands in",
        "the unit of the spec",
        "All gains are wrong by the factor between the units.",
        _READ,
        Standing.ARGUED,
    ),
    (
        "a gain or parameter stays in its range",
        r"stays in \[|is unknown in|^Parameter|ranges of the spec are scaled|"
        r"stays in .* and may change",
        "the range of the spec",
        "Values outside are not covered.",
        "log the gains, or measure the parameter",
        Standing.OPEN,
    ),
    (
        "the matrices describe the system",
        r"modes are the matrices",
        "the matrices of the spec, exactly",
        _NOTHING,
        "identify the system, and compare with the matrices",
        Standing.OPEN,
    ),
)
_UNKNOWN = ("taken for granted", "as the sentence says", _NOTHING, "not known", Standing.OPEN)
_WRITTEN = tuple(
    (re.compile(words), (name, bound, breaks, test, standing))
    for name, words, bound, breaks, test, standing in _KINDS
)


def register_of(
    statements: Iterable[str], spec: InteractionDesignSpec | None = None
) -> tuple[Assumption, ...]:
    """Return the assumptions of a certificate with what is known of each, in its order.

    Motor and environments count as tested where the spec names measured records that they were
    identified from, and no doubt.

    Parameters
    ----------
    statements : iterable of str
        Of the certificate.
    spec : InteractionDesignSpec, optional
        That it is about.
    """
    tested = frozenset() if spec is None else frozenset(_tested(spec))
    return tuple(_assumption(statement, tested) for statement in statements)


def is_known(statement: str) -> bool:
    """Tell whether the register knows a sentence."""
    return any(words.search(statement) for words, _ in _WRITTEN)


def _assumption(statement: str, tested: frozenset[str]) -> Assumption:
    fields = next((f for words, f in _WRITTEN if words.search(statement)), _UNKNOWN)
    name, bound, breaks, test, standing = fields
    standing = Standing.TESTED if name in tested else standing
    return Assumption(name, statement, bound, breaks, test, standing)


def _tested(spec: InteractionDesignSpec) -> Iterator[str]:
    measured = {
        at[-1]
        for at, item in spec.identified.items()
        if item.provenance
        and all(source.data == "measured" for source in item.provenance)
        and not item.doubts
    }
    if "actuator" in measured:
        yield MOTOR
    if spec.touched and measured.issuperset(spec.touched):
        yield TISSUE

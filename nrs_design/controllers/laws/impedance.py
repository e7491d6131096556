"""Impedance control: the force on the robot corrects its velocity."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

from nrs_design.controllers.float32 import round_float32
from nrs_design.controllers.laws.law import AbstractCompliantLaw, DiscreteLaw, Response
from nrs_design.controllers.operations import Operation, Value
from nrs_design.controllers.parts import DEFAULT_LIMIT, FORCE, HAND, StepGain, StepPart
from nrs_design.controllers.taylor import exponential_between
from nrs_design.models.linear_form import ONE, LinearForm, combine
from nrs_design.spec.controllers import Command, ImpedanceControllerSpec


@dataclass(frozen=True, slots=True)
class Admittance(AbstractCompliantLaw[ImpedanceControllerSpec]):
    """Velocity correction ``vm = F / (Mt s + Bt)`` (thesis 6.8), subtracted from the command.

    With a spring it is ``vm = F / (Mt s + Bt + Kt/s)`` (thesis 2.2.6.2): the spring acts on the
    integral of vm, which is by how much the position reference has been moved.
    """

    name: ClassVar[str] = "impedance"
    sentences: ClassVar[Mapping[str, str]] = {
        "contact-kept.impedance": (
            "Contact is not lost while an impedance controller is active: "
            "free motion under one is not one of the modes."
        ),
    }
    units: ClassVar[Mapping[str, str]] = {"Mt": "kg*m^2", "Bt": "N*m*s/rad", "Kt": "N*m/rad"}
    commands: ClassVar[Command] = ImpedanceControllerSpec.commands
    contact_kept: ClassVar[str | None] = "impedance"

    Mt: Fraction  # Virtual inertia in kg m^2; zero makes the law static
    Bt: Fraction  # Virtual damping in N m s/rad; positive
    # Virtual stiffness in N m/rad; zero is no spring, and then no gain of the law.
    Kt: Fraction = Fraction(0)

    @classmethod
    def gain_names(cls, spec: ImpedanceControllerSpec) -> tuple[str, ...]:
        """Return the names of the gains; Kt needs a value in the spec."""
        return ("Mt", "Bt") if spec.Kt is None else ("Mt", "Bt", "Kt")

    @property
    def spring(self) -> Fraction:
        """The virtual stiffness."""
        return self.Kt

    @property
    def states(self) -> tuple[str, ...]:
        """The velocity; none without inertia."""
        return ("vm [rad/s]",) if self.Mt else ()

    def respond(self, force: LinearForm, states: Sequence[LinearForm]) -> Response:
        """Return ``-vm``, with ``Mt vm' = F - Bt vm``; without inertia ``vm = F / Bt``.

        The force F has that of the spring in it, -Kt q.
        """
        if self.Mt == 0:
            return combine((-1 / self.Bt, force)), []
        (vm,) = states
        rate = combine((1 / self.Mt, force), (-self.Bt / self.Mt, vm))
        return combine((Fraction(-1), vm)), [rate]

    def discretize(self, period: Fraction, method: str) -> DiscreteLaw:
        """Discretize ``Mt v' + Bt v = F`` (thesis 6.8) to ``v+ = a v + b F``.

        Exactly for a force that is held: ``a = exp(-Bt T/Mt)`` and ``b = (1 - a)/Bt``; or by
        Euler's method: ``a = 1 - Bt T/Mt`` and ``b = T/Mt``. Without inertia ``v = F/Bt``. The
        spring's force counts as part of the force.
        """
        if self.Mt == 0:
            return self.discrete(None, round_float32(1 / self.Bt), round_float32(period), self.Kt)
        step = self.Bt * period / self.Mt
        a = 1 - step if method == "euler" else exponential_between(-step)[0]
        b = period / self.Mt if method == "euler" else (1 - a) / self.Bt
        return self.discrete(round_float32(a), round_float32(b), round_float32(period), self.Kt)

    @classmethod
    def discrete(
        cls, a: Fraction | None, b: Fraction, T: Fraction, Kt: Fraction = Fraction(0)
    ) -> DiscreteLaw:
        """Return ``v+ = a v + b F``, with which the reference moves on by ``-T v``.

        b in rad/(s N m); T in s, as the processor holds it; Kt in N m/rad. Without inertia a is
        None, and ``v = b F``.
        """
        numbers = ({} if a is None else {"a": a}) | {"b": b, "T": T}
        return DiscreteLaw(cls, numbers | ({"Kt": Kt} if Kt else {}))

    @classmethod
    def parts(cls, number_names: Collection[str], *, has_position: bool) -> tuple[StepPart, ...]:
        """Return ``xref = xref + T (v - vm)``; the reference of after the error is formed.

        Beside controllers that are given a position, the reference is counted from that position;
        while one of those is active, it and the velocity of the admittances decay.
        """
        sprung, inert = "Kt" in number_names, "a" in number_names
        place, successor = _REFERENCE, "next_reference"
        if has_position:
            place, successor = _OFFSET, "next_offset"
        commanded = sprung and not has_position
        following = {place.name: successor} | ({"velocity": "next_velocity"} if inert else {})
        part = StepPart(
            "admittance",
            tuple(_gains(sprung=sprung, inert=inert, has_position=has_position)),
            (HAND,),
            place,
            (*([_VELOCITY] if inert else []), *([_COMMANDED] if commanded else [])),
            (Operation("taken", "multiply", "takes_offset", "offset"),) if has_position else (),
            "taken" if has_position else "",
            "off" if has_position else "",
            tuple(_moving(sprung=sprung, inert=inert, has_position=has_position)),
            following | ({"commanded": "next_commanded"} if commanded else {}),
        )
        return (part,)


LAW = Admittance


_VELOCITY = Value(
    "velocity", "vm", "rad/s", DEFAULT_LIMIT, "velocity of the admittance", stored="vm [rad/s]"
)
_REFERENCE = Value(
    "reference",
    "xref",
    "rad",
    DEFAULT_LIMIT,
    "reference of the motion controller",
    starts_at_angle=True,
    stored="e [rad]",
)
_OFFSET = Value(
    "offset",
    "r",
    "rad",
    DEFAULT_LIMIT,
    "reference over the commanded position",
    stored="reference [rad]",
)
_COMMANDED = Value(
    "commanded",
    "xcom",
    "rad",
    DEFAULT_LIMIT,
    "reference that the command alone gives",
    "none",
    True,
)


def _gains(*, sprung: bool, inert: bool, has_position: bool) -> Iterator[StepGain]:
    if has_position:
        yield StepGain("takes_offset", "", "1", ONE)
        yield StepGain("d", "d", "1", ONE, "d")
    if sprung:
        yield StepGain("Kt", "Kt", "N*m/rad")
    if inert:
        # Both states of an idle admittance keep the same share.
        yield StepGain("a", "a", "1", idle="d")
    yield StepGain("b", "b", "rad/(s*N*m)")
    yield StepGain("T", "T", "s", common=True)


def _moving(*, sprung: bool, inert: bool, has_position: bool) -> Iterator[Operation]:
    if sprung:
        # At a sample the spring takes the offset of before the reference moves on.
        if not has_position:
            yield Operation("offset", "subtract", "reference", "commanded", "term", "r")
        yield Operation("pull", "multiply", "Kt", "offset")
        yield Operation("felt", "add", FORCE, "pull")
    force_name = "felt" if sprung else FORCE
    if inert:
        yield Operation("kept", "multiply", "a", "velocity")
        yield Operation("pushed", "multiply", "b", force_name)
        yield Operation("next_velocity", "add", "kept", "pushed")
    else:
        yield Operation("velocity", "multiply", "b", force_name, "own", "vm")
    # With inertia, the step uses the velocity state of the previous sample.
    yield Operation("wanted", "saturate", "velocity_limit", "velocity_command")
    yield Operation("relative", "subtract", "wanted", "velocity")
    yield Operation("moved", "multiply", "T", "relative")
    if has_position:
        yield Operation("left", "multiply", "d", "offset")
        yield Operation("next_offset", "add", "left", "moved", "angle")
        return
    yield Operation("next_reference", "add", "reference", "moved", "angle")
    if sprung:
        yield Operation("advanced", "multiply", "T", "wanted")
        yield Operation("next_commanded", "add", "commanded", "advanced", "angle")

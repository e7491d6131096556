"""PI force control with an integral that decays while another controller is active.

The thesis takes a PI for impossible under switching "due to the integral term" (6.3.3). It is
possible where two things are said of the integral w. In contact under force control it integrates
without a leak, so no force error is left. While another controller is active it decays, ``w' = -g
w``, and stays in the command meanwhile: so the command does not jump by w at a switch, in either
direction.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

from nrs_design.controllers.float32 import round_float32
from nrs_design.controllers.laws.law import AbstractCompliantLaw, DiscreteLaw, Response
from nrs_design.controllers.operations import Operation, Value
from nrs_design.controllers.parts import DEFAULT_LIMIT, PROPORTIONAL, StepGain, StepPart
from nrs_design.models.linear_form import LinearForm, combine
from nrs_design.spec.controllers import Command, IntegralControllerSpec

# Integral w of the force error. PI force control updates w = w + Ki_T (Fd - F), the remaining modes
# w = g w. The reference contains w in all modes.
INTEGRAL = StepPart(
    "integral",
    (
        StepGain("Ki_T", "Ki_T", "rad/(N*m)"),
        StepGain("bled", "g", "1", fixed=Fraction(1), idle="g"),
    ),
    states=(
        Value(
            "integral",
            "w",
            "rad",
            DEFAULT_LIMIT,
            "integral of the force error",
            stored="integral [rad]",
        ),
    ),
    adds="integral",
    total="aimed",
    state_operations=(
        Operation("bleeding", "multiply", "bled", "integral"),
        Operation("gathered", "multiply", "Ki_T", "lack"),
        Operation("next_integral", "add", "bleeding", "gathered"),
    ),
    following={"integral": "next_integral"},
)


@dataclass(frozen=True, slots=True)
class IntegralForce(AbstractCompliantLaw[IntegralControllerSpec]):
    """Position correction ``Kp (Fd - F) + w`` with ``w' = Ki (Fd - F)``."""

    name: ClassVar[str] = "pi-force"
    units: ClassVar[Mapping[str, str]] = {"Kp": "rad/(N*m)", "Ki": "rad/(N*m*s)"}
    commands: ClassVar[Command] = IntegralControllerSpec.commands
    fixed: ClassVar[Mapping[str, str]] = {"Kp": "proportional_gain", "Ki": "integral_gain"}
    holds_hand: ClassVar[bool] = True
    sampled: ClassVar[str | None] = "idle.sampled-pi-force"
    sentences: ClassVar[Mapping[str, str]] = {
        "contact-kept.pi-force": (
            "Contact is not lost under PI force control: without a force "
            "the integral is driven by the wanted force alone, and the axis "
            "moves on until it meets something."
        ),
        "idle.sampled-pi-force": (
            "A pi-force controller adds the integral w of its force error "
            "besides, and a sample adds Ki_T times the difference of the "
            "wanted force and its sample to w."
        ),
    }
    is_leaky: ClassVar[bool] = IntegralControllerSpec.is_leaky
    contact_kept: ClassVar[str | None] = "pi-force"

    Kp: Fraction  # In rad/(N m)
    Ki: Fraction  # In rad/(N m s)

    @property
    def states(self) -> tuple[str, ...]:
        """The integral of the force error."""
        return ("integral [rad]",)

    def respond(self, force: LinearForm, states: Sequence[LinearForm]) -> Response:
        """Return ``w - Kp F``, with ``w' = -Ki F``."""
        (w,) = states
        return combine((Fraction(1), w), (-self.Kp, force)), [combine((-self.Ki, force))]

    def discretize(self, period: Fraction, method: str) -> DiscreteLaw:
        """Integrate by Euler's method, ``w+ = w + Ki T (Fd - F)``, with Ki T rounded once."""
        numbers = {"Kf": self.Kp, "Ki_T": round_float32(self.Ki * period)}
        return DiscreteLaw(type(self), {name: number for name, number in numbers.items() if number})

    @classmethod
    def parts(cls, number_names: Collection[str], *, has_position: bool) -> tuple[StepPart, ...]:
        """Return the correction by the force error, and that by its integral."""
        return PROPORTIONAL, INTEGRAL

    def find_fault(self, spec: IntegralControllerSpec) -> str | None:
        """Return the fault of gains that are not positive, or unlike the spec."""
        if self.Kp <= 0 or self.Ki <= 0:
            return "gains Kp and Ki are not positive"
        return AbstractCompliantLaw.find_fault(self, spec)


LAW = IntegralForce

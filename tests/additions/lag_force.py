"""Force control through a lag: the file of a law that the package has not.

It is added to a copy of the package, as ``controllers/laws/lag_force.py``.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from types import MappingProxyType
from typing import Any, ClassVar

from nrs_design.controllers.float32 import round_float32
from nrs_design.controllers.laws.law import AbstractCompliantLaw, DiscreteLaw, Response
from nrs_design.controllers.operations import Operation, Value
from nrs_design.controllers.parts import DEFAULT_LIMIT, PROPORTIONAL, StepGain, StepPart
from nrs_design.controllers.taylor import exponential_between
from nrs_design.models.linear_form import LinearForm, combine
from nrs_design.spec.controllers import Command

LAG = StepPart(
    "lag",
    (StepGain("kept_share", "p", "1"), StepGain("taken_share", "q", "rad/(N*m)")),
    states=(
        Value("lagged", "x", "rad", DEFAULT_LIMIT, "lagged correction", stored="lagged [rad]"),
    ),
    adds="lagged",
    total="placed",
    state_operations=(
        Operation("lag_kept", "multiply", "kept_share", "lagged"),
        Operation("lag_taken", "multiply", "taken_share", "lack"),
        Operation("next_lagged", "add", "lag_kept", "lag_taken"),
    ),
    following={"lagged": "next_lagged"},
)


@dataclass(frozen=True, slots=True)
class LagForce(AbstractCompliantLaw[Any]):
    """Position correction ``x`` with ``tau x' = Kp (Fd - F) - x``."""

    name: ClassVar[str] = "lag-force"
    units: ClassVar[Mapping[str, str]] = MappingProxyType({"Kp": "rad/(N*m)", "tau": "s"})
    commands: ClassVar[Command] = "position"
    fixed: ClassVar[Mapping[str, str]] = MappingProxyType({"Kp": "gain", "tau": "lag"})
    sampled: ClassVar[str | None] = "idle.sampled-lag-force"
    contact_kept: ClassVar[str | None] = "lag-force"
    sentences: ClassVar[Mapping[str, str]] = MappingProxyType(
        {
            "contact-kept.lag-force": "Contact is not lost while force is controlled by the lag.",
            "idle.sampled-lag-force": "A lag-force controller adds x, and a sample makes it p x + "
            "q times the difference of the wanted force and its sample.",
        }
    )

    Kp: Fraction
    tau: Fraction

    @property
    def states(self) -> tuple[str, ...]:
        """The lagged correction."""
        return ("lagged [rad]",)

    def respond(self, force: LinearForm, states: Sequence[LinearForm]) -> Response:
        """Return ``x``, with ``x' = -(Kp F + x)/tau``."""
        (x,) = states
        return x, [combine((-self.Kp / self.tau, force), (-1 / self.tau, x))]

    def discretize(self, period: Fraction, method: str) -> DiscreteLaw:
        """Discretize exactly for a force that is held."""
        p, _ = exponential_between(-period / self.tau)
        shares = {"kept_share": p, "taken_share": self.Kp * (1 - p)}
        return DiscreteLaw(type(self), {name: round_float32(n) for name, n in shares.items()})

    @classmethod
    def parts(cls, number_names: Collection[str], *, has_position: bool) -> tuple[StepPart, ...]:
        """Return the force error of all force controllers, and the lag."""
        return PROPORTIONAL, LAG


LAW = LagForce

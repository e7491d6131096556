"""The result of an engine: the response, and how the run ended."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

from nrs_design.simulation.time_response import Signal, TimeResponse

if TYPE_CHECKING:
    from nrs_design.spec import InteractionDesignSpec

# First outputs, and inputs, of both engines.
OUTPUTS = (
    Signal("angle", "rad"),
    Signal("velocity", "rad/s"),
    Signal("torque", "N*m"),
    Signal("depth", "rad"),
)
INPUTS = (Signal("hand", "rad/s"),)

# A controller that is left sooner has chattered, in s.
CHATTER = 0.01
# Steps of an engine after which a run is stopped, and steps between two reports of progress.
MAX_STEPS, PROGRESS_STEPS = 5_000_000, 20_000

# Effects that no run models.
LEFT_OUT = (
    "other axes, gravity, and play and elasticity of the gearhead",
    "values of the motor gain and time constant that differ from the nominal values",
)


@dataclass(frozen=True, slots=True)
class Run:
    """A simulated scenario."""

    scenario: str  # Its name
    engine: str  # Name of the engine
    response: TimeResponse  # Up to where the run came
    # Times in s at which a controller took over, and which.
    switches: tuple[tuple[float, str], ...]
    # Times in s at which a surface was met (true) or lost, and its environment.
    contacts: tuple[tuple[float, str, bool], ...]
    steps: int  # Steps of the engine
    # Period in s, and smallest and largest delay in samples, of the law.
    sampling: tuple[float, int, int] | None = None
    refused: int = 0  # Samples that the law refused, because an input was beyond its limits
    saturated: int = 0  # Samples at which the command of the motor met its limit
    stopped: str | None = None  # Why the run ended before its time
    left_out: tuple[str, ...] = LEFT_OUT  # Effects without a model
    outer: float | None = None  # Period of filter and admittance in s, which may be another
    missed: int | None = None  # Samples with a missed deadline; None without a rule of misses

    @property
    def chatter(self) -> int:
        """Number of stays shorter than `CHATTER`."""
        return sum(stay < CHATTER for stay in self._stays)

    @property
    def shortest_stay(self) -> float | None:
        """Least time between two switches in s; None if there are no two."""
        return min(self._stays, default=None)

    @property
    def _stays(self) -> list[float]:
        return [b - a for (a, _), (b, _) in pairwise(self.switches)]


def common_lever_arm(spec: InteractionDesignSpec, environments: Iterable[str]) -> float | None:
    """Return the lever arm in m that environments have in common; None if there is no such.

    What is no environment by itself has no arm.
    """
    known = spec.environments
    arms = {known[name].lever_arm if name in known else None for name in environments}
    arm = arms.pop() if len(arms) == 1 else None
    return None if arm is None else arm.si

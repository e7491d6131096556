"""A periodic switching signal along which a solution grows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar, Self

from nrs_design.proof.bounds import nearly
from nrs_design.proof.clock import keeps_turns
from nrs_design.proof.enclosure import balls, exponential, precision
from nrs_design.proof.evidence.abstract import AbstractEvidence, Shows
from nrs_design.proof.evidence.fields import read_integer, read_ratio, read_text
from nrs_design.proof.exact import IntegerMatrix
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Switching
from nrs_design.proof.system import SwitchedSystem

MAX_STEPS = 1024
MAX_WORK = 5_000_000
MAX_DWELL = 4096
MAX_DOUBLINGS = 60


@dataclass(frozen=True, slots=True)
class UnstablePeriod(AbstractEvidence):
    """The monodromy matrix M of a periodic signal has a spectral radius above one.

    All eigenvalues at most one in modulus would give ``|tr M^k| <= n`` for every k. M is enclosed
    in balls (`nrs_design.proof.enclosure`), and ``|tr M^k| > n`` holds for the whole enclosure with
    the stated power of two k.
    """

    kind: ClassVar[str] = "unstable-period"
    covers_clock: ClassVar[bool] = True

    # Mode and dwell time in s (discrete time: number of steps), in order.
    steps: tuple[tuple[str, Fraction], ...]
    doublings: int  # k is two to this power
    # For each step, which of the resets to the next mode is taken, counted from zero in the order
    # of the spec. Empty where there is no choice.
    edges: tuple[int, ...] = ()

    @property
    def shows(self) -> Shows:
        """Instability."""
        return Shows.INSTABILITY

    @property
    def used(self) -> frozenset[str]:
        """The modes of the signal."""
        return frozenset(name for name, _ in self.steps)

    def fits(self, switching: Switching) -> bool:
        """Tell whether every dwell time is long and short enough, and every switch allowed."""
        if len(self.steps) > MAX_STEPS:
            return False
        names = [name for name, _ in self.steps]
        following = _switches(names)
        switches = {(a, b) for a, b in following if a != b}
        allowed = switching.transitions
        ends = {name: end for pair in switching.fixed_ends for end, name in enumerate(pair)}
        staying = {a for a, b in following if a == b}
        return (
            (allowed is None or switches <= set(allowed))
            and all(_may_stay(switching, *step, step[0] in staying) for step in self.steps)
            and self._takes_edges(switching)
            # A constant parameter is at one of its ends all the time.
            and len({ends.get(name) for name in names}) == 1
        )

    def _takes_edges(self, switching: Switching) -> bool:
        """Tell whether the chosen resets exist; without a choice there is at most one each."""
        maps, switches = switching.maps(), _switches([name for name, _ in self.steps])
        counts = [len(maps.get(switch, ())) for switch in switches]
        if not self.edges:
            return all(count <= 1 for count in counts)
        return len(self.edges) == len(counts) and all(
            0 <= edge < max(count, 1) for edge, count in zip(self.edges, counts, strict=True)
        )

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check the signal, and that its monodromy matrix expands."""
        if not 1 <= len(self.steps) <= MAX_STEPS or not 0 <= self.doublings <= MAX_DOUBLINGS:
            return "the signal is empty or too long"
        if len(self.steps) * system.order**3 > MAX_WORK:
            return "the signal is too long for so many states"
        if not {name for name, _ in self.steps} <= {mode.name for mode in system.modes}:
            return "the signal uses modes that do not exist"
        if any(not 0 < dwell <= MAX_DWELL for _, dwell in self.steps):
            return f"a dwell time is not between 0 and {MAX_DWELL}"
        if system.time is Time.DISCRETE and any(dwell.denominator != 1 for _, dwell in self.steps):
            return "a number of steps is not whole"
        if system.clock is not None and not keeps_turns(system.clock, self.steps):
            return "a mode is in force when it is not its turn"
        if not expands(system, self.steps, self.doublings, self.edges):
            return "the enclosure of the monodromy matrix does not show growth"
        return None

    def forms(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield nothing: no matrix has to be positive definite."""
        yield from ()

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State the signal and what follows."""
        continuous = system.time is Time.CONTINUOUS
        law, unit = ("x' = A x", "s") if continuous else ("x+ = A x", "steps")
        maps, switches = system.switching.maps(), _switches([name for name, _ in self.steps])
        choices = [len(maps.get(switch, ())) > 1 for switch in switches]
        ways = self.edges or (0,) * len(switches)
        then = [
            f", then reset {way + 1} to {switch[1]}" if choice else ""
            for way, choice, switch in zip(ways, choices, switches, strict=True)
        ]
        times = [nearly(dwell, unit) for _, dwell in self.steps]
        signal = ", ".join(
            f"{name} for {time}{reset}"
            for (name, _), time, reset in zip(self.steps, times, then, strict=True)
        )
        if any(time.startswith("about") for time in times):
            signal += "; the certificate holds the exact times"
        return (
            f"Repeating the signal ({signal}) makes some solution grow without bound: the spectral "
            f"radius over one period is above 1, so {law} is unstable under this switching."
        )

    def to_fields(self) -> dict[str, Any]:
        """Return the signal and the power."""
        edges = {"edges": list(self.edges)} if self.edges else {}
        return {
            "steps": [[name, str(dwell)] for name, dwell in self.steps],
            **edges,
            "doublings": self.doublings,
        }

    @classmethod
    def from_fields(cls, fields: Mapping[str, Any], system: SwitchedSystem) -> Self:
        """Read the signal and the power."""
        steps = tuple((read_text(name), read_ratio(dwell)) for name, dwell in fields["steps"])
        edges = tuple(read_integer(edge) for edge in fields.get("edges", ()))
        if edges and len(edges) != len(steps):
            raise ValueError("there is not one edge for each step")
        return cls(steps, read_integer(fields["doublings"]), edges)


def _switches(names: Sequence[str]) -> list[tuple[str, str]]:
    """Return what follows what, round the period; a mode alone follows itself."""
    return list(zip(names, (*names[1:], *names[:1]), strict=True))


def _may_stay(switching: Switching, mode: str, dwell: Fraction, goes_on: bool) -> bool:
    """Tell whether a mode may be active for so long: one that must be left, not twice in turn."""
    stay = switching.stay(mode)
    if stay.longest is None:
        return dwell >= stay.shortest
    return stay.shortest <= dwell <= stay.longest and not goes_on


def expands(
    system: SwitchedSystem,
    steps: tuple[tuple[str, Fraction], ...],
    doublings: int,
    edges: tuple[int, ...] = (),
) -> bool:
    """TRUSTED: decide whether ``|tr M^k| > n`` is certain, k two to the power of doublings.

    Parameters
    ----------
    system : SwitchedSystem
        The modes.
    steps : tuple
        Mode and time of every step of the period, in s or steps.
    doublings : int
        How often M is squared.
    edges : tuple of int
        Which of several resets each switch takes.
    """
    with precision():
        power = monodromy(system, steps, edges)
        for _ in range(doublings):
            power = power * power
        trace = sum((power[i, i] for i in range(system.order)), start=0 * power[0, 0])
        return bool(abs(trace) > system.order)


def monodromy(
    system: SwitchedSystem,
    steps: tuple[tuple[str, Fraction], ...],
    edges: tuple[int, ...] = (),
) -> Any:
    """TRUSTED: enclose the monodromy matrix of a periodic signal, at flint's current precision.

    Every step is followed by the reset of the switch to the next mode, the last one by that of the
    switch back to the first.

    Parameters
    ----------
    system, steps, edges
        As for `expands`.
    """
    modes, maps = {mode.name: mode for mode in system.modes}, system.switching.maps()
    n = system.order
    product = balls(RationalMatrix.from_rows([[int(i == j) for j in range(n)] for i in range(n)]))
    switches = _switches([name for name, _ in steps])
    for (name, dwell), switch, edge in zip(
        steps, switches, edges or (0,) * len(steps), strict=True
    ):
        A = modes[name].A
        continuous = system.time is Time.CONTINUOUS
        factor = exponential(A, dwell, dwell) if continuous else balls(A) ** int(dwell)
        product = factor * product
        if switch in maps:
            product = balls(maps[switch][edge]) * product
    return product

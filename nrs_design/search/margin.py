"""Largest number on an axis with a proof, and smallest number with a refutation.

A number on an axis makes a system: a scale of ranges, a delay, a period, a number of misses, a
dwell time with the opposite sign. The larger it is, the more has to hold. Numbers are decided by
doubling and bisection; what counts as proved or refuted has evidence that passed the exact check.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import inf
from typing import TYPE_CHECKING

from nrs_design.certificates.certificate import Verdict, refutes_in_contact
from nrs_design.errors import NrsDesignError
from nrs_design.progress import Progress, silent
from nrs_design.proof.bounds import nearly
from nrs_design.proof.system import SwitchedSystem
from nrs_design.spec.switching import LONGEST_DWELL

if TYPE_CHECKING:
    from nrs_design.proof.evidence.abstract import Bound
    from nrs_design.search.certification import Certification

# Bisections of an end; refuted ends are slow, as no verdict is found next to them.
STEPS, PERIOD_STEPS, DWELL_STEPS, REFUTED_STEPS = 8, 4, 12, 6
# Largest scale of ranges, number of larger scales without a proof, and number of doublings and of
# halvings of a period.
LARGEST_SCALE, IDLE, DOUBLINGS = 64, 3, 4
# An exact test of a mode with more samples on their way takes too long.
FARTHEST_DELAY = 32
# Largest number of halvings of a dwell time.
HALVINGS = 64

Assemble = Callable[[Fraction], SwitchedSystem]
Certify = Callable[[SwitchedSystem], "Certification"]


@dataclass(frozen=True)
class Bracket:
    """The farthest number with a proof, and the nearest that is refuted, where there are any."""

    # proved, refuted: scales, delays in samples, times in s, numbers of misses.
    proved: Fraction | None
    refuted: Fraction | None
    end: str = ""  # End of a search without refutation, and the reason
    # Contact of the refutation, if the loss of contact is undecided; empty for any contact.
    refuted_in: str = ""
    proof: Certification | None = None  # At the number that is proved


@dataclass(frozen=True)
class CommandMargin:
    """Disturbances with a proof of the force limit, and disturbances that exceed the limit."""

    limit: Fraction  # Force limit in N m
    # For each disturbance: proved size, size with a simulated violation, and unit. The disturbances
    # are scaled together, in the proportion of the spec.
    bounds: Mapping[str, tuple[Fraction, Fraction, str]]


@dataclass(frozen=True)
class MarginBrackets:
    """Brackets of `--margin` beside the box of ranges."""

    # Longest delay of the force sample, for ranges that start at the shortest declared delay; None
    # without sampling.
    delay: Bracket | None
    period: Bracket | None  # Periods, each for itself; None without sampling
    # None where no bound on the force is proved under the disturbances of the spec.
    command: CommandMargin | None


@dataclass(frozen=True)
class MarginAxis:
    """Numbers on an axis that were tried, each once, with the results."""

    assemble: Assemble
    certify: Certify
    progress: Progress = silent
    what: str = ""  # Name and unit of a number, for the progress
    unit: str = ""
    whole: bool = False  # Whether numbers are integers
    # Result at each number, or why it makes no system.
    found: dict[Fraction, Certification | str] = field(default_factory=dict)

    def at(self, number: Fraction) -> Certification | str:
        """Return the result at a number, which is decided here unless it is known."""
        if number not in self.found:
            self.progress(f"{self.what} {self._text(number)}{self._known()}")
            system = self._assembled(number)
            self.found[number] = system if isinstance(system, str) else self.certify(system)
        return self.found[number]

    def is_proved(self, number: Fraction) -> bool:
        """Tell whether there is a proof at a number."""
        found = self.at(number)
        return not isinstance(found, str) and found.verdict is Verdict.PROVED

    def is_refuted(self, number: Fraction) -> bool:
        """Tell whether there is a refutation at a number, if only in kept contact."""
        found = self.at(number)
        if isinstance(found, str):
            return False
        return found.verdict is Verdict.REFUTED or found.refuted_in is not None

    def bracket(
        self,
        start: Fraction,
        down: Iterable[Fraction],
        up: Iterable[Fraction],
        steps: int = STEPS,
        idle: float = inf,
    ) -> Bracket:
        """Look down for a proof and up for a refutation, and bisect at both ends.

        Without a proof, no more than `idle` numbers are looked at on the way up.
        """
        next(filter(self.is_proved, [start, *down]), None)
        for number in up:
            if idle <= 0 or any(n <= number and self.is_refuted(n) for n in self.found):
                break
            if not self._makes_system(number):
                accepted = max(n for n, one in self.found.items() if not isinstance(one, str))
                self.at(self._sharpened(accepted, number, self._makes_system, steps))
                break
            idle -= not self.is_proved(number)
        proved = self._end(self.is_proved, 1, steps)
        refuted = self._end(self.is_refuted, -1, min(steps, REFUTED_STEPS))
        proof = None if proved is None else self.found[proved]
        contact = None if refuted is None else self.found[refuted]
        assert not isinstance(proof, str)
        assert not isinstance(contact, str)
        return Bracket(
            proved,
            refuted,
            self._why_none() if refuted is None else "",
            "" if contact is None else contact.refuted_in or "",
            proof,
        )

    def _end(self, accepts: Callable[[Fraction], bool], sign: int, steps: int) -> Fraction | None:
        """Return the largest number of a kind, or with the sign -1 the smallest, by bisection."""
        best = max(filter(accepts, self.found), key=lambda number: sign * number, default=None)
        rejected = (n for n in self.found if best is not None and sign * n > sign * best)
        neighbour = min(rejected, key=lambda number: sign * number, default=None)
        if best is None or neighbour is None:
            return best
        return self._sharpened(best, neighbour, accepts, steps)

    def _sharpened(
        self,
        accepted: Fraction,
        rejected: Fraction,
        accepts: Callable[[Fraction], bool],
        steps: int,
    ) -> Fraction:
        for _ in range(steps):
            middle = (accepted + rejected) / 2
            if self.whole:
                middle = Fraction(int(middle))
            if middle in (accepted, rejected):
                break
            accepted, rejected = (middle, rejected) if accepts(middle) else (accepted, middle)
        return accepted

    def _assembled(self, number: Fraction) -> SwitchedSystem | str:
        try:
            return self.assemble(number)
        except NrsDesignError as error:
            return error.message

    def _makes_system(self, number: Fraction) -> bool:
        system = self._assembled(number)
        if isinstance(system, str):
            self.found[number] = system
        return not isinstance(system, str)

    def _why_none(self) -> str:
        """Name the largest number that was tried without a refutation, and why the search ended."""
        longest = max((n for n, one in self.found.items() if not isinstance(one, str)))
        smallest_failure = min((n for n in self.found if n > longest), default=None)
        reason = "the search ends there"
        if smallest_failure is not None:
            reason = f"what is beyond makes no system ({self.found[smallest_failure]})"
        return f"none of up to {self._text(longest)} is refuted: {reason}"

    def _known(self) -> str:
        proved = [n for n in self.found if self.is_proved(n)]
        refuted = [n for n in self.found if self.is_refuted(n)]
        parts = [f"proved: {self._text(max(proved))}"] if proved else []
        parts += [f"refuted: {self._text(min(refuted))}"] if refuted else []
        return f" ({', '.join(parts)})" if parts else ""

    def _text(self, number: Fraction) -> str:
        return nearly(abs(number), self.unit)


def find_margin(
    assemble: Assemble,
    certify: Certify,
    known: Certification | None = None,
    progress: Progress = silent,
) -> Bracket:
    """Find how far declared ranges can be stretched about their nominal values, by which scale.

    A proof for a box is one for every smaller one, and a refutation one for every larger one.
    `known`, found at scale 1, perhaps by a longer search, is the least that is reported. An error
    if not even the nominal values make a system.
    """
    one = Fraction(1)
    if known is None:
        assemble(Fraction(0))  # Raises what is wrong, and where.
    initial_results: dict[Fraction, Certification | str] = {} if known is None else {one: known}
    axis = MarginAxis(assemble, certify, progress, "box scaled by", found=initial_results)
    return axis.bracket(
        one, [Fraction(0)], _double_up_to_largest(one, Fraction(LARGEST_SCALE)), idle=IDLE
    )


def find_longest_delay(
    delays: tuple[int, int, int],
    assemble: Callable[[int, int], SwitchedSystem],
    certify: Certify,
    unstable_in: Callable[[SwitchedSystem], str | None],
    known: Certification,
    progress: Progress = silent,
) -> Bracket:
    """Find the longest delay with a proof, and the shortest that is refuted, in samples.

    Of delays that are the shortest, the longest declared and the longest there is, loops are
    assembled of ranges. The modes of a range are those of every shorter one, and more. Beyond, one
    delay that is unstable by itself refutes all ranges that reach it: `unstable_in`, a quick test,
    tells in which contact, empty for any. `known` is on the declared ones.
    """
    longest_declared, longest = map(Fraction, delays[1:])
    axis = MarginAxis(
        lambda n: assemble(delays[0], int(n)),
        certify,
        progress,
        "delay",
        whole=True,
        found={longest_declared: known},
    )
    down = (Fraction(n) for n in range(delays[1] - 1, delays[0] - 1, -1))
    found = axis.bracket(longest_declared, down, _double_up_to_largest(longest_declared, longest))
    if found.refuted is not None:
        return found

    def where(delay: int) -> str | None:
        progress(f"delay {delay} alone")
        try:
            return unstable_in(assemble(delay, delay))
        except NrsDesignError:
            return None  # What makes no loop shows nothing.

    longer_delays = range(delays[2], FARTHEST_DELAY + 1)
    first = bisect_left(longer_delays, True, key=lambda delay: where(delay) is not None)
    if first < len(longer_delays):
        contact = where(longer_delays[first]) or ""
        return replace(found, refuted=Fraction(longer_delays[first]), refuted_in=contact, end="")
    return replace(found, end=f"{found.end}, nor is one of up to {FARTHEST_DELAY} by itself")


def find_longest_period(
    period: Fraction,
    assemble: Assemble,
    certify: Certify,
    known: Certification,
    progress: Progress = silent,
) -> Bracket:
    """Find a long period with a proof and a short one that is refuted, each for itself, in s.

    Other periods make other systems: nothing follows from one for the ones in between. `known` is
    on the period of the spec.
    """
    axis = MarginAxis(assemble, certify, progress, "period", "s", found={period: known})
    factors = [Fraction(2) ** k for k in range(1, DOUBLINGS + 1)]
    down, up = (period / f for f in factors), (period * f for f in factors)
    return axis.bracket(period, down, up, PERIOD_STEPS)


def find_shortest_dwell(
    system: SwitchedSystem, certify: Certify, known: Certification, progress: Progress = silent
) -> Bracket:
    """Find the largest switching rate that has a proof: the shortest provable dwell time, in s.

    A proof for a dwell time is one for every longer one, and a refutation one for every shorter
    one. One for all modes is sought, from what is known up to the longest that a spec can declare;
    there are no longest ones. Zero if arbitrary switching is stable.
    """

    def assemble(number: Fraction) -> SwitchedSystem:
        switching = replace(system.switching, dwell_time=-number, stays=())
        # From where motions decay under saturation is no matter of a margin.
        return replace(system, switching=switching, saturation=None)

    longest, dwell = Fraction(LONGEST_DWELL), _common_dwell(system, known)
    initial_results: dict[Fraction, Certification | str] = {} if dwell is None else {-dwell: known}
    axis = MarginAxis(assemble, certify, progress, "dwell time", "s", found=initial_results)
    free = axis.at(Fraction(0))
    assert not isinstance(free, str), "it is the system itself"
    if axis.is_refuted(Fraction(0)) and _has_unstable_mode(free):
        return Bracket(None, longest, refuted_in=free.refuted_in or "")
    start = max(filter(axis.is_proved, axis.found), default=None)
    if start is None:
        start = min(-_fastest_time(system), *filter(axis.is_refuted, axis.found), Fraction(0))
    down = (max(start * 2**k, -longest) for k in range(1, HALVINGS))
    up = (start / 2**k for k in range(1, HALVINGS))
    found = axis.bracket(start, down, up, DWELL_STEPS, idle=1)
    proved, refuted = (None if x is None else -x for x in (found.proved, found.refuted))
    return replace(found, proved=proved, refuted=refuted)


def _double_up_to_largest(start: Fraction, largest: Fraction) -> Iterable[Fraction]:
    """Yield the doubles of a start up to a largest number."""
    while start < largest:
        start = min(2 * start or Fraction(1), largest)
        yield start


def _common_dwell(system: SwitchedSystem, known: Certification) -> Fraction | None:
    """Return the one dwell time for all modes at which the verdict on their own ones holds, too.

    Where no mode is left sooner than the slowest of them may be, all of them keep their own times;
    a signal that keeps these keeps the shortest of them everywhere.
    """
    times = [stay.shortest for stay in system.stays().values()]
    if known.verdict is Verdict.PROVED:
        return max(times)
    refuted = known.verdict is Verdict.REFUTED or known.refuted_in is not None
    if refuted or min(times) == max(times):
        return min(times)
    return None


def _has_unstable_mode(found: Certification) -> bool:
    """Tell whether a refutation holds for every dwell time."""
    evidence = found.evidence or refutes_in_contact(found.system, found.statements)
    return evidence is not None and evidence.names_unstable_mode


def _fastest_time(system: SwitchedSystem) -> Fraction:
    """Return a power of two near one over the largest entry of all modes, in s."""
    entries = (abs(e) for mode in system.modes for row in mode.A.fractions() for e in row)
    largest = max(entries, default=Fraction(0)) or Fraction(1)
    size = largest.denominator.bit_length() - largest.numerator.bit_length()
    return Fraction(2) ** size


def command_margin(found: Bound, reached: float) -> CommandMargin | None:
    """Return bounds of the disturbances for the limit of an output, by proportion.

    `reached` is what the output of a simulated run reaches under the disturbances of a checked
    bound.
    """
    limit = found.output.limit
    if limit is None or not reached > 0:
        return None
    kept, broken = limit / found.level, limit / Fraction(reached)
    return CommandMargin(
        limit, {c.name: (kept * c.bound, broken * c.bound, c.unit) for c in found.channels}
    )

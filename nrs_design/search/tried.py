"""What the search for a margin has tried: nothing is decided twice."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import TYPE_CHECKING, Generic, TypeVar

from nrs_design.certificates.certificate import Verdict
from nrs_design.progress import Progress, silent
from nrs_design.proof.bounds import nearly

if TYPE_CHECKING:
    from nrs_design.search.certification import Certification

    Found = Certification | Verdict | str

Number = TypeVar("Number", int, Fraction)


class Tried(Generic[Number]):
    """The verdict at every number that was tried, or why it makes no system.

    What is refuted in kept contact counts as refuted; `refuted_in` says so. `what` and `unit` tell
    a number, such as ``period`` and ``s``; progress is told it before it is decided.
    """

    def __init__(
        self,
        decide: Callable[[Number], Found],
        progress: Progress = silent,
        what: str = "",
        unit: str = "",
    ) -> None:
        self._decide: Callable[[Number], Found] = decide
        self._progress = progress
        self._what, self._unit = what, unit
        self._found: dict[Number, Verdict | str] = {}
        self._refuted_in: dict[Number, str] = {}

    def __call__(self, number: Number) -> Verdict | str:
        """Return what is found at a number; it is decided if it was not yet."""
        if number not in self._found:
            self._progress(f"{self._what} {self._text(number)}{self._known()}")
            self.remember(number, self._decide(number))
        return self._found[number]

    def remember(self, number: Number, found: Found) -> None:
        """Keep what is known of a number without a decision."""
        if isinstance(found, str):
            self._found[number] = found
            return
        self._found[number] = found.verdict
        if found.refuted_in is not None:
            self._found[number] = Verdict.REFUTED
            self._refuted_in[number] = found.refuted_in

    def refuted_in(self, number: Number | None) -> str:
        """Say in which contact alone there is a refutation at a number; empty for any contact."""
        return "" if number is None else self._refuted_in.get(number, "")

    def is_proved(self, number: Number) -> bool:
        """Tell whether there is a proof at a number."""
        return self(number) is Verdict.PROVED

    def is_refuted(self, number: Number) -> bool:
        """Tell whether there is a refutation at a number."""
        return self(number) is Verdict.REFUTED

    def makes_no_system(self, number: Number) -> bool:
        """Tell whether there is nothing to decide at a number."""
        return not isinstance(self(number), Verdict)

    def all(self) -> list[Number]:
        """Return every number that was tried."""
        return list(self._found)

    def that_are(self, verdict: Verdict) -> list[Number]:
        """Return the numbers with a verdict."""
        return [number for number, found in self._found.items() if found is verdict]

    def longest(self) -> Number:
        """Return the largest number that makes a system."""
        return max(number for number in self._found if not self.makes_no_system(number))

    def fault(self) -> str:
        """Say why the next number beyond the longest makes no system; empty if none was tried."""
        beyond = min((number for number in self._found if number > self.longest()), default=None)
        return "" if beyond is None else str(self._found[beyond])

    def end(self, reach: str, beyond: str) -> str:
        """Say where numbers that are not refuted end, and why there."""
        why = f"{beyond} ({fault})" if (fault := self.fault()) else "the search ends there"
        return f"none {reach} {self._text(self.longest())} is refuted: {why}"

    def _known(self) -> str:
        proved, refuted = self.that_are(Verdict.PROVED), self.that_are(Verdict.REFUTED)
        known = [f"proved: {self._text(max(proved))}"] if proved else []
        known += [f"refuted: {self._text(min(refuted))}"] if refuted else []
        return f" ({', '.join(known)})" if known else ""

    def _text(self, number: Number) -> str:
        return nearly(Fraction(number), self._unit)


def sharpen(
    accepted: Fraction, other: Fraction, steps: int, accepts: Callable[[Fraction], bool]
) -> Fraction:
    """Bisect, so many steps, between a number that is accepted and one that is not.

    Returns the last one that was accepted.
    """
    for _ in range(steps):
        middle = (accepted + other) / 2
        if accepts(middle):
            accepted = middle
        else:
            other = middle
    return accepted


def sharpened(tried: Tried[Fraction], verdict: Verdict, steps: int, *, up: bool) -> Fraction | None:
    """Return the largest number with a verdict, or the smallest, after so many bisections."""
    mine = tried.that_are(verdict)
    if not mine:
        return None
    best = max(mine) if up else min(mine)
    beyond = [number for number in tried.all() if (number > best if up else number < best)]
    if not beyond:
        return best
    other = min(beyond) if up else max(beyond)
    return sharpen(best, other, steps, lambda number: tried(number) is verdict)

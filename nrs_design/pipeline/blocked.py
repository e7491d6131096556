"""The lines of a spec that keep it from a proof, where the verdict is inconclusive.

The given gains are changed together first. Then each line alone is changed to its weakest form, and
bisection finds the strongest one with a proof. Each changed spec passes the exact check.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from nrs_design.certificates.catalogue import sentences
from nrs_design.certificates.certificate import Gains, Verdict
from nrs_design.errors import AssemblyError, DesignError, SpecError
from nrs_design.pipeline.certification import Result, assemble_spec, gains_text, search_limits
from nrs_design.pipeline.design import design_at_least_cost
from nrs_design.progress import Progress, silent
from nrs_design.proof.text import counted
from nrs_design.search.certification import Certification, Limits
from nrs_design.spec import LoadedSpec
from nrs_design.spec.document import Position, to_data
from nrs_design.spec.edits import Edit, Keys, identified_above, in_one_line, node_at, with_edits
from nrs_design.spec.load import respecified
from nrs_design.spec.places import dotted
from nrs_design.spec.relaxations import (
    CALMER,
    GIVEN_GAINS,
    WITHOUT,
    RelaxationSteps,
    SpecRelaxation,
    calmer,
    iterate_relaxations,
)

SHARE = 0.4  # Share of the search budget; the last step may exceed it
GAINS = 0.4  # Share of this for gains
# Of the rest, up to where it may be spent on finding lines about numbers and words, on how far they
# go, and on what is left out whole.
FIND, STRETCH = 0.4, 0.8
# A look at single modes, in units.
LOOK = 0.02
MOST_LINES = 24
PRINTED_LINES = 3  # Printed lines, beside the first and the last


@dataclass(frozen=True, slots=True)
class Blocking:
    """One changed line of a spec that has a proof."""

    place: Position
    line: str  # The keys that lead there, with dots
    asked: str  # Value in the spec
    proved: str  # Proved value, in the same words; empty if the line goes
    word: str  # Before it: up to, down to, within, with, without
    write: str  # Replacement; empty if the line goes
    changes_model: bool  # True if robot or assumptions change
    left_out: tuple[str, ...] = ()  # Keys about the values as they were, which go as well


@dataclass(frozen=True, slots=True)
class Proved:
    """A spec that asks for less, and is proved."""

    lines: tuple[Blocking, ...]  # Changed lines: one, or several together
    claim: str  # What is proved
    needs: tuple[str, ...]  # Further assumptions
    sha256: str  # Hash of the changed spec
    new_gains: bool  # True if the design has other gains


@dataclass(frozen=True, slots=True)
class Blocked:
    """What keeps a spec from being proved."""

    proved: tuple[Proved, ...]  # What is proved instead, the least given up first
    tried: int  # How many lines were looked at
    lines: int  # All candidates
    unbounded: bool  # True if disturbances were left out
    work: float  # Spent on it, in units


@dataclass(frozen=True, slots=True)
class _Decided:
    """A changed spec for which there is a proof."""

    loaded: LoadedSpec
    certification: Certification
    gains: Gains


def find_blocked(
    result: Result, limits: Limits | None = None, progress: Progress = silent
) -> Blocked | None:
    """Find the lines that keep a spec from a proof; None with another verdict.

    Less than half of the budget of the limits is spent. The decay rate is not optimized, and no
    bound under disturbances is looked for.
    """
    if result.certification.verdict is not Verdict.INCONCLUSIVE:
        return None
    return _Search(result, limits or search_limits(result.loaded.spec), progress).run()


class _Search:
    """A search through changes of a spec, within a budget of work."""

    def __init__(self, result: Result, limits: Limits, progress: Progress) -> None:
        self._result, self._progress = result, progress
        self._budget = SHARE * limits.budget
        self._limits = replace(limits, optimize_rate=False, more=False)
        self._spent = 0.0
        self._found: dict[str, _Decided | None] = {}
        self._gains = gains_text(result.designed)

    def run(self) -> Blocked:
        found = tuple(
            iterate_relaxations(self._result.loaded, self._result.certification.rate_limit)
        )
        lines = found[:MOST_LINES]
        mild = [line for line in lines if line.weakest.word != WITHOUT]
        drastic = [line for line in lines if line.weakest.word == WITHOUT]
        gains = self._calmer(GAINS * self._budget)
        start, budget = self._spent, self._budget - self._spent
        proved = gains + self._single(mild, start + FIND * budget, start + STRETCH * budget)
        proved += self._single(drastic, self._budget, self._budget)
        unbounded = bool(self._result.certification.system.channels)
        return Blocked(proved, len(lines), len(found), unbounded, self._spent)

    def _calmer(self, until: float) -> tuple[Proved, ...]:
        """Return the smallest proved change of all gains together.

        The calmest are tried first, and may take half of the work: if they do not help, none do.
        """
        ways = [calmer(self._result.loaded, *factors) for factors in CALMER]
        if not ways[-1] or not self._decide(_weakest_edits(ways[-1]), until / 2):
            return ()
        for left, lines in zip(range(len(ways), 0, -1), ways, strict=True):
            if lines and self._decide(_weakest_edits(lines), (until - self._spent) / left):
                break
        return (self._proved([(line, line.weakest, 0) for line in lines]),)

    def _single(
        self, lines: Sequence[SpecRelaxation], find: float, stretch: float
    ) -> tuple[Proved, ...]:
        """Return the proved changes of one line, the smallest first.

        Lines are found up to the work `find`, and how far they go up to the work `stretch`, in all.
        """
        blocking = []
        for left, line in zip(range(len(lines), 0, -1), lines, strict=True):
            if self._decide([line.edit(line.weakest, 0)], (find - self._spent) / left):
                blocking.append(line)
        found = []
        for left, line in zip(range(len(blocking), 0, -1), blocking, strict=True):
            way, step = self._furthest(line, (stretch - self._spent) / left)
            share = step / way.size if way.size else 0.0
            found.append(((line.changes_model, -share), self._proved(((line, way, step),))))
        return tuple(item for _, item in sorted(found, key=lambda pair: pair[0]))

    def _furthest(self, line: SpecRelaxation, budget: float) -> tuple[RelaxationSteps, int]:
        """Return the proved part of a line, by bisection.

        The steps that matter most come first, and may take the most: of n that are left, each may
        take 2 / (n + 1) of the rest.
        """
        until = self._spent + budget
        way = line.weakest
        left = len(line.alternatives) + max(way.size - 1, 0).bit_length()
        for other in line.alternatives:
            if self._decide([line.edit(other, 0)], 2 * (until - self._spent) / (left + 1)):
                way = other
                break
            left -= 1
        low, high = 0, way.size
        while high - low > 1:
            middle = (low + high) // 2
            left = (high - low - 1).bit_length()
            if self._decide([line.edit(way, middle)], 2 * (until - self._spent) / (left + 1)):
                low = middle
            else:
                high = middle
        return way, low

    def _decide(self, edits: Sequence[Edit], budget: float) -> _Decided | None:
        """Certify a changed spec; None without a proof or without a system."""
        if budget <= 0:
            return None
        try:
            loaded = _edited(self._result.loaded, edits)
            if loaded.sha256 not in self._found:
                self._progress(f"trying change {len(self._found) + 1}")
                self._found[loaded.sha256] = self._certified(loaded, budget)
            return self._found[loaded.sha256]
        except (SpecError, DesignError, AssemblyError):
            # What is no valid spec, or has no design, shows nothing.
            return None

    def _certified(self, loaded: LoadedSpec, budget: float) -> _Decided | None:
        from nrs_design.search.certify import certify, refuted_at_once

        # If these are proved, so is the spec: other gains are chosen only with their proof.
        designed = design_at_least_cost(loaded)
        system = assemble_spec(loaded, designed)
        # Only words differ.
        own = self._result.certification.system
        if system == replace(own, name=system.name, assumptions=system.assumptions):
            return None
        look = min(LOOK, budget / 4)
        self._spent += look
        if refuted_at_once(system, replace(self._limits, budget=look)) is not None:
            return None
        limits = replace(self._limits, budget=budget - look)
        decided = certify(system, limits=limits)
        self._spent += sum(attempt.work for attempt in decided.attempts)
        if decided.verdict is not Verdict.PROVED:
            return None
        return _Decided(loaded, decided, gains_text(designed))

    def _proved(self, lines: Sequence[tuple[SpecRelaxation, RelaxationSteps, int]]) -> Proved:
        edits = [line.edit(form, step) for line, form, step in lines]
        decided = self._found[_edited(self._result.loaded, edits).sha256]
        assert decided is not None
        proof, evidence = decided.certification, decided.certification.evidence
        assert evidence is not None
        known = sentences(self._result.certification.granted)
        given = {line.at[1] for line, _, _ in lines if line.at[-1] in GIVEN_GAINS}
        return Proved(
            tuple(self._blocking(*item) for item in lines),
            evidence.claim(proof.system),
            tuple(text for text in sentences(proof.granted) if text not in known),
            decided.loaded.sha256,
            any(
                self._gains.get(name) != gains
                for name, gains in decided.gains.items()
                if name not in given
            ),
        )

    def _blocking(self, line: SpecRelaxation, form: RelaxationSteps, step: int) -> Blocking:
        value = form.value_at(step)
        key = line.at[-1]
        return Blocking(
            self._result.loaded.place(*line.at),
            dotted(line.at) + self._name(line.at),
            form.requested,
            form.label_at(step),
            form.word,
            "" if value is None else f"{key}: {in_one_line(value)}",
            line.changes_model,
            tuple(map(dotted, identified_above(self._result.loaded.root, line.at))),
        )

    def _name(self, keys: Keys) -> str:
        """Return the name of an item of a list, which has no key."""
        node = node_at(self._result.loaded.root, keys) if isinstance(keys[-1], int) else None
        value = None if node is None else to_data(node)
        name = value.get("name") if isinstance(value, dict) else value
        return f" ({name})" if isinstance(name, str) else ""


def _edited(loaded: LoadedSpec, edits: Sequence[Edit]) -> LoadedSpec:
    return respecified(loaded, with_edits(loaded.root, edits))


def _weakest_edits(lines: Sequence[SpecRelaxation]) -> list[Edit]:
    return [line.edit(line.weakest, 0) for line in lines]


def blocked_lines(blocked: Blocked, path: Path) -> tuple[str, ...]:
    """Write the changes that give a proof, in at most five lines."""
    line_count = counted(blocked.tried, "line")
    line_count += f" out of {blocked.lines}" if blocked.tried < blocked.lines else ""
    if not blocked.proved:
        spent = f"{blocked.work:.2g} of work"
        verb = "was" if blocked.tried == 1 else "were"
        return (f"no change found that is proved: {line_count} of the spec {verb} tried ({spent})",)
    head = "proved with any one of these changes; a larger --budget may reach further"
    head += "; bounds under disturbances were not looked for" if blocked.unbounded else ""
    lines = [_describe(item, path) for item in blocked.proved]
    hidden = len(lines) - PRINTED_LINES
    if hidden > 1:
        lines = [*lines[:PRINTED_LINES], f"and {hidden} more (--json)"]
    return (head, *lines)


def _describe(item: Proved, path: Path) -> str:
    said = " together with ".join(
        f"{path}:{line.place.line}: {line_text(line)}" for line in item.lines
    )
    said += "; gains are designed anew then, and differ" if item.new_gains else ""
    if item.needs and any(line.changes_model for line in item.lines):
        said += f"; takes {counted(len(item.needs), 'thing')} more for granted (--json)"
    return said


def line_text(line: Blocking) -> str:
    """Write the proved part of a line, and its replacement."""
    removals = "".join(f", without {name}" for name in line.left_out)
    if line.word == WITHOUT:
        return f"without {line.line}{removals}"
    said = f"{line.line}: {line.word} {line.proved}, where the spec asks {line.asked}"
    return f"{said} (write `{line.write}`{removals})"

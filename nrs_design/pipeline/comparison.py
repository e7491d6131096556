"""Two specs or certificates beside each other: what they say, and what is proved about them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design.certificates.catalogue import sentence_with_bound
from nrs_design.certificates.units import gain_units
from nrs_design.errors import DesignError
from nrs_design.pipeline.design import run_analysis
from nrs_design.pipeline.runs import run_certification
from nrs_design.progress import Progress, silent
from nrs_design.proof.evidence.fields import rate_text
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import exact_text
from nrs_design.spec import LoadedSpec, read_spec
from nrs_design.spec.document import Data, to_data

if TYPE_CHECKING:
    from nrs_design.certificates.certificate import Certificate

CERTIFICATE_SUFFIX = ".json"
# What is longer is a sentence, not a value.
LONGEST_CELL = 60
_RATES = ("decay rate", "contraction per step")


class Part(StrEnum):
    """What a difference is about."""

    SPEC = "spec"
    GAINS = "gains"
    MARGINS = "margins"
    VERDICT = "verdict"
    ASSUMPTIONS = "assumptions"


@dataclass(frozen=True, slots=True)
class Side:
    """One of two things that are compared."""

    path: Path  # Of the spec or certificate
    name: str  # Of the spec
    # What there is to compare, by its name. A part that a file cannot tell is left out: a
    # certificate has no margins, and does not repeat its spec.
    parts: Mapping[Part, Mapping[str, str]]


@dataclass(frozen=True, slots=True)
class Difference:
    """One thing that is not the same on both sides; None where a side does not have it."""

    part: Part
    what: str
    before: str | None
    after: str | None

    @property
    def is_text(self) -> bool:
        """Whether it is told in sentences."""
        longest = max(len(self.before or ""), len(self.after or ""))
        return self.part is Part.ASSUMPTIONS or longest > LONGEST_CELL


@dataclass(frozen=True, slots=True)
class Comparison:
    """Two sides, and where they differ."""

    # before, after: what was compared.
    before: Side
    after: Side
    differences: tuple[Difference, ...]  # In the order of `Part`
    compared: tuple[Part, ...]  # Those that both sides tell

    @property
    def same(self) -> tuple[Part, ...]:
        """The parts without a difference."""
        differing = {item.part for item in self.differences}
        return tuple(part for part in self.compared if part not in differing)

    @property
    def remarks(self) -> tuple[str, ...]:
        """What a reader of the differences must know."""
        texts = []
        if self.not_compared:
            parts = ", ".join(self.not_compared)
            texts.append(f"Not compared, since not both files tell it: {parts}.")
        verdicts = (side.parts.get(Part.VERDICT, {}) for side in (self.before, self.after))
        names = [
            next((key for key in verdict if key.startswith(_RATES)), "") for verdict in verdicts
        ]
        if all(names) and names[0] != names[1]:
            texts.append(
                f"The rates are not compared: {' and '.join(f'a {name}' for name in names)} are "
                "numbers of different things."
            )
        return tuple(texts)

    @property
    def not_compared(self) -> tuple[Part, ...]:
        """The parts that only one side tells, or none."""
        return tuple(part for part in Part if part not in self.compared)


def compare(before: Path, after: Path, progress: Progress = silent) -> Comparison:
    """Compare two specs, two certificates (files that end in .json), or one of each.

    Specs are designed and certified afresh; certificates are re-checked without their specs.
    """
    # Both are read before the first one is designed.
    given = [
        (path, None if path.suffix == CERTIFICATE_SUFFIX else read_spec(path))
        for path in (before, after)
    ]
    sides = []
    for path, loaded in given:
        progress(str(path))
        sides.append(_side_of_certificate(path) if loaded is None else _side_of_spec(loaded))
    return compare_sides(*sides)


def compare_sides(before: Side, after: Side) -> Comparison:
    """Find the differences in what both sides tell."""
    compared = tuple(part for part in Part if part in before.parts and part in after.parts)
    differences = tuple(
        Difference(part, what, old.get(what), new.get(what))
        for part in compared
        for old, new in ((before.parts[part], after.parts[part]),)
        for what in {**old, **new}
        if old.get(what) != new.get(what)
    )
    return Comparison(before, after, differences, compared)


def _side_of_certificate(path: Path) -> Side:
    from nrs_design.certificates.verify import verify

    checked = verify(path)
    certificate = checked.certificate
    if certificate is None or checked.fault is not None:
        rejected = {"verdict": "rejected", "fault": str(checked.fault)}
        return Side(path, path.stem, {Part.VERDICT: rejected})
    return Side(path, certificate.spec_name, _proof_parts(certificate))


def _side_of_spec(loaded: LoadedSpec) -> Side:
    result = run_certification(loaded)
    parts: dict[Part, Mapping[str, str]] = {Part.SPEC: dict(_flat(to_data(loaded.root)))}
    if result.certificate is None:
        parts[Part.VERDICT] = {"verdict": str(result.certification.verdict)}
    else:
        parts |= _proof_parts(result.certificate)
    if result.designed is not None:
        with suppress(DesignError):  # A nominal loop that is unstable has no margins.
            analysis = run_analysis(result.designed)
            parts[Part.MARGINS] = {
                f"{item.name}: {found.measure.title}": found.measure.text(found.value)
                for item in analysis.measured
                for found in item.achieved
            }
    return Side(loaded.path, loaded.spec.name, parts)


def _proof_parts(certificate: Certificate) -> dict[Part, Mapping[str, str]]:
    system, evidence = certificate.system, certificate.evidence
    rate = None if evidence is None else evidence.proved_rate(system)
    verdict = {"verdict": certificate.verdict, "modes": str(len(system.modes))}
    if certificate.refuted_in is not None:
        verdict["refuted"] = certificate.refuted_in
    if rate is not None:
        unit = " 1/s" if system.time is Time.CONTINUOUS else ""
        verdict[_rate_name(system)] = f"{rate_text(rate, system.time)}{unit}"
    for number, statement in enumerate(certificate.statements, 1):
        verdict[f"statement {number}"] = statement.claim(system)
    units = gain_units(certificate)
    gains = {
        f"{name}.{gain}": f"{value} {units[name][gain]}"
        for name, values in certificate.gains.items()
        for gain, value in values.items()
    }
    # The data of an assumption is its name: both sides have it, or they differ.
    assumptions = {str(item): sentence_with_bound(item) for item in certificate.granted}
    return {Part.GAINS: gains, Part.VERDICT: verdict, Part.ASSUMPTIONS: assumptions}


def _rate_name(system: SwitchedSystem) -> str:
    """Name a rate so that only those are set side by side that are numbers of the same thing."""
    decay, contraction = _RATES
    if system.time is Time.CONTINUOUS:
        return decay
    if system.sample_time is None:
        return contraction
    return f"{contraction} of {exact_text(system.sample_time)} s"


def _flat(data: Data, place: str = "") -> Iterator[tuple[str, str]]:
    """Yield each value of a spec with its place, such as ``controllers.soft.Bt``."""
    if isinstance(data, str):
        yield place, data
    elif isinstance(data, tuple):
        for index, item in enumerate(data):
            yield from _flat(item, f"{place}[{index}]")
    else:
        for key, value in data.items():
            yield from _flat(value, f"{place}.{key}" if place else key)

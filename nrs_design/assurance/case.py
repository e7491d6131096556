"""All facts of one assurance case; the modules beside this one say them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from nrs_design.assurance.build import Build, read_build
from nrs_design.assurance.hazards import TracedHazard, trace_hazards
from nrs_design.assurance.register import (
    RecordState,
    RegisterRow,
    ids_of,
    recorded_state,
    register_rows,
)
from nrs_design.assurance.results import RecordedTests, read_results
from nrs_design.assurance.steps import user_steps
from nrs_design.assurance.tool import Decider, decider
from nrs_design.certificates.certificate import Certificate, Gains
from nrs_design.certificates.units import gain_units
from nrs_design.errors import DesignError
from nrs_design.exporters import rendered
from nrs_design.exporters.build import build_record
from nrs_design.exporters.export import Export
from nrs_design.exporters.outside import outside_of
from nrs_design.gating.obligations import Obligation
from nrs_design.pipeline import Result
from nrs_design.progress import Progress, silent

# What a processor runs, beside the record of the gains.
PROGRAM = ("c", "monitor", "vectors")


@dataclass(frozen=True, slots=True)
class UserFile:
    """A file of the user that is named by its hash and not kept, such as the binary."""

    name: str
    size: int  # In bytes
    sha256: str


@dataclass(frozen=True, slots=True)
class Given:
    """What users give beside spec and certificate."""

    results: Path | None = None  # File of what they found
    build: Path | None = None  # Record of a build
    binaries: tuple[UserFile, ...] = ()  # What runs on the robot
    date: str = ""  # Written into the files; none by default


@dataclass(frozen=True, slots=True)
class Case:
    """What is claimed of one spec, what shows it, and what is left open."""

    name: str
    title: str
    spec_sha256: str
    certificate: Certificate
    certificate_id: str
    claim: str  # Of the statement that decides
    also: tuple[str, ...]  # Claims of all other statements, such as bounds
    gains: Gains
    units: Mapping[str, Mapping[str, str]]
    outside: tuple[str, ...]  # Of the proof
    register: tuple[RegisterRow, ...]
    obligations: tuple[Obligation, ...]
    hazards: tuple[TracedHazard, ...]
    results: RecordedTests
    program: Mapping[str, bytes]  # Exported files by name; empty if there is no program
    no_program: str  # Why; empty if there is one
    build: Build | None  # None without a record of one
    binaries: tuple[UserFile, ...]
    decider: Decider
    date: str  # Empty unless one was asked for

    @property
    def missed(self) -> tuple[Obligation, ...]:
        """Obligations that are not fulfilled."""
        return tuple(item for item in self.obligations if not item.fulfilled)

    @property
    def states(self) -> dict[str, RecordState]:
        """What users found, by id: assumptions first, then steps to the robot."""
        steps = {
            id: recorded_state(id, self.results, self.spec_sha256)
            for id in user_steps(self.program)
        }
        return {row.id: row.state for row in self.register} | steps

    @property
    def open(self) -> tuple[str, ...]:
        """Ids of which something is left to show."""
        unsettled = {row.id for row in self.register if not row.settled}
        steps = {id for id in user_steps(self.program) if self.states[id] is not RecordState.PASSED}
        return tuple(id for id in self.states if id in unsettled | steps)

    @property
    def failed(self) -> tuple[str, ...]:
        """Ids whose test failed."""
        return tuple(id for id, state in self.states.items() if state is RecordState.FAILED)


def build_case(
    result: Result,
    obligations: Iterable[Obligation],
    given: Given,
    progress: Progress = silent,
) -> Case:
    """Collect the facts of a case.

    Parameters
    ----------
    result : Result
        Of a certification that proved its spec.
    obligations : iterable of Obligation
        What the gate asks of the spec, each as it ended.
    given : Given
        By users.
    progress : callable
        Told the name of each step.

    Raises
    ------
    DataError, SpecError
        If the file of results or of the build cannot be read, or is about something else.
    """
    certificate = result.certificate
    assert certificate is not None, "proved"
    evidence, system = certificate.evidence, certificate.system
    assert evidence is not None, "proved"
    progress("program")
    program, why = _program(result, certificate)
    ids = (*dict.fromkeys(ids_of(result.certification.granted)), *user_steps(program))
    found = RecordedTests() if given.results is None else read_results(given.results, ids)
    rows, judged = register_rows(result, found), tuple(obligations)
    headers = "".join(text.decode() for name, text in program.items() if name.endswith(".h"))
    sampled = system.sample_time is not None
    limits = None if result.designed is None else result.designed.spec.limits
    return Case(
        name=certificate.spec_name,
        title=getattr(result.loaded.spec, "title", None) or "",
        spec_sha256=certificate.spec_sha256,
        certificate=certificate,
        certificate_id=certificate.id,
        claim=evidence.claim(system),
        also=tuple(s.claim(system) for s in certificate.statements if s is not evidence),
        gains=certificate.gains,
        units=gain_units(certificate),
        outside=outside_of(sampled=sampled, rounded=evidence.covers_rounding)
        if certificate.gains
        else (),
        register=rows,
        obligations=judged,
        hazards=trace_hazards(limits, certificate.gains, rows, judged, headers),
        results=found,
        program=program,
        no_program=why,
        build=None if given.build is None else read_build(given.build, certificate, program),
        binaries=given.binaries,
        decider=decider(),
        date=given.date,
    )


def _program(result: Result, certificate: Certificate) -> tuple[dict[str, bytes], str]:
    """Return the files of the program, or none and why."""
    designed = result.designed
    if designed is None:
        return {}, "the spec gives matrices, and no law"
    if certificate.system.sample_time is None:
        return {}, "the proof is about continuous time"
    if certificate.system.clock is not None and certificate.system.clock.is_round:
        return {}, "an export has room for one period, and the outer loop has its own"
    spec, design = designed.spec, designed.design
    record = build_record(design, certificate, spec)
    export = Export("proved", record, certificate, design=design, spec=spec, designed=designed)
    try:
        return dict(_files(export, spec.name)), ""
    except DesignError as error:
        return {}, error.message


def _files(export: Export, name: str) -> Iterator[tuple[str, bytes]]:
    for format_ in PROGRAM:
        for ending, content in rendered(format_, export).items():
            yield f"{name}{ending}", content

"""The gate itself: design, certify, write, re-check, for every spec.

What is recorded and still holds is checked, and not searched for again: another processor finds
other last digits of the same proof.
"""

from __future__ import annotations

import hashlib
import os
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design import __version__
from nrs_design.certificates.certificate import dump
from nrs_design.certificates.ownership import REMEDY, check_owner, origin_of
from nrs_design.controllers.gains import gains_of
from nrs_design.errors import DesignError, Fault, OutputError, SpecError
from nrs_design.gating.examine import Examiner
from nrs_design.gating.obligations import GateOutcome, Obligation, SpecOutcome, failed, is_utf8
from nrs_design.models.axis import axis_context
from nrs_design.output import CERTIFICATE, PAGE, check_place, write_output
from nrs_design.pipeline.blocked import Blocked, blocked_lines, find_blocked
from nrs_design.pipeline.certification import Overrides, Result, run_verification, search_limits
from nrs_design.pipeline.processes import map_in_processes
from nrs_design.pipeline.runs import Recorded, run_certification, run_kept
from nrs_design.pipeline.scenarios import run_judgement
from nrs_design.progress import Progress, silent
from nrs_design.spec import LoadedSpec, RobotSpec, read_spec
from nrs_design.spec.task_space import file_of

if TYPE_CHECKING:
    from nrs_design.certificates.certificate import Certificate
    from nrs_design.design.analysis import DesignAnalysis

_SEAL = "<!-- "
_Examine = Callable[[LoadedSpec, Progress], SpecOutcome]


@dataclass(frozen=True, slots=True, kw_only=True)
class Files:
    """Places of the files of a spec: ``NAME.cert.json`` and, on request, ``NAME.html``."""

    folder: Path  # For all of them
    html: bool = True  # Write reports of new or broken specs
    every_page: bool = False  # Write reports of all specs
    # The certificate that is locked for a spec, by the absolute path of the spec.
    locked: Mapping[Path, Recorded] = field(default_factory=dict)

    def certificate(self, name: str) -> Path:
        """Return the certificate file of the spec of that name."""
        return self.folder / f"{name}.cert.json"

    def find_record(self, loaded: LoadedSpec) -> Recorded:
        """Return the certificate that is locked for a spec; else where it would be."""
        record = Recorded(self.certificate(loaded.spec.name))
        return self.locked.get(Path(os.path.abspath(loaded.path)), record)

    def report(self, name: str) -> Path:
        """Return the report file of the spec of that name."""
        return self.folder / f"{name}.html"

    def check_owner(self, spec: Path, name: str) -> None:
        """Refuse to write files of that name where they are those of another spec."""
        check_owner(spec, name, self.folder)
        file = self.certificate(name)
        place, spec_path = os.path.realpath(file), os.path.realpath(spec)
        for owner, record in self.locked.items():
            locked = record.file.name == file.name and os.path.realpath(record.file) == place
            if locked and file_of(owner).is_file() and os.path.realpath(owner) != spec_path:
                message = f"is locked for {os.path.relpath(owner)}"
                raise OutputError(message, path=file, remedy=REMEDY)


def run_gate(
    specs: Sequence[Path],
    files: Files,
    progress: Progress = silent,
    overrides: Overrides | None = None,
    jobs: int = 1,
) -> GateOutcome:
    """Design and certify every spec, and write its certificate and report.

    A spec that fails is part of the outcome, which is the same for any number of jobs (processes).
    """
    read = [_read(path) for path in specs]
    valid = [item for item in read if isinstance(item, LoadedSpec)]
    examine = partial(_examine_safely, files, overrides, _namesakes(valid))
    found: dict[Path, SpecOutcome] = {}
    if jobs == 1:
        found = {one.path: examine(one, progress) for one in valid}
    else:
        work = partial(_examine_next, examine, [one.path for one in valid])
        for _, outcome in map_in_processes(work, range(len(valid)), jobs):
            found[outcome.path] = outcome
            progress(f"{len(found)} of {len(valid)} specs")
    return GateOutcome(
        tuple(item if isinstance(item, SpecOutcome) else found[item.path] for item in read)
    )


def _examine_safely(
    files: Files,
    overrides: Overrides | None,
    namesakes: Mapping[Path, Path],
    loaded: LoadedSpec,
    progress: Progress,
) -> SpecOutcome:
    """Return the outcome of a spec; every error becomes an outcome."""
    namesake, name = namesakes.get(loaded.path), loaded.spec.name
    try:
        if namesake is not None:
            place, remedy = loaded.place("name"), "give every spec a name of its own"
            message = (
                f"{namesake} is named {name!r} too, and their files would overwrite each other"
            )
            fault = Fault(message, place.line, place.column, remedy)
            raise SpecError.combine((fault,), loaded.path)
        with axis_context(getattr(loaded.spec, "axis", None)):
            return _examine(loaded, files, lambda s: progress(f"{name}: {s}"), overrides)
    except Exception as error:
        # One spec must not keep the others from being examined, whatever goes wrong with it.
        return failed(loaded.path, error, loaded.sha256)


def _examine_next(examine: _Examine, paths: Sequence[Path], index: int) -> SpecOutcome:
    """Return what is found about a spec, which is read here."""
    read = _read(paths[index])
    return read if isinstance(read, SpecOutcome) else examine(read, silent)


def _read(path: Path) -> LoadedSpec | SpecOutcome:
    try:
        if not is_utf8(path):
            raise SpecError("the name of the file is not UTF-8", path=path, remedy="rename it")
        return read_spec(path)
    except Exception as error:
        return failed(path, error)


def _namesakes(specs: Iterable[LoadedSpec]) -> dict[Path, Path]:
    """Return another spec of the same name, for those that have one."""
    paths_by_name: defaultdict[str, list[Path]] = defaultdict(list)
    for loaded in specs:
        # Some file systems do not tell capitals from small letters.
        paths_by_name[loaded.spec.name.casefold()].append(loaded.path)
    duplicates = (paths for paths in paths_by_name.values() if len(paths) > 1)
    return {path: paths[paths[0] == path] for paths in duplicates for path in paths}


def _examine(
    loaded: LoadedSpec, files: Files, progress: Progress, overrides: Overrides | None
) -> SpecOutcome:
    if isinstance(loaded.spec, RobotSpec):
        return Examiner(loaded).nothing_to_certify()
    files.check_owner(loaded.path, loaded.spec.name)
    # Refuse what cannot be written before minutes of search.
    place = files.certificate(loaded.spec.name)
    check_place(place, CERTIFICATE)
    if files.html:
        check_place(files.report(loaded.spec.name), PAGE)
    limits = search_limits(loaded.spec, overrides)
    # Options that limit the search request a search.
    has_overrides = overrides not in (None, Overrides())
    kept = None if has_overrides else run_kept(loaded, files.find_record(loaded), progress)
    result = kept or run_certification(loaded, limits=limits, progress=progress)
    certification, certificate = result.certification, result.certificate
    examiner = Examiner(loaded)
    blocked = find_blocked(result, limits, progress)
    attempts = [f"{a.step}: {a.outcome}" for a in certification.attempts]
    searched = "; ".join((*attempts, *(blocked_lines(blocked, loaded.path) if blocked else ())))
    obligations = examiner.stability(certification.system, certification.statements, searched)
    file = None if certificate is None else place
    if certificate is not None:
        fault = None
        text = dump(certificate, origin_of(loaded.path, place))
        if kept is None or not place.exists() or place.read_bytes() != text.encode():
            write_output(place, text, replaces=CERTIFICATE)
            progress("re-check")
            fault = run_verification(place, result).fault
        obligations += (examiner.certificate(place, fault),)
    simulated = tuple(_judge_scenarios(result, examiner, progress))
    analysis, goals = _judge_margins(result, examiner, progress)
    items = (*examiner.contact(certificate), *examiner.limits(certificate))
    cautions = (*items, *examiner.cautions(analysis))
    obligations += (
        *examiner.certified_goals(certificate),
        *goals,
        *simulated,
        *examiner.identified(),
    )
    page = files.report(loaded.spec.name)
    fulfilled = all(item.fulfilled for item in obligations)
    renewed = kept is None or not fulfilled
    origin = origin_of(loaded.path, page)
    if files.every_page or (files.html and (renewed or not _is_of(page, certificate, origin))):
        progress("report")
        _write_page(result, page, origin, analysis, blocked)
    outcome = examiner.outcome(certification, file, certificate, obligations, cautions)
    if result.design is None:
        return outcome
    gains, units = gains_of(result.design), result.design.units
    return replace(outcome, gains=gains, units=units)


def _judge_margins(
    result: Result, examiner: Examiner, progress: Progress
) -> tuple[DesignAnalysis | None, tuple[Obligation, ...]]:
    """Analyze a design, and return how its goals and stiffness ranges end: NRS103, NRS106.

    No analysis for given matrices, and where a nominal loop is unstable.
    """
    if result.designed is None:
        return None, ()
    progress("margins")
    try:
        analysis = run_judgement(result.designed)
    except DesignError as error:
        return None, (examiner.no_margins(error),)
    examinations = (examiner.stiffness_ranges, examiner.goals)
    return analysis, tuple(item for judge in examinations for item in judge(analysis))


def _judge_scenarios(
    result: Result, examiner: Examiner, progress: Progress
) -> Iterator[Obligation]:
    """Simulate the scenarios that have limits, and yield how they end."""
    if result.designed is None:
        return
    names = [n for n, one in result.designed.spec.scenarios.items() if one.limits is not None]
    if not names:
        return
    from nrs_design.pipeline.scenarios import Runs, run_scenarios

    for name in names:
        progress(f"scenario {name}")
        try:
            (simulated,) = run_scenarios(result.designed, Runs((name,)))
        except DesignError as error:
            yield examiner.no_scenario(name, error)
        else:
            yield from examiner.scenario(name, simulated)


def _is_of(page: Path, certificate: Certificate | None, origin: str) -> bool:
    """Tell whether a page is not there, or is as this program drew it of this certificate.

    To draw it anew takes long. Its spec must lie where it did.
    """
    if not page.exists() or certificate is None:
        return not page.exists()
    body, _, seal = page.read_text(encoding="utf-8", errors="replace").rpartition(_SEAL)
    return certificate.id in body and seal == _seal(body, origin)


def _seal(body: str, origin: str) -> str:
    """Return the end of a page, which is another if the page changes or its spec moves."""
    return f"{hashlib.sha256(f'{__version__}{origin}{body}'.encode()).hexdigest()} -->\n"


def _write_page(
    result: Result,
    page: Path,
    origin: str,
    analysis: DesignAnalysis | None,
    blocked: Blocked | None,
) -> None:
    # Drawing costs seconds to import; a run without reports must not pay for it.
    from nrs_design.reporting import build_report, render_html

    html = render_html(build_report(result, analysis, blocked=blocked), origin)
    write_output(page, f"{html}{_SEAL}{_seal(html, origin)}", replaces=PAGE)

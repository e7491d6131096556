"""Entry points of the library: results for records and for logs of runs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nrs_design.api.audit import Audit
from nrs_design.api.identified import FittedRange, Identification
from nrs_design.identification.actuator.identify import identify_actuator
from nrs_design.identification.datasets.records import read_actuator, read_signals, read_tissue
from nrs_design.identification.delay.identify import identify_delay
from nrs_design.identification.errors import DataError
from nrs_design.identification.reporting.actuator import view_actuator
from nrs_design.identification.reporting.delay import view_delay
from nrs_design.identification.reporting.running import run_facts
from nrs_design.identification.reporting.tissue import view_tissue
from nrs_design.identification.reporting.view import FindingView, is_synthetic
from nrs_design.identification.running.bounds import proof_of, read_run_bounds
from nrs_design.identification.running.judge import judge_run
from nrs_design.identification.running.log import read_run
from nrs_design.identification.tables.columns import parse_mapping
from nrs_design.identification.tables.table import Data
from nrs_design.identification.tissue.identify import identify_tissue
from nrs_design.identification.write_spec import check_turning
from nrs_design.models.contact import LAWS

if TYPE_CHECKING:
    from nrs_design.spec import LoadedSpec

Columns = Mapping[str, str]  # From names in the file to standard names

# Standard names of the columns of a delay.
_DELAY_COLUMNS = {"command": "input_any", "measured": "output_any"}


def identify_records(
    files: Sequence[str | Path | Mapping[str, Any]],
    kind: str,
    law: str | None,
    columns: Mapping[str, str],
) -> Identification:
    """Identify what records are of; see `nrs_design.api.identify`."""
    _check(files, kind, law)
    named_ours = {_DELAY_COLUMNS.get(k, k) if kind == "delay" else k: v for k, v in columns.items()}
    mapping = parse_mapping([f"{standard}={foreign}" for standard, foreign in named_ours.items()])
    data = [Path(file) if isinstance(file, str | Path) else file for file in files]
    view = _KINDS[kind](data, mapping, law)
    result = view.result
    return Identification(
        kind=kind,
        chosen=view.method,
        reason=view.reason,
        ranges={
            name: FittedRange(estimate.value, estimate.low, estimate.high, unit)
            for name, (estimate, unit) in view.ranges.items()
        },
        files=tuple(source.path for source in result.sources),
        synthetic=is_synthetic(result.sources),
        remarks=tuple(result.remarks),
        doubts=tuple(result.doubts),
        caveats=tuple(result.caveats),
        facts=view.document,
        page=view.page,
    )


def _check(files: Sequence[object], kind: object, law: str | None) -> None:
    """Refuse unknown kinds and laws, and swapped arguments."""
    # A kind in the place of a file may be of any type, also one without a hash.
    kinds = tuple(_KINDS)
    if kind not in kinds:
        if any(isinstance(file, str) and file in kinds for file in files):
            remedy = "the records come first: identify(files, kind)"
            raise DataError("the arguments are swapped", remedy=remedy)
        raise DataError(f"there is no kind {kind!r}", remedy=f"write {', '.join(kinds)}")
    if law is not None and kind != "tissue":
        raise DataError(f"records of kind {kind} have no law", remedy="leave law out")
    if law is not None and law not in LAWS:
        raise DataError(f"there is no law {law!r}", remedy=f"one of {', '.join(LAWS)}")
    if kind == "delay" and len(files) != 1:
        raise DataError("a delay is that of one record", remedy="name one file")


def _tissue(files: Sequence[Data], mapping: Columns, law: str | None) -> FindingView:
    return view_tissue(identify_tissue([read_tissue(file, mapping) for file in files], law))


def _actuator(files: Sequence[Data], mapping: Columns, law: None) -> FindingView:
    return view_actuator(identify_actuator([read_actuator(file, mapping) for file in files]))


def _delay(files: Sequence[Data], mapping: Columns, law: None) -> FindingView:
    return view_delay(identify_delay(read_signals(files[0], mapping)))


_KINDS: Mapping[str, Callable[..., FindingView]] = {
    "tissue": _tissue,
    "actuator": _actuator,
    "delay": _delay,
}


def judge_log(log: Path, loaded: LoadedSpec, certificate: Path | None) -> Audit:
    """Judge whether a run stayed inside what was proved; see `nrs_design.api.Study.audit`."""
    check_turning(loaded.spec, loaded.path)
    reason, losable = proof_of(certificate, loaded)
    result = judge_run(read_run(log), read_run_bounds(loaded), proved=not reason, losable=losable)
    return Audit(
        name=loaded.spec.name,
        verdict=result.verdict,
        unproved_because=reason,
        checks=result.checks,
        first=result.first,
        synthetic=result.log.source.synthetic,
        facts=run_facts(result, loaded, certificate, reason),
    )

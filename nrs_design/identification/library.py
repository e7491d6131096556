"""What the library offers of this wing."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design.errors import DataError
from nrs_design.identification.actuator import (
    THESIS_MOTOR,
    ActuatorIdentification,
    identify_actuator,
)
from nrs_design.identification.datasets import FrequencyResponse, read_actuator, read_tissue
from nrs_design.identification.running import RunJudgement, judge_run, read_run, read_run_bounds
from nrs_design.identification.running.proof import proof_of
from nrs_design.identification.tissue import TissueIdentification, identify_tissue
from nrs_design.models.contact import LAWS

if TYPE_CHECKING:
    from nrs_design.spec import LoadedSpec


def identify_records(
    files: Sequence[Path], kind: str, law: str | None
) -> TissueIdentification | ActuatorIdentification:
    """Fit a tissue or an actuator to records; see `nrs_design.api.identify`.

    Parameters
    ----------
    files : sequence of Path
        CSV files.
    kind : {"tissue", "actuator"}
        What they are records of.
    law : str or None
        Of the tissue.

    Raises
    ------
    DataError
        If a file is no such record, or there is no such kind or law.
    """
    if kind not in ("tissue", "actuator"):
        raise DataError(f"there is no kind {kind!r}", remedy="write tissue or actuator")
    if kind == "actuator":
        if law is not None:
            raise DataError("an actuator has no law", remedy="leave law out")
        series = [read_actuator(file) for file in files]
        return identify_actuator(
            [
                record
                for item in series
                for record in ((item,) if isinstance(item, FrequencyResponse) else item)
            ],
            THESIS_MOTOR,
        )
    if law is not None and law not in LAWS:
        raise DataError(f"there is no law {law!r}", remedy=f"one of {', '.join(LAWS)}")
    return identify_tissue([read_tissue(file) for file in files], law)


def judge_log(log: Path, loaded: LoadedSpec, certificate: Path | None) -> RunJudgement:
    """Judge whether a run stayed inside what was proved; see `nrs_design.api.Study.audit`.

    Parameters
    ----------
    log : Path
        CSV file of the run.
    loaded : LoadedSpec
        The spec.
    certificate : Path or None
        Checked against the spec.

    Raises
    ------
    DataError, CertificateError
        If a file cannot be used.
    """
    reason, losable = proof_of(certificate, loaded)
    return judge_run(read_run(log), read_run_bounds(loaded), proved=not reason, losable=losable)

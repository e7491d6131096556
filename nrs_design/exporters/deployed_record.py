"""Whether a deployed export record is that of a certificate."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

from nrs_design.errors import NrsDesignError
from nrs_design.exporters.record import ExportRecord, Gain, dump_record

# The field that is not compared: it names the release that wrote it.
_RELEASE = "package"


def record_differences(text: str, proved: ExportRecord, file: Path) -> Iterator[str]:
    """Yield in what an export record differs from that of a certificate, field by field.

    Parameters
    ----------
    text : str
        What was deployed.
    proved : ExportRecord
        What is exported.
    file : Path
        Where the text is, for errors.

    Raises
    ------
    NrsDesignError
        If it is no export record.
    """
    from pydantic import ValidationError

    try:
        record = ExportRecord.model_validate_json(text)
    except ValidationError as error:
        raise NrsDesignError(
            "is not an export record, or its numbers disagree with each other",
            path=file,
            remedy="export it again with --format json",
        ) from error
    told = [*_of_numbers(record, proved)]
    yield from told
    if told:
        return
    found, wanted = json.loads(text), json.loads(dump_record(proved))
    for name in sorted((found.keys() | wanted.keys()) - {_RELEASE}):
        if name not in found or name not in wanted or found[name] != wanted[name]:
            yield f"its field {name!r} is not what the certificate says"


def _of_numbers(record: ExportRecord, proved: ExportRecord) -> Iterator[str]:
    """Yield what can be said of gains, and of what runs beside them."""
    if record.spec.sha256 != proved.spec.sha256:
        yield "it is of another spec, or of an earlier text of it"
    listed, names = _gains_of(record), ["motion", *(c.name for c in record.controllers)]
    mine, wanted = dict(listed), dict(_gains_of(proved))
    if len(mine) < len(listed) or len({*names}) < len(names):
        yield "a controller or a gain is there twice"
    for at in sorted(mine.keys() | wanted.keys()):
        found, has = mine.get(at, "missing"), wanted.get(at, "no such gain")
        if found != has:
            name, gain = at
            yield f"{gain} of {name} is {found}, and the certificate has {has}"
    rest = _rest_of(proved)
    for what, found in _rest_of(record).items():
        if found != rest[what]:
            yield f"{what}: {found}, and the certificate has {rest[what]}"


def _gains_of(record: ExportRecord) -> list[tuple[tuple[str, str], str]]:
    """Return every gain with its unit, by controller and name."""
    parts = [("motion", record.motion.gains), *((c.name, c.gains) for c in record.controllers)]
    return [((name, gain.name), _said(gain)) for name, gains in parts for gain in gains]


def _rest_of(record: ExportRecord) -> dict[str, str]:
    """Return what runs beside the gains, in words."""
    low_pass, idle, period = record.force_filter, record.idle_states, record.sample_time
    return {
        "laws and contacts": "; ".join(
            f"{c.name}: {c.law} at {', '.join(c.contacts)}" for c in record.controllers
        ),
        "lags of the filter and their pole": f"{low_pass.order}, {_said(low_pass.pole)}"
        if low_pass
        else "none",
        "decay and reset of idle states": f"{_said(idle.decay)}, {idle.reset}" if idle else "none",
        "offset": record.offset or "none",
        "sample time in s": period.exact if period else "none",
        "age of the force sample": "{} to {}".format(*record.delay) if record.delay else "none",
    }


def _said(gain: Gain) -> str:
    return f"{gain.exact} {gain.unit}"

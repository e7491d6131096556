"""Whether numbers that were deployed are those of a certificate, bit for bit.

An exported header is read as a compiler reads it, as far as its numbers go: comments say nothing.
An export record is read as JSON. Of the law, code is not compared: that is what the vectors are
for. A monitor has tables in its code, and a model for co-simulation has it inside: theirs is.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

from nrs_design.certificates.certificate import Certificate
from nrs_design.controllers.gains import design_from_gains
from nrs_design.errors import NrsDesignError
from nrs_design.exporters.build import build_record
from nrs_design.exporters.deployed_c import code_differences, macro_differences
from nrs_design.exporters.deployed_model import model_differences
from nrs_design.exporters.export import Export
from nrs_design.exporters.formats import monitor
from nrs_design.exporters.monitor_limits import monitor_limits
from nrs_design.exporters.program import program_of
from nrs_design.exporters.record import ExportRecord, Gain, dump_record
from nrs_design.files import open_regular
from nrs_design.spec import InteractionDesignSpec

LARGEST_BYTES = 2**22
# The field of a record that is not compared: it names the release that wrote it.
_RELEASE = "package"


def scope_of(file: Path) -> tuple[str, str]:
    """Return what of a deployed file `find_differences` compares, and what it does not."""
    if file.suffix == ".json":
        return "all fields", "the release that wrote it"
    if file.suffix == ".fmu":
        return "sources, variables and library", "the documentation inside"
    source = file.with_suffix(".c").name
    if file.suffix == ".h":
        return "macros", f"any code ({source}), comments, how it is compiled"
    return "code", f"its headers ({file.with_suffix('.h').name}), comments, how it is compiled"


def find_differences(
    file: Path, spec: InteractionDesignSpec, certificate: Certificate
) -> list[str]:
    """Return in what a deployed file differs from a certificate; nothing if in nothing.

    Parameters
    ----------
    file : Path
        An exported header (``.h``), monitor (``.h``, ``.c``), model (``.fmu``) or export record
        (``.json``).
    spec : InteractionDesignSpec
        That of the certificate.
    certificate : Certificate
        Accepted, and about this spec.

    Raises
    ------
    NrsDesignError
        If the file cannot be read as one of these, or the certificate says nothing about it.
    """
    if file.suffix == ".json":
        return [*_of_record(_text(file), spec, certificate, file)]
    if file.suffix not in (".h", ".c", ".fmu"):
        raise _something_else(file)
    export = _exported(spec, certificate, file)
    if file.suffix == ".fmu":
        return [*model_differences(_read(file), export)]
    text = _text(file)
    if "_monitor_t" in text:
        return [*_of_monitor(text, export, file)]
    if file.suffix == ".c":
        raise _something_else(file)
    program = program_of(export)
    wanted = program.names.numbers(program.law)
    return [*macro_differences(text, f"{program.names.upper}_H", wanted)]


def _something_else(file: Path) -> NrsDesignError:
    return NrsDesignError(
        "is none of the files whose numbers are compared",
        path=file,
        remedy="name the .h of `export --format c`, a file of `--format monitor`, or that of "
        "`--format fmu` or `--format json`",
    )


def _exported(spec: InteractionDesignSpec, certificate: Certificate, file: Path) -> Export:
    """Return what is exported with a certificate of a sampled loop."""
    if certificate.system.sample_time is None:
        raise NrsDesignError(
            "holds a law in steps, and the certificate is about continuous time",
            path=file,
            remedy="name a certificate of a spec with `sampling`",
        )
    if certificate.system.clock is not None:
        raise NrsDesignError(
            "holds a law of one period, and the certificate is about two",
            path=file,
            remedy="name a certificate of a spec without `outer_period`",
        )
    record, design = _record(spec, certificate), design_from_gains(spec, certificate.gains)
    return Export("proved", record, certificate, design=design, spec=spec)


def _record(spec: InteractionDesignSpec, certificate: Certificate) -> ExportRecord:
    design = design_from_gains(spec, certificate.gains)
    delay = None if spec.sampling is None else spec.sampling.delay
    return build_record(design, certificate, spec.idle_states, spec.offset, delay)


def _of_monitor(text: str, export: Export, file: Path) -> Iterator[str]:
    """Compare all macros of its header, or all code of its source, where the tables are."""
    program = program_of(export)
    limits, names = monitor_limits(export, program.law.modes), program.names
    if file.suffix == ".c":
        yield from code_differences(text, monitor.source_text(program, limits))
        return
    wanted = monitor.macro_numbers(names, limits)
    guard = f"{names.upper}_MONITOR_H"
    yield from macro_differences(text, guard, wanted, (f"{names.spec}.h",))


def _read(file: Path) -> bytes:
    try:
        with open_regular(file) as stream:
            content = stream.read(LARGEST_BYTES + 1)
    except OSError as error:
        raise NrsDesignError(f"cannot be read ({error.strerror})", path=file) from error
    if len(content) > LARGEST_BYTES:
        raise NrsDesignError("is larger than any export", path=file, remedy="export it again")
    return content


def _text(file: Path) -> str:
    try:
        return _read(file).decode("utf-8" if file.suffix == ".json" else "ascii")
    except UnicodeDecodeError as error:
        raise NrsDesignError(
            "is not the text that was exported", path=file, remedy="export it again"
        ) from error


def _of_record(
    text: str, spec: InteractionDesignSpec, certificate: Certificate, file: Path
) -> Iterator[str]:
    from pydantic import ValidationError

    try:
        record = ExportRecord.model_validate_json(text)
    except ValidationError as error:
        raise NrsDesignError(
            "is not an export record, or its numbers disagree with each other",
            path=file,
            remedy="export it again with --format json",
        ) from error
    proved = _record(spec, certificate)
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

"""Plant, loops, modes and certificate as a MAT-file (level 5), for MATLAB, GNU Octave and SciPy.

Numbers are the doubles next to the exact ones. What decides is the exact certificate, which is in
the file as text: `nrs-design verify` checks it.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.io

from nrs_design.certificates.certificate import Certificate, dump
from nrs_design.exporters.export import Export
from nrs_design.exporters.record import ExportRecord, header_lines
from nrs_design.output import MAT
from nrs_design.pipeline.design import run_linear_parts, run_open_loops
from nrs_design.proof.bounds import lower_float, upper_float
from nrs_design.proof.mode import Mode, Time

if TYPE_CHECKING:
    from nrs_design.design.linear_parts import LinearPart, OpenLoop
from nrs_design.exporters import DESIGN, Format

FORMAT = Format(
    "plant, controllers, loops, modes and certificate for MATLAB, GNU Octave and SciPy",
    DESIGN,
    {".mat": MAT},
)
# The text at the beginning of a MAT-file; SciPy writes the time and the system into it.
_TEXT_BYTES = 116
# Names that may be fields of a structure.
_FIELD = re.compile("[A-Za-z][A-Za-z0-9_]*")
_PART = ("name", *"ABCD", "input", "input_unit", "outputs", "output_units")
_MARGINS = ("sensitivity_peak", "gain_margin", "phase_margin", "delay_margin", "disk_margin")
_OPEN = ("controller", "at", *"ABCD", "sample_time", "stable", *_MARGINS)
# Matrices of a statement that are numerators over two to the power `denominator_log2`.
_FORMS = frozenset({"form", "Q", "low", "high"})
_RATIO = re.compile("-?[0-9]+(/[0-9]+)?")


def render(export: Export) -> dict[str, bytes]:
    """Return the file of an export, by its ending."""
    record, certificate = export.shipped(), export.certificate
    assert certificate is not None, "what is proved has a certificate"
    assert export.designed is not None, "it was designed"
    parts = run_linear_parts(export.designed)
    variables = {
        "info": _info(record, certificate),
        "plant": _parts((parts.actuator, parts.motion_loop)),
        "controllers": _parts(parts.controllers),
        "force_filter": _parts(() if parts.force_filter is None else (parts.force_filter,)),
        "contacts": _parts(parts.contacts),
        "open_loops": _structs([_open(loop) for loop in run_open_loops(export.designed)], _OPEN),
        "states": _cells(certificate.system.states),
        "modes": _modes(certificate.system.modes),
        "free_modes": _modes(certificate.system.contact.free if certificate.system.contact else ()),
        "gains": _gains(record),
        "statements": _cells(
            {
                "kind": item.kind,
                "claim": item.claim(certificate.system),
                "numbers": _value(item.to_fields()),
            }
            for item in certificate.statements
        ),
        "certificate_json": dump(certificate),
    }
    # A file-like object is as good as a path, whatever the type information says.
    file: Any = io.BytesIO()
    scipy.io.savemat(file, variables, long_field_names=True, oned_as="column")
    text = (MAT + record.spec.name.encode()).ljust(_TEXT_BYTES)
    return {".mat": text + file.getvalue()[_TEXT_BYTES:]}


def _parts(parts: Iterable[LinearPart]) -> Any:
    rows = [
        {
            "name": part.name,
            **{key: getattr(part, key) for key in "ABCD"},
            "input": part.input[0],
            "input_unit": part.input[1],
            "outputs": _cells(name for name, _ in part.outputs),
            "output_units": _cells(unit for _, unit in part.outputs),
        }
        for part in parts
    ]
    return _structs(rows, _PART)


def _open(loop: OpenLoop) -> dict[str, Any]:
    """Return a loop that was cut, with its margins in SI; a sample time of zero is continuous."""
    margins = {name: float(getattr(loop.loops, name)()[0]) for name in _MARGINS}
    return {
        "controller": loop.controller,
        "at": loop.at,
        **{key: getattr(loop, key) for key in "ABC"},
        "D": np.zeros((1, 1)),
        "sample_time": loop.loops.period or 0.0,
        "stable": bool(loop.loops.stable[0]),
        **margins,
    }


def _info(record: ExportRecord, certificate: Certificate) -> dict[str, Any]:
    proof, system = record.proof, certificate.system
    assert proof is not None, "only what is proved has a certificate of it"
    period, safe = system.sample_time, upper_float
    if system.time is Time.CONTINUOUS:
        safe = lower_float
    return {
        "header": _cells(header_lines(record)),
        "spec": record.spec.name,
        "spec_sha256": record.spec.sha256,
        "certificate": proof.certificate_id,
        "verdict": record.verdict,
        "claim": proof.claim,
        "time": str(system.time),
        # A double that is proved, too: no faster than the exact rate.
        "rate": safe(Fraction(proof.decay_rate.exact)),
        "rate_unit": proof.decay_rate.unit,
        "sample_time": np.empty((0, 0)) if period is None else float(period),
        "assumptions": _cells(proof.assumptions),
        "outside": _cells(record.outside),
    }


def _modes(modes: Iterable[Mode]) -> Any:
    rows = [{"name": mode.name, "A": np.array(mode.A.floats())} for mode in modes]
    return _structs(rows, ("name", "A"))


def _gains(record: ExportRecord) -> Any:
    """Return every gain: a single-precision number is a double, too."""
    gains = [("motion", gain) for gain in record.motion.gains]
    gains += [(item.name, gain) for item in record.controllers for gain in item.gains]
    rows = [
        {"controller": name, "name": gain.name, "unit": gain.unit, "value": gain.float32}
        for name, gain in gains
    ]
    return _structs(rows, ("controller", "name", "unit", "value"))


def _structs(rows: list[dict[str, Any]], fields: tuple[str, ...]) -> Any:
    """Return a structure array, of one column."""
    found = np.empty((len(rows), 1), dtype=[(name, object) for name in fields])
    for index, row in enumerate(rows):
        found[index, 0] = tuple(row[name] for name in fields)
    return found


def _cells(items: Iterable[Any]) -> Any:
    """Return a cell array, of one column."""
    values = list(items)
    found = np.empty((len(values), 1), dtype=object)
    for index, value in enumerate(values):
        found[index, 0] = value
    return found


def _value(value: Any, log2: int = 0) -> Any:
    """Return a field of a certificate as MATLAB has it, forms over two to a power."""
    match value:
        case Mapping():
            log2 = value.get("denominator_log2", log2)
            return {
                name: _form(item, log2) if name in _FORMS else _value(item, log2)
                for name, item in value.items()
                if _FIELD.fullmatch(name)
            }
        case list() | tuple():
            return _cells(_value(item, log2) for item in value)
        case str() if not _RATIO.fullmatch(value):
            return value
        case str() | int():
            try:
                return float(Fraction(value))
            except OverflowError:
                # The number is larger than any double: keep its digits as text.
                return str(Fraction(value))
        case _:
            return value


def _form(rows: list[list[int]], log2: int) -> Any:
    return np.array([[float(Fraction(entry, 2**log2)) for entry in row] for row in rows])

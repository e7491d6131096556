"""Whether numbers that were deployed are those of a certificate, bit for bit.

An exported header is read as a compiler reads it, as far as its numbers go: comments say nothing.
An export record is read as JSON. Code is not compared: that is what the vectors are for.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from fractions import Fraction
from pathlib import Path

from nrs_design.certificates.certificate import Certificate
from nrs_design.controllers.float32 import exact_decimal, to_float32
from nrs_design.controllers.gains import design_from_gains, idle_decay
from nrs_design.controllers.shipped import shipped_law
from nrs_design.errors import DesignError, NrsDesignError
from nrs_design.exporters.c_names import CNames
from nrs_design.exporters.record import ExportRecord
from nrs_design.files import open_regular
from nrs_design.proof.text import exact_text
from nrs_design.spec import InteractionDesignSpec

LARGEST_BYTES = 2**22
# Comments, and the strings that could hide where one begins.
_TOKEN = re.compile(
    r"""/\*.*?(?:\*/|\Z)|//[^\n]*|"(?:\\.|[^"\\\n])*"?|'(?:\\.|[^'\\\n])*'?""", re.DOTALL
)
# Lines that go on or end otherwise, and other ways to write a # or a backslash.
_STRANGE = re.compile(r"\\\n|\?\?|%:|[\x00-\x08\x0b-\x1f\x7f]")
_DEFINE = re.compile(r"define\s+([A-Za-z_]\w*)(?:\s+(.*))?", re.ASCII)
_MODE = re.compile(r"(0|[1-9]\d{0,8})U", re.ASCII)
_HEX = re.compile(r"0[xX]([0-9a-fA-F]{1,16})(?:\.([0-9a-fA-F]{0,16}))?[pP]([+-]?\d{1,4})[fF]")
_DECIMAL = re.compile(
    r"(\d{1,60}\.\d{0,160}|\.\d{1,160}|\d{1,60}(?=[eE]))(?:[eE]([+-]?\d{1,3}))?[fF]", re.ASCII
)


def find_differences(
    file: Path, spec: InteractionDesignSpec, certificate: Certificate
) -> list[str]:
    """Return in what a deployed file differs from a certificate; nothing if in nothing.

    Parameters
    ----------
    file : Path
        An exported header (``.h``) or export record (``.json``).
    spec : InteractionDesignSpec
        That of the certificate.
    certificate : Certificate
        Accepted, and about this spec.

    Raises
    ------
    NrsDesignError
        If the file cannot be read as one of these, or the certificate says nothing about it.
    """
    if file.suffix == ".h":
        return [*_of_header(_read(file), spec, certificate, file)]
    if file.suffix == ".json":
        return [*_of_record(_read(file), spec, certificate, file)]
    raise NrsDesignError(
        "is neither an exported header nor an export record",
        path=file,
        remedy="name the .h of `export --format c`, or the .json of `export --format json`",
    )


def _read(file: Path) -> str:
    try:
        with open_regular(file) as stream:
            content = stream.read(LARGEST_BYTES + 1)
        text = content.decode("ascii" if file.suffix == ".h" else "utf-8")
    except OSError as error:
        raise NrsDesignError(f"cannot be read ({error.strerror})", path=file) from error
    except UnicodeDecodeError as error:
        raise NrsDesignError(
            "is not the text that was exported", path=file, remedy="export it again"
        ) from error
    if len(content) > LARGEST_BYTES:
        raise NrsDesignError("is larger than any export", path=file, remedy="export it again")
    return text


def _of_header(
    text: str, spec: InteractionDesignSpec, certificate: Certificate, file: Path
) -> Iterator[str]:
    period = certificate.system.sample_time
    if period is None:
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
    law = shipped_law(spec, design_from_gains(spec, certificate.gains), period)
    names = CNames(spec.name)
    wanted = names.numbers(law)
    macros, faults = _macros(text, f"{names.upper}_H")
    yield from faults
    for name in macros.keys() - wanted.keys():
        yield f"{name} is not a number of this law"
    for name, number in wanted.items():
        if name not in macros:
            yield f"{name} is missing"
        elif (found := _number(macros[name])) != (number, False) or not _same_type(found, number):
            yield f"{name} is {macros[name][:80]}, and the certificate has {_text(number)}"


def _macros(text: str, guard: str) -> tuple[Mapping[str, str], list[str]]:
    """Return the macros of a header, and what else in it could change a number."""
    faults: list[str] = []
    text = text.replace("\r\n", "\n")
    if _STRANGE.search(text) or any(t[0] in "\"'" for t in _TOKEN.findall(text)):
        faults.append("it has strings or characters that no export has")
    lines = [line.strip() for line in _TOKEN.sub(" ", text).splitlines()]
    directives = [line[1:].strip() for line in lines if line.startswith("#")]
    faults += [f"#{d[:80]} is not in an export" for d in directives if not _usual(d, guard)]
    if [d.split()[0] for d in directives if _conditional(d)] != ["ifndef", "endif"]:
        faults.append("a part of it may not be compiled")
    found: dict[str, str] = {}
    for match in filter(None, map(_DEFINE.fullmatch, directives)):
        if match[1] in found:
            faults.append(f"{match[1]} is defined twice")
        found[match[1]] = (match[2] or "").strip()
    if found.pop(guard, None) != "":
        faults.append(f"the guard {guard} is missing")
    return found, faults


def _conditional(directive: str) -> bool:
    return bool(re.match(r"(if|el|endif)", directive))


def _usual(directive: str, guard: str) -> bool:
    includes = ("include <stdbool.h>", "include <stdint.h>")
    frame = (f"ifndef {guard}", "endif", *includes)
    return directive in frame or _DEFINE.fullmatch(directive) is not None


def _number(text: str) -> tuple[int | Fraction, bool] | None:
    """Return what a compiler takes a literal for, and whether as -0; None if it is unknown."""
    if match := _MODE.fullmatch(text):
        return int(match[1]), False
    inner = text[1:-1].strip() if text.startswith("(") and text.endswith(")") else text
    negative, digits = inner.startswith("-"), inner.removeprefix("-").strip()
    if match := _HEX.fullmatch(digits):
        after = match[2] or ""
        size = Fraction(int(match[1] + after, 16)) * Fraction(2) ** (int(match[3]) - 4 * len(after))
    elif match := _DECIMAL.fullmatch(digits):
        size = Fraction(match[1] + "0" * match[1].endswith(".")) * Fraction(10) ** int(
            match[2] or 0
        )
    else:
        return None
    try:
        held = to_float32(size)
    except DesignError:
        return None
    return (-held if negative else held), negative and not held


def _same_type(found: tuple[int | Fraction, bool] | None, number: int | Fraction) -> bool:
    """Tell whether both are integers or neither: 3000U is not 3000.0F in an expression."""
    return found is not None and isinstance(found[0], int) == isinstance(number, int)


def _text(number: int | Fraction) -> str:
    return f"{number}U" if isinstance(number, int) else exact_decimal(number)


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
    if record.spec.sha256 != certificate.spec_sha256:
        yield "it is of another spec, or of an earlier text of it"
    parts = [("motion", record.motion.gains), *((c.name, c.gains) for c in record.controllers)]
    names = [(name, gain.name) for name, gains in parts for gain in gains]
    if len({*names}) < len(names) or len({name for name, _ in parts}) < len(parts):
        yield "a controller or a gain is there twice"
    held = {name: {gain.name: gain.exact for gain in gains} for name, gains in parts}
    for name in sorted(held.keys() | certificate.gains.keys()):
        mine, proved = held.get(name, {}), dict(certificate.gains.get(name, {}))
        for gain in sorted(mine.keys() | proved.keys()):
            if mine.get(gain) != proved.get(gain):
                has = proved.get(gain, "no such gain")
                found = mine.get(gain, "missing")
                yield f"{gain} of {name} is {found}, and the certificate has {has}"
    proved_rest = _rest_of_design(spec, certificate)
    for name, found in _rest_of_record(record).items():
        if found != proved_rest[name]:
            yield f"{name}: {found}, and the certificate has {proved_rest[name]}"


def _rest_of_record(record: ExportRecord) -> dict[str, str]:
    """Return what runs beside the gains, in words."""
    low_pass, idle, period = record.force_filter, record.idle_states, record.sample_time
    return {
        "lags of the filter and their pole": f"{low_pass.order}, {low_pass.pole.exact}"
        if low_pass
        else "none",
        "decay and reset of idle states": f"{idle.decay.exact}, {idle.reset}" if idle else "none",
        "offset": record.offset or "none",
        "sample time in s": period.exact if period else "none",
    }


def _rest_of_design(spec: InteractionDesignSpec, certificate: Certificate) -> dict[str, str]:
    """Return the same of the design that the certificate is about."""
    low_pass = design_from_gains(spec, certificate.gains).sensor.filter
    idle, period = spec.idle_states, certificate.system.sample_time
    return {
        "lags of the filter and their pole": f"{low_pass.order}, {exact_decimal(low_pass.pole)}"
        if low_pass
        else "none",
        "decay and reset of idle states": f"{exact_decimal(idle_decay(idle))}, {idle.reset}"
        if idle
        else "none",
        "offset": spec.offset,
        "sample time in s": exact_text(period) if period else "none",
    }

"""Which command is asked of which spec, what is kept of its answer, and what agrees with it."""

import hashlib
import json
import math
import re
import shlex
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from scipy.io import loadmat

from tests.support import ROOT, run

ANSWERS = Path(__file__).with_name("answers")
# Rates and bounds are found by a search, whose last digits a processor decides.
TOLERANCE = 1e-5
NUMBER = re.compile(r"(\d+(?:\.\d+)?(?:e[+-]?\d+)?)")
# What says where and when, or is known by another name.
LEFT_OUT = re.compile(
    "path|line|column|remedy|(spec_)?sha256|certificate(_id|_json)?|attempts|seconds|(lines_)?work|"
    "decay_rate_exact|files|package|together|robot|binary|parallel|starts|seed|coordinates|taus"
)
FORMATS = ("json", "c", "cmake", "monitor", "fmu", "mat", "coq")
OF_SPECS = ("check", "tune", "certify-switching", "simulate", "optimize")
ROBOT = "specs/robots/neuroboscope.nrs.yaml"
OTHERS = (
    f"robot check {ROBOT}",
    f"robot kinematics {ROBOT} --pose 0.1,-0.2,0.2",
    f"robot dynamics {ROBOT} --pose 0,0,0.2",
    f"robot balance {ROBOT}",
    f"robot correction {ROBOT}",
    "reproduce",
    "ros2 check docs/examples/admittance.ros2.yaml --stiffness '200..2000 N/m'",
    "mode-logic docs/examples/insertion-by-sign.nrs.yaml",
    "mode-logic docs/examples/force-by-threshold.nrs.yaml",
    "identify tissue specs/data/silicone-soft-1.csv --lever-arm '0.24 m'",
    "identify actuator specs/data/actuator-1p2hz.csv",
)


def specs() -> dict[str, Path]:
    folders = ("specs/examples", "specs/neuroboscope", "docs/examples")
    paths = [path for folder in folders for path in sorted((ROOT / folder).glob("*.nrs.yaml"))]
    return {path.name.removesuffix(".nrs.yaml"): path for path in paths}


def rows() -> Iterator[tuple[str, str]]:
    """Yield the name of each file of answers with each command in it."""
    for name in specs():
        yield from ((name, command) for command in OF_SPECS)
        if certificate_of(name).is_file():
            yield name, "verify"
            yield from ((name, f"export {format_}") for format_ in FORMATS)
    yield from (("others", name) for name in OTHERS)


def certificate_of(name: str) -> Path:
    return ROOT / "reports" / f"{name}.cert.json"


def answer(name: str, command: str, folder: Path) -> Any:
    """Return what is kept of the answer of a command, with its exit code."""
    if name == "others":
        words = shlex.split(command)
        return asked(*(ROOT / w if (ROOT / w).is_file() else w for w in words), folder=folder)
    path = specs()[name]
    if command == "verify":
        return asked("verify", certificate_of(name), path, folder=folder)
    if command.startswith("export "):
        format_ = command.removeprefix("export ")
        certificate = ("--certificate", certificate_of(name), "--out", folder / "out")
        done = asked("export", path, "--format", format_, *certificate, folder=folder)
        files = sorted((folder / "out").rglob("*"))
        # What was not refused says what the file of the format json holds.
        said = {key: done[key] for key in ("exit", "rule", "faults") if key in done}
        return said | {"files": {file.name: kept_of(file) for file in files if file.is_file()}}
    return asked(command, path, folder=folder)


def asked(*arguments: str | Path, folder: Path) -> dict[str, Any]:
    done = run(*arguments, "--json", cwd=folder)
    said = done.stdout.replace(f"{ROOT}/", "").replace(f"{folder}/", "")
    return {"exit": done.returncode, **without(json.loads(said))}


def without(value: Any) -> Any:
    """Leave out what an answer is not held to, at any depth."""
    if isinstance(value, dict) and [*value] == ["name", "written", "si", "unit"]:
        return "{name}: {written} = {si} {unit}".format(**value)
    if isinstance(value, dict):
        return {key: without(item) for key, item in value.items() if not LEFT_OUT.fullmatch(key)}
    if isinstance(value, list):
        kept = [without(item) for item in value]
        return [item for item in kept if not str(item).startswith("coordinates: ")]
    return value


def kept_of(file: Path) -> Any:
    """Return a file that is a document without what is left out, or the SHA-256 of another."""
    if file.name.endswith(".export.json"):
        document = without(json.loads(file.read_text(encoding="utf-8")))
        # Those of the certificate, to the last letter.
        document["proof"]["assumptions"] = digest(repr(document["proof"]["assumptions"]))
        return document
    if file.suffix == ".fmu":
        with zipfile.ZipFile(file) as archive:
            names = [name for name in archive.namelist() if not name.startswith("binaries/")]
            return {name: digest(archive.read(name).decode("utf-8")) for name in sorted(names)}
    if file.suffix == ".mat":
        found = loadmat(file, simplify_cells=True)
        return {
            key: digest(repr(without(plain(found[key])))) for key in sorted(found) if key[0] != "_"
        }
    text = file.read_text(encoding="utf-8")
    return digest(json.dumps(without(json.loads(text))) if file.suffix == ".json" else text)


def plain(value: Any) -> Any:
    """Return a document of MATLAB as one of plain dictionaries, lists, texts and numbers."""
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items() if key != "axes"}
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    return [plain(item) for item in value] if isinstance(value, list) else value


def digest(text: str) -> str:
    """Return the SHA-256 of a text without names by hashes and the number of the release."""
    text = re.sub(r"\b[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}\b", "UUID", text)
    text = re.sub(r"\b[0-9a-f]{64}\b", "HASH", text)
    text = re.sub(r"(nrs-design[ \w\"=:]*?)\d+\.\d+\.\d+\w*", r"\1VERSION", text)
    return hashlib.sha256(text.encode()).hexdigest()


def differences(
    old: Any, new: Any, at: str = "", rates: tuple[float, float] = (0, 0)
) -> Iterator[str]:
    """Yield where an answer is another one; a proved rate may be larger, with what states it.

    That a bound is proved now, where none was, is no difference.
    """
    if isinstance(old, dict) and isinstance(new, dict):
        before, now = old.get("decay_rate"), new.get("decay_rate")
        if isinstance(before, float) and isinstance(now, float):
            better = now > before if old.get("time") == "continuous" else now < before
            rates = (before, now) if better else (0, 0)
        for key in {**old, **new}:
            if key not in old or key not in new:
                yield f"{at}.{key}: only {'before' if key in old else 'now'}"
            else:
                yield from differences(old[key], new[key], f"{at}.{key}", rates)
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for i, (before, now) in enumerate(zip(old, new, strict=True)):
            yield from differences(before, now, f"{at}[{i}]", rates)
    elif at.endswith(".proved") and old is None and isinstance(new, float):
        return
    elif not agrees(old, new, exact=".gains" in at, rates=rates):
        yield f"{at}: {old!r} before, {new!r} now"


def agrees(old: Any, new: Any, exact: bool, rates: tuple[float, float]) -> bool:
    if old == new or exact or type(old) is not type(new):
        return bool(old == new)
    if isinstance(old, float):
        return close(old, new) or (close(old, rates[0]) and close(new, rates[1]))
    if isinstance(old, str) and not re.fullmatch(r"[0-9a-f]{64}", old):
        before, now = NUMBER.split(old), NUMBER.split(new)
        return before[::2] == now[::2] and all(
            agrees(float(a), float(b), exact=False, rates=rates)
            for a, b in zip(before[1::2], now[1::2], strict=True)
        )
    return False


def close(one: float, other: float) -> bool:
    return math.isclose(one, other, rel_tol=TOLERANCE, abs_tol=1e-9)

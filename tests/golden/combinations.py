"""Features of interaction designs together: refused with which words, or which system they make.

The changes that give a plain spec each feature are stored beside the outcomes, so that they stay
what they are. A feature that leaves the program is to be refused ever after.
"""

import hashlib
import json
import re
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

from nrs_design.errors import AssemblyError, SpecError
from nrs_design.pipeline.certification import assemble_spec
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import read_spec
from tests.golden.answers import ANSWERS
from tests.spec.test_combinations import merged, slid

FILE = ANSWERS / "combinations.json"
REFUSED = "refused"
# What tells one from others that go.
LOST_WORDS = re.compile(r",? in deflection coordinates|(?<=load of the motor) of one axis")


@cache
def stored() -> dict[str, Any]:
    return json.loads(FILE.read_text(encoding="utf-8"))


def subjects() -> list[str]:
    return [*stored()["outcomes"]]


def outcomes(subject: str) -> dict[str, list[str]]:
    """Return the sets of features that begin with one, by what they come to."""
    found: dict[str, list[str]] = {}
    for together in sorted({t for known in stored()["outcomes"][subject].values() for t in known}):
        found.setdefault(outcome(together.split(" + ")), []).append(together)
    return dict(sorted(found.items()))


def outcome(features: list[str]) -> str:
    """Return the message of a refusal, or what names the exact system."""
    leaves = set(stored()["leaves"]) & set(features)
    spec = stored()["base"]
    for name, changes in stored()["changes"].items():
        if name in features:
            spec = merged(spec, changes)
    text = json.dumps(slid(spec) if "SLIDING" in features else spec, indent=1)
    try:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "combined.nrs.yaml")
            path.write_text(text, encoding="utf-8")
            loaded = read_spec(path)
        designed = run_design(loaded)
        system = assemble_spec(loaded, designed)
    except SpecError as error:
        said = " | ".join(sorted({fault.message for fault in error.faults}))
    except AssemblyError as error:
        said = f"not assembled: {error}"
    else:
        exact = (*system.every_mode, system.switching, system.sample_time, system.channels)
        text = repr((exact, system.outputs, system.roundings))
        return f"{len(system.modes)} modes, {hashlib.sha256(text.encode()).hexdigest()[:16]}"
    # Words that named a part which goes: whatever is said, it is refused.
    return REFUSED if leaves else LOST_WORDS.sub("", said)


def rewrite() -> None:
    found = stored() | {"outcomes": {subject: outcomes(subject) for subject in subjects()}}
    FILE.write_text(f"{json.dumps(found, indent=1)}\n", encoding="utf-8")

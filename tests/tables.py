"""Tables that tests read, as YAML, and the specs of which their cases are edits.

A spec is named by its file in `tests/specs`, or by a path from the root. An edit is a list of what
is replaced and what stands there instead, once or several times.
"""

from functools import cache
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML

from tests.support import ROOT, replaced


@cache
def table(path: Path) -> Any:
    return YAML(typ="safe").load(path.read_text(encoding="utf-8"))


@cache
def spec_text(name: str) -> str:
    path = ROOT / (name if "/" in name else f"tests/specs/{name}.yaml")
    return path.read_text(encoding="utf-8")


def edited(text: str, edit: list[str]) -> str:
    return replaced(text, *zip(edit[::2], edit[1::2], strict=True))

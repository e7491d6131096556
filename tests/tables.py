"""Tables that tests read, as YAML, and the specs of which their cases are edits.

A spec is named by its file in `tests/specs`, or by a path from the root. An edit is a list of what
is replaced and what stands there instead, once or several times.
"""

import shlex
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest
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


def cases_of(path: Path, key: str) -> list[Any]:
    """Return the cases of all groups of a kind, each with what its group says."""
    return [
        pytest.param({**group, **case}, id=f"{path.stem}-{first}-{number}")
        for first, group in enumerate(table(path))
        if key in group
        for number, case in enumerate(group["cases"])
    ]


def edit_of(case: dict[str, Any]) -> list[str]:
    """Return what a case replaces, and by what."""
    if "replace" in case:
        return [case["replace"], case["by"]]
    if "before" in case:
        return [case["before"], f"{case['add']}\n{case['before']}"]
    if "after" in case:
        return [case["after"], f"{case['after']}{case['add']}\n"]
    return list(case["edit"])


def words_of(case: dict[str, Any]) -> list[str]:
    return [case["says"]] if isinstance(case["says"], str) else list(case["says"])


def content(said: str | dict[str, Any]) -> str:
    """Return the text of a file: as it stands, or a spec that is edited, cut and has more lines."""
    if isinstance(said, str):
        return said
    text = edited(spec_text(said["base"]), said.get("edit", []))
    return text.partition(said["cut"])[0] if "cut" in said else text + said.get("more", "")


def write_files(files: dict[str, Any], folder: Path) -> None:
    for name, said in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(content(said), encoding="utf-8")


def words_in(line: str) -> list[str | Path]:
    """Return the words of a command line; those that begin with ``@`` are paths from the root."""
    return [ROOT / word[1:] if word.startswith("@") else word for word in shlex.split(line)]


def files_in(folder: Path) -> list[str]:
    there = (path for path in folder.rglob("*") if path.is_file())
    return sorted(str(path.relative_to(folder)) for path in there)


def entry(file: str, name: str) -> Any:
    """Return what the table beside a test's file holds under a name."""
    return table(Path(file).with_suffix(".yaml"))[name]


def rows(file: str, name: str) -> list[Any]:
    """Return the rows of a test, from the table beside its file."""
    return list(entry(file, name))


def by_rows(*names: str, **kinds: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """Run a test once for each row of its name, in the table beside its file.

    What has a kind is made by it, unless it is null.
    """

    def value(name: str, said: Any) -> Any:
        return said if said is None or name not in kinds else kinds[name](said)

    def run(test: Any) -> Any:
        found = rows(test.__code__.co_filename, test.__name__)
        if len(names) == 1:
            return pytest.mark.parametrize(names, [(value(names[0], said),) for said in found])(
                test
            )
        made = [tuple(map(value, names, row)) for row in found]
        return pytest.mark.parametrize(names, made)(test)

    return run

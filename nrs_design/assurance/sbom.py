"""A parts list (SBOM) of this program and its libraries, as CycloneDX 1.5 in JSON.

Written by hand: the format asks for a dozen fields of what `importlib.metadata` knows, and a
library for it would be a part more than it lists.
"""

from __future__ import annotations

import platform
import re
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import PackageMetadata, PackageNotFoundError, distribution
from typing import Any

from nrs_design.errors import NrsDesignError

TOOL = "nrs-design"
_LICENSE = "License :: OSI Approved :: "
_SEPARATORS = re.compile(r"[-_.]+")
# An identifier of SPDX or several, as PEP 639 writes them.
_EXPRESSION = re.compile(r"[A-Za-z0-9.+() -]+")


@dataclass(frozen=True, slots=True)
class InstalledPart:
    """One installed package."""

    name: str  # As it names itself
    version: str
    needs: tuple[str, ...]  # Normalized names of what it needs here, without its extras
    licenses: tuple[dict[str, Any], ...]  # As the format writes them

    @property
    def purl(self) -> str:
        """The address of the package, which names it in the document, too."""
        return f"pkg:pypi/{_plain(self.name)}@{self.version}"


def parts_list() -> dict[str, Any]:
    """Return the document: what is installed here, with versions, licenses and who needs whom.

    Native libraries inside of a wheel are parts of that wheel, and not listed.

    Raises
    ------
    NrsDesignError
        If this program runs without being installed, so that nothing says what it needs.
    """
    parts = installed_parts()
    own, others = parts[TOOL], [parts[name] for name in sorted(parts.keys() - {TOOL})]
    python = _python()
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {"component": _component(own, "application")},
        "components": [*(_component(part, "library") for part in others), python],
        "dependencies": [
            {"ref": own.purl, "dependsOn": [*_needed(own, parts), python["bom-ref"]]},
            *({"ref": part.purl, "dependsOn": _needed(part, parts)} for part in others),
        ],
    }


def installed_parts() -> dict[str, InstalledPart]:
    """Return this program and every package that it needs, by normalized name.

    Raises
    ------
    NrsDesignError
        If one of them is not installed.
    """
    found: dict[str, InstalledPart] = {}
    waiting = [TOOL]
    while waiting:
        name = waiting.pop()
        if name not in found:
            found[name] = _part(name)
            waiting += found[name].needs
    return found


def _part(name: str) -> InstalledPart:
    # Loaded where it is used: no other command reads requirements.
    from packaging.requirements import Requirement

    try:
        about = distribution(name).metadata
    except PackageNotFoundError as error:
        raise NrsDesignError(
            f"{name} is not installed as a package, so its version and its parts are not known",
            remedy="install nrs-design with pip, and run it from there",
        ) from error
    wanted, here = map(Requirement, about.get_all("Requires-Dist") or ()), {"extra": ""}
    needs = {_plain(r.name) for r in wanted if r.marker is None or r.marker.evaluate(here)}
    return InstalledPart(
        about["Name"], about["Version"], tuple(sorted(needs)), tuple(_licenses(about))
    )


def _licenses(about: PackageMetadata) -> Iterator[dict[str, Any]]:
    """Yield one expression, or the names that the classifiers give; free text is no name."""
    (expression,) = about.get_all("License-Expression") or [""]
    if _EXPRESSION.fullmatch(expression):
        yield {"expression": expression}
        return
    for classifier in about.get_all("Classifier") or ():
        if classifier.startswith(_LICENSE):
            yield {"license": {"name": classifier.removeprefix(_LICENSE)}}


def _plain(name: str) -> str:
    return _SEPARATORS.sub("-", name).lower()


def _component(part: InstalledPart, type_: str) -> dict[str, Any]:
    found = {
        "type": type_,
        "bom-ref": part.purl,
        "name": part.name,
        "version": part.version,
        "purl": part.purl,
    }
    return found | ({"licenses": list(part.licenses)} if part.licenses else {})


def _python() -> dict[str, Any]:
    name, version = platform.python_implementation(), platform.python_version()
    return {"type": "platform", "bom-ref": f"{name}@{version}", "name": name, "version": version}


def _needed(part: InstalledPart, parts: dict[str, InstalledPart]) -> list[str]:
    return [parts[name].purl for name in part.needs]

"""A parts list (SBOM) of this program and its libraries, as CycloneDX 1.5 in JSON.

Written by hand: the format asks for a dozen fields of what `importlib.metadata` knows, and a
library for it would be a part more than it lists.
"""

from __future__ import annotations

import platform
import re
from collections.abc import Iterator
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from typing import Any

from nrs_design.errors import NrsDesignError

TOOL = "nrs-design"
_LICENSE = "License :: OSI Approved :: "
_SEPARATORS = re.compile(r"[-_.]+")
# An identifier of SPDX or several, as PEP 639 writes them.
_EXPRESSION = re.compile(r"[A-Za-z0-9.+() -]+")


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
        "dependencies": [*_dependencies(parts, python["bom-ref"])],
    }


def installed_parts() -> dict[str, Distribution]:
    """Return this program and every package that it needs, by normalized name.

    Raises
    ------
    NrsDesignError
        If one of them is not installed.
    """
    found: dict[str, Distribution] = {}
    waiting = [TOOL]
    while waiting:
        name = waiting.pop()
        if name not in found:
            found[name] = _distribution(name)
            waiting += needs(found[name])
    return found


def needs(part: Distribution) -> list[str]:
    """Return the normalized names of what a package needs here, without its extras."""
    # Loaded where it is used: no other command reads requirements.
    from packaging.requirements import Requirement

    wanted = map(Requirement, part.requires or ())
    here = {"extra": ""}
    return sorted({_plain(r.name) for r in wanted if r.marker is None or r.marker.evaluate(here)})


def _distribution(name: str) -> Distribution:
    try:
        return distribution(name)
    except PackageNotFoundError as error:
        raise NrsDesignError(
            f"{name} is not installed as a package, so its version and its parts are not known",
            remedy="install nrs-design with pip, and run it from there",
        ) from error


def _plain(name: str) -> str:
    return _SEPARATORS.sub("-", name).lower()


def _component(part: Distribution, type_: str) -> dict[str, Any]:
    name, version = part.metadata["Name"], part.version
    purl = f"pkg:pypi/{_plain(name)}@{version}"
    found = {"type": type_, "bom-ref": purl, "name": name, "version": version, "purl": purl}
    licenses = [*_licenses(part)]
    return found | ({"licenses": licenses} if licenses else {})


def _licenses(part: Distribution) -> Iterator[dict[str, Any]]:
    """Yield one expression, or the names that the classifiers give; free text is no name."""
    expression = part.metadata.get("License-Expression")
    if expression and _EXPRESSION.fullmatch(expression):
        yield {"expression": expression}
        return
    for classifier in part.metadata.get_all("Classifier") or ():
        if classifier.startswith(_LICENSE):
            yield {"license": {"name": classifier.removeprefix(_LICENSE)}}


def _python() -> dict[str, Any]:
    name, version = platform.python_implementation(), platform.python_version()
    return {"type": "platform", "bom-ref": f"{name}@{version}", "name": name, "version": version}


def _dependencies(parts: dict[str, Distribution], python: str) -> Iterator[dict[str, Any]]:
    refs = {name: f"pkg:pypi/{name}@{part.version}" for name, part in parts.items()}
    for name in sorted(parts, key=lambda name: (name != TOOL, name)):
        needed = [refs[other] for other in needs(parts[name])]
        yield {"ref": refs[name], "dependsOn": [*needed, python] if name == TOOL else needed}

"""Recorded commands of scenarios: the hash of a spec covers only their names."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from contextlib import suppress

from nrs_design.files import open_regular
from nrs_design.spec import InteractionDesignSpec, LoadedSpec
from nrs_design.spec.scenarios import ScenarioSpec


def hash_recorded(loaded: LoadedSpec) -> Mapping[str, str]:
    """Return the SHA-256 of every file that scenarios with limits follow, by its name in the spec.

    Files are below its folder; one that cannot be read is left out.
    """
    return _hashes(loaded, lambda scenario: scenario.limits is not None)


def hash_followed(loaded: LoadedSpec) -> Mapping[str, str]:
    """Return the SHA-256 of every file that any scenario follows; see `hash_recorded`."""
    return _hashes(loaded, lambda scenario: True)


def _hashes(loaded: LoadedSpec, counts: Callable[[ScenarioSpec], bool]) -> dict[str, str]:
    spec, found = loaded.spec, {}
    runs = spec.scenarios.values() if isinstance(spec, InteractionDesignSpec) else ()
    for name in sorted({run.command.csv for run in runs if run.command.csv and counts(run)}):
        with suppress(OSError), open_regular(loaded.path.parent / name) as stream:
            found[name] = hashlib.file_digest(stream, "sha256").hexdigest()
    return found

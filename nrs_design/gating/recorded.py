"""Recorded commands of scenarios: the hash of a spec covers only their names."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping

from nrs_design.files import open_regular
from nrs_design.spec import InteractionDesignSpec, LoadedSpec
from nrs_design.spec.scenarios import ScenarioSpec


def hash_recorded(loaded: LoadedSpec) -> Mapping[str, str]:
    """Return the SHA-256 of every file that scenarios with limits follow, by its name in the spec.

    Files are below its folder; one that cannot be read is left out.
    """
    return _hashes(loaded, recorded_files(loaded))


def hash_followed(loaded: LoadedSpec) -> Mapping[str, str]:
    """Return the SHA-256 of every file that any scenario follows; see `hash_recorded`."""
    if not isinstance(loaded.spec, InteractionDesignSpec):
        return {}
    return _hashes(loaded, _names(loaded.spec.scenarios.values()))


def _hashes(loaded: LoadedSpec, names: tuple[str, ...]) -> dict[str, str]:
    found = {}
    for name in names:
        digest = hashlib.sha256()
        try:
            with open_regular(loaded.path.parent / name) as stream:
                while block := stream.read(2**20):
                    digest.update(block)
        except OSError:
            continue
        found[name] = digest.hexdigest()
    return found


def recorded_files(loaded: LoadedSpec) -> tuple[str, ...]:
    """Return the names of these files, from the folder of the spec, sorted."""
    if not isinstance(loaded.spec, InteractionDesignSpec):
        return ()
    return _names(one for one in loaded.spec.scenarios.values() if one.limits is not None)


def _names(scenarios: Iterable[ScenarioSpec]) -> tuple[str, ...]:
    named = {one.command.csv for one in scenarios if one.command.csv is not None}
    return tuple(sorted(named))

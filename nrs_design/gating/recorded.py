"""Recorded commands of scenarios with limits: the hash of a spec covers only their names."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping

from nrs_design.files import open_regular
from nrs_design.spec import InteractionDesignSpec, LoadedSpec
from nrs_design.spec.scenarios import ScenarioSpec


def hash_recorded(loaded: LoadedSpec) -> Mapping[str, str]:
    """Return the SHA-256 of every such file, in hexadecimal, by its name in the spec.

    Parameters
    ----------
    loaded : LoadedSpec
        The spec; files are below its folder. One that cannot be read is left out.
    """
    found = {}
    for name in recorded_files(loaded):
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
    limited = (one for one in loaded.spec.scenarios.values() if one.limits is not None)
    return tuple(sorted({name for one in limited for name in _named(one)}))


def _named(scenario: ScenarioSpec) -> Iterator[str]:
    axes = () if scenario.axes is None else ("theta1", "theta2", "theta3")
    own = [getattr(scenario.axes, axis) for axis in axes]
    for command in (scenario.command, *(one.command for one in own if one is not None)):
        if command is not None and command.csv is not None:
            yield command.csv

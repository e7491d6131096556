"""Lines and columns of a spec to which obligations refer."""

from __future__ import annotations

from nrs_design.spec import LoadedSpec, SwitchedSystemSpec
from nrs_design.spec.document import Position, steps_to
from nrs_design.spec.edits import node_at


class SourcePositions:
    """Lines and columns of a spec."""

    def __init__(self, loaded: LoadedSpec) -> None:
        self._root = loaded.root
        spec = loaded.spec
        modes = spec.modes if isinstance(spec, SwitchedSystemSpec) else ()
        self._indices = {mode.name: index for index, mode in enumerate(modes)}

    def mode(self, name: str) -> Position:
        """Return the place of a given mode, or of the controller of an assembled mode."""
        # Labels have no slash: what follows it names the contact or the corner of a box.
        label = name.partition("/")[0]
        if label in self._indices:
            return self.at("modes", self._indices[label])
        return self.at("controllers", label)

    def goal(self, controller: str, key: str) -> Position:
        """Return the place of a goal of a controller: its own, or that of the whole spec."""
        own = ("controllers", controller, "goals", key)
        return self.at(*own) if node_at(self._root, own) is not None else self.at("goals", key)

    def at(self, *keys: str | int) -> Position:
        """Return the place of a key or item, or of what would hold it if it is not there."""
        places = [place for place, _ in steps_to(self._root, keys)]
        return places[-1] if places else self._root.position

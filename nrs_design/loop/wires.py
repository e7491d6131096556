"""Signals by name: each is a linear form of states, inputs and roundings, exactly."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction

from nrs_design.errors import AssemblyError
from nrs_design.models.linear_form import ONE, LinearForm, combine, coordinates, zero


class Wires:
    """The signals of a loop; blocks state rules, by which a signal is made when it is wanted."""

    def __init__(self, names: Sequence[str]) -> None:
        """Begin with the signals from which all others follow."""
        self.known: dict[str, LinearForm] = dict(zip(names, coordinates(len(names)), strict=True))
        self.nothing: LinearForm = zero(len(names))
        self._rules: dict[str, Callable[[], LinearForm]] = {}

    def rule(self, name: str, make: Callable[[], LinearForm]) -> None:
        """State how a signal is made."""
        self._rules[name] = make

    def set(self, signals: Mapping[str, LinearForm]) -> None:
        """Give signals that are there already."""
        self.known.update(signals)

    def has(self, name: str) -> bool:
        """Tell whether a signal is known, or has a rule."""
        return name in self.known or name in self._rules

    def __getitem__(self, name: str) -> LinearForm:
        """Return a signal; its rule makes it at the first request."""
        if name not in self.known:
            # The rule is removed first, so a signal that depends on itself finds no rule.
            make = self._rules.pop(name, None)
            if make is None:
                raise AssemblyError(
                    f"the signal {name} depends on itself at once, or nothing makes it"
                )
            self.known[name] = make()
        return self.known[name]

    def sum(self, *terms: tuple[Fraction, LinearForm]) -> LinearForm:
        """Return the sum of signals, each times its factor."""
        return combine((ONE, self.nothing), *(term for term in terms if term[0]))

"""The settings of the gradient iteration: a noun, which imports no numerical library."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields
from enum import StrEnum
from math import isfinite
from typing import Any, Self

from nrs_design.errors import DesignError
from nrs_design.named_values import read_named_values


class Coordinates(StrEnum):
    """States in which the iteration runs; the same function is found or missed, but not as fast."""

    MEAN_NORM = "mean-norm"
    BALANCED = "balanced"
    GIVEN = "given"


class Order(StrEnum):
    """How the next mode is taken."""

    ROUND_ROBIN = "round-robin"
    RANDOM = "random"


def _tell_nobody(updates: int, largest: float) -> None:
    """Take no note of how the iteration goes."""


@dataclass(frozen=True, slots=True)
class Gradient:
    """Settings of the iteration of Liberzon and Tempo (2004); thesis 5.21-5.28.

    A number out of its range is a `DesignError`.
    """

    relaxation: float = 1.0  # The alpha of 5.25, from 0 to 2
    radius: float = 1.0  # The r of 5.25, above 0: the shortest step, in the norm of Frobenius
    start: str | None = None  # The mode whose own Lyapunov equation gives the first Q
    order: Order = Order.ROUND_ROBIN  # Modes in turn, as 5.26 has it, or drawn at random
    seed: int = 0  # Of the random order
    max_updates: int = 20_000  # Updates after which the iteration gives up
    # ``mean-norm``, where the mean of the modes' own norms is round; ``balanced`` by powers of two;
    # ``given``, the states of the modes, as the thesis has it.
    coordinates: Coordinates = Coordinates.MEAN_NORM
    # Told updates and the largest v over all modes: at the start, after each of the first hundred
    # updates, then ever more rarely, and at the end. Each block of a family begins at zero.
    tell: Callable[[int, float], None] = _tell_nobody

    def __post_init__(self) -> None:
        """Refuse what the iteration is not defined for."""
        _require(0 <= self.relaxation <= 2, "relaxation", self.relaxation, "from 0 to 2")
        _require(self.radius > 0 and isfinite(self.radius), "radius", self.radius, "above 0")
        _require(self.seed >= 0, "seed", self.seed, "of at least 0")
        _require(self.max_updates >= 0, "limit of updates", self.max_updates, "of at least 0")
        _require(self.order in set(Order), "order", self.order, f"out of {', '.join(Order)}")
        known = ", ".join(Coordinates)
        _require(
            self.coordinates in set(Coordinates), "states", self.coordinates, f"out of {known}"
        )

    @classmethod
    def of_texts(cls, entries: Iterable[str]) -> Self:
        """Read settings, ``name=value`` each."""
        defaults = {field.name: field.default for field in fields(cls) if field.name != "tell"}
        readers = {name: _reader(default) for name, default in defaults.items()}
        return cls(**read_named_values(entries, readers, "the gradient iteration"))

    @property
    def is_told(self) -> bool:
        """Whether anybody listens to how the iteration goes."""
        return self.tell is not _tell_nobody


def _reader(default: Any) -> Callable[[str], Any]:
    def read(text: str) -> Any:
        try:
            return text if default is None else type(default)(text)
        except ValueError:
            raise ValueError(f"by default it is {default}") from None

    return read


def _require(holds: bool, name: str, value: object, wanted: str) -> None:
    if not holds:
        raise DesignError(
            f"the gradient iteration cannot run with {name} {value}", remedy=f"give one {wanted}"
        )

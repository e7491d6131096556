"""What is taken for granted: a sentence of a certificate, with what a reader needs to test it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Self


class Standing(StrEnum):
    """How well an assumption is supported."""

    TESTED = "tested"
    ARGUED = "argued"
    OPEN = "open"


@dataclass(frozen=True, slots=True)
class AssumptionKind:
    """What is common to the sentences that take one thing for granted."""

    name: str  # In a few words
    bound: str  # Within what it must hold, where the sentence has no numbers of its own
    breaks: str  # What no longer follows if it is false
    test: str  # How to test it on the robot
    # Argued from how the product is made, or open; that it was tested, a spec says.
    standing: Standing = Standing.OPEN

    def says(self, sentence: str, bound: str | None = None) -> Assumption:
        """Return an assumption of this kind.

        Parameters
        ----------
        sentence : str
            That a certificate holds.
        bound : str, optional
            Its numbers; by default what the kind says.
        """
        return Assumption(sentence, self, self.bound if bound is None else bound)


class Assumption(str):
    """The sentence that a certificate holds, which knows of what kind it is and its bound.

    A certificate keeps the sentence alone: what is read from one is a plain string.

    Parameters
    ----------
    sentence : str
        Word for word.
    kind : AssumptionKind
        What breaks if it is false, and how to test it.
    bound : str
        Within what it must hold.
    """

    __slots__ = ("bound", "kind")
    kind: AssumptionKind
    bound: str

    def __new__(cls, sentence: str, kind: AssumptionKind, bound: str) -> Self:
        """Attach kind and bound to a sentence."""
        made = super().__new__(cls, sentence)
        made.kind, made.bound = kind, bound
        return made

    def __reduce__(self) -> tuple[type[Self], tuple[str, AssumptionKind, str]]:
        """Return what a copy is made from."""
        return type(self), (str(self), self.kind, self.bound)

"""Theorems of Coq as text: definitions, numbers, lists, forms and names."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

from nrs_design.printable import printable
from nrs_design.proof.evidence.graph import FormsOnGraph
from nrs_design.proof.exact import IntegerMatrix, is_positive_definite
from nrs_design.proof.mode import Mode
from nrs_design.proof.system import SwitchedSystem

WIDTH = 100
# From this length on, Coq reads hexadecimal digits ten times as fast as a decimal.
SHORT_BITS = 30


@dataclass(slots=True)
class Definitions:
    """Definitions in order; equal ones have one name."""

    texts: list[str] = field(default_factory=list)
    names: dict[str, str] = field(default_factory=dict)

    def share(self, stem: str, text: str) -> str:
        """Return the name of a term, which is defined where it is new, with a name on this stem."""
        if text not in self.names:
            self.names[text] = self.define(f"{stem}{len(self.names) + 1}", text)
        return self.names[text]

    def define(self, name: str, text: str, remark: str = "") -> str:
        """Define a name, and return it."""
        comment = f"(* {in_comment(remark)} *)\n" if remark else ""
        self.texts.append(f"{comment}Definition {name} := {text}.\n")
        return name

    def row(self, entries: Sequence[int]) -> str:
        """Return the name of a list of integers."""
        return self.share("v", listed(map(str, entries)))


def listed(items: Iterable[str]) -> str:
    """Return a list of terms."""
    return f"[{'; '.join(items)}]"


def long_integer(number: int) -> str:
    """Return an integer in hexadecimal digits that Coq reads fast, the last one first."""
    if number.bit_length() <= SHORT_BITS:
        return str(number)
    digits = f"{abs(number):X}"
    top = "xH"
    for bit in f"{int(digits[0], 16):b}"[1:]:
        top = f"(x{'I' if bit == '1' else 'O'} {top})"
    for digit in digits[1:]:
        top = f"(h{digit} {top})"
    return f"({'Zneg' if number < 0 else 'Zpos'} {top})"


def symmetric(form: IntegerMatrix, integer: Callable[[int], str] = str) -> str:
    """Return a symmetric matrix: the entries of every row from the diagonal on."""
    rows = (
        f"({integer(row[i])}, {listed(map(integer, row[i + 1 :]))})" for i, row in enumerate(form)
    )
    return "[" + ";\n  ".join(rows) + "]"


def identifiers(names: Iterable[str]) -> dict[str, str]:
    """Return a name of Coq for each name of a mode; no two are the same."""
    found: dict[str, str] = {}
    for name in names:
        stem = "mode_" + re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
        values = set(found.values())
        count = next(k for k in range(1, len(values) + 2) if _numbered(stem, k) not in values)
        found[name] = _numbered(stem, count)
    return found


def in_comment(text: str) -> str:
    """Return a line that ends no comment and begins none, and no string either."""
    plain = printable(" ".join(text.split())).replace('"', "'")
    return plain.replace("(*", "( *").replace("*)", "* )")


def factor_of(form: IntegerMatrix) -> int:
    """Return a power of two with which a positive definite form exceeds the sum of squares."""
    if not is_positive_definite(form):
        raise ValueError("no multiple of a form that is not positive definite exceeds it")
    power = 1
    while not is_positive_definite(
        [[power * e - (i == j) for j, e in enumerate(row)] for i, row in enumerate(form)]
    ):
        power *= 2
    return power


def reordered(form: IntegerMatrix, order: Sequence[int]) -> list[list[int]]:
    """Return a matrix with rows and columns in another order."""
    return [[form[i][j] for j in order] for i in order]


def _numbered(name: str, count: int) -> str:
    return name if count == 1 else f"{name}_{count}"


@dataclass(frozen=True)
class AbstractStatement(ABC):
    """A system and its forms; the first state is the deflection where contact is lost."""

    system: SwitchedSystem
    evidence: FormsOnGraph

    @property
    def lost(self) -> bool:
        """Whether contact is lost and made again."""
        return self.evidence.covers_lost_contact

    @property
    def order(self) -> list[int]:
        """The states as they come."""
        *others, last = range(self.system.order)
        return [last, *others] if self.lost else [*others, last]

    @abstractmethod
    def mode(self, k: int, mode: Mode, definitions: Definitions) -> str:
        """Return the text of the k-th mode; those of free motion come after those in contact."""

    def define_modes(self, definitions: Definitions) -> tuple[str, str]:
        """Define every mode; return those in contact, and those of free motion."""
        touching, flying = self.system.modes, self.system.free if self.lost else ()
        names = identifiers(mode.name for mode in (*touching, *flying))
        for k, mode in enumerate((*touching, *flying)):
            definitions.define(names[mode.name], self.mode(k, mode, definitions), mode.name)
        texts = (listed(names[mode.name] for mode in part) for part in (touching, flying))
        return next(texts), next(texts)


@dataclass(frozen=True, slots=True)
class Theorem:
    """The text of a file, but for its head."""

    library: tuple[str, ...]  # Parts of the library, in order
    definitions: Sequence[str]  # The system and the certificate
    check: str  # Boolean term that must evaluate to true
    statement: str  # The theorem
    proof: str  # A term, with `checked` for what was computed
    states: tuple[str, ...]  # In the order in which it counts them
    left_out: tuple[str, ...] = ()  # What the statement leaves out against the claim

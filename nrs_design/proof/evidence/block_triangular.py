"""A family that is block triangular in a common order of the states: decided block by block."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, ClassVar, Self

from nrs_design.proof.evidence.abstract import AbstractEvidence, Shows
from nrs_design.proof.evidence.fields import read_integer
from nrs_design.proof.exact import IntegerMatrix
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import Switching
from nrs_design.proof.system import SwitchedSystem

Blocks = tuple[tuple[int, ...], ...]


@dataclass(frozen=True, slots=True)
class BlockTriangular(AbstractEvidence):
    """In every mode, the states of a block are driven by itself and later blocks only.

    The family is stable iff every family of diagonal blocks is, at any rate slower than the
    slowest of theirs; and it has a common quadratic function iff every block has one. So one
    block that is unstable, or has no such function, settles the family.
    """

    kind: ClassVar[str] = "block-triangular"

    blocks: Blocks  # Indices of the states of each block
    # Index of a block, and evidence for its family of diagonal blocks.
    parts: tuple[tuple[int, AbstractEvidence], ...]

    @property
    def shows(self) -> Shows:
        """What the parts show; they all show the same."""
        return self.parts[0][1].shows

    @property
    def is_common_quadratic(self) -> bool:
        """Whether every part is one: then the family has one too."""
        return all(part.is_common_quadratic for _, part in self.parts)

    @property
    def covers_mixtures(self) -> bool:
        """Whether every part does."""
        return all(part.covers_mixtures for _, part in self.parts)

    @property
    def keeps_bound_in_mixtures(self) -> bool:
        """Whether every part does."""
        return all(part.keeps_bound_in_mixtures for _, part in self.parts)

    @property
    def names_unstable_mode(self) -> bool:
        """Whether a part does."""
        return any(part.names_unstable_mode for _, part in self.parts)

    def proved_rate(self, system: SwitchedSystem) -> Fraction | None:
        """Return the slowest of the parts' rates: solutions decay at any slower one.

        It is not attained: a solution may decay like that rate times a polynomial in time.
        """
        rates = [part.proved_rate(diagonal_block(system, self.blocks[k])) for k, part in self.parts]
        known = [rate for rate in rates if rate is not None]
        if len(known) < len(rates):
            return None
        return min(known) if system.time is Time.CONTINUOUS else max(known)

    def fits(self, switching: Switching) -> bool:
        """Tell whether its parts fit; they are about the same signals."""
        return not switching.resets and all(part.fits(switching) for _, part in self.parts)

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check the structure, that the parts suffice, and each part's own fit."""
        if not is_partition(self.blocks, system.order):
            return "the blocks do not partition the states"
        if not is_block_triangular(system, self.blocks):
            return "a mode is not block triangular in this order"
        indices = [index for index, _ in self.parts]
        if len({part.shows for _, part in self.parts}) != 1:
            return "the parts do not show one and the same"
        if not set(indices) <= set(range(len(self.blocks))):
            return "a part is of no block"
        needed = range(len(self.blocks)) if self.shows is Shows.STABILITY else indices[:1]
        if indices != list(needed):
            return "there is not the evidence for the blocks that is needed"
        for index, part in self.parts:
            if misfit := part.find_misfit(diagonal_block(system, self.blocks[index])):
                return f"block {index + 1}: {misfit}"
        return None

    def forms(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield the forms of every part."""
        for index, part in self.parts:
            for failure, form in part.forms(diagonal_block(system, self.blocks[index])):
                yield f"block {index + 1}: {failure}", form

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State the structure and what the parts show."""
        conclusion = {
            Shows.STABILITY: "every solution decays exponentially, at any rate slower than the "
            "slowest of these",
            Shows.INSTABILITY: "so the whole family is unstable too",
            Shows.NO_COMMON_QUADRATIC: "so the whole family has none",
        }[self.shows]
        parts = " ".join(
            f"Block {index + 1} ({', '.join(system.states[i] for i in self.blocks[index])}): "
            + part.claim(diagonal_block(system, self.blocks[index]))
            for index, part in self.parts
        )
        return (
            f"In a common order of the states all modes are block triangular with "
            f"{len(self.blocks)} diagonal blocks. {parts} Together: {conclusion}."
        )

    def spread(self, merged: SwitchedSystem, system: SwitchedSystem) -> Self:
        """Spread every part within its block."""
        parts = []
        for index, part in self.parts:
            inner, outer = (diagonal_block(s, self.blocks[index]) for s in (merged, system))
            parts.append((index, part.spread(inner, outer)))
        return replace(self, parts=tuple(parts))

    def to_fields(self) -> dict[str, Any]:
        """Return the blocks and the fields of every part."""
        return {
            "blocks": [list(block) for block in self.blocks],
            "parts": [
                {"block": index, "kind": part.kind, **part.to_fields()}
                for index, part in self.parts
            ],
        }

    @classmethod
    def from_fields(cls, fields: Mapping[str, Any], system: SwitchedSystem) -> Self:
        """Read the blocks and the parts."""
        from nrs_design.proof.evidence import read_evidence

        blocks = tuple(tuple(read_integer(i) for i in block) for block in fields["blocks"])
        if not is_partition(blocks, system.order) or not fields["parts"]:
            raise ValueError("the blocks do not partition the states, or nothing is shown of them")
        parts = []
        for part in fields["parts"]:
            index = read_integer(part["block"])
            if part["kind"] == cls.kind or not 0 <= index < len(blocks):
                raise ValueError("a part is itself in blocks, or of no block")
            parts.append((index, read_evidence(part, diagonal_block(system, blocks[index]))))
        return cls(blocks, tuple(parts))


def is_partition(blocks: Blocks, order: int) -> bool:
    """TRUSTED: tell whether every state is in exactly one block, and no block is empty."""
    states = [state for block in blocks for state in block]
    return sorted(states) == list(range(order)) and all(blocks)


def is_block_triangular(system: SwitchedSystem, blocks: Blocks) -> bool:
    """TRUSTED: tell whether no state of a block is driven by an earlier block, in any mode."""
    position = {state: k for k, block in enumerate(blocks) for state in block}
    return all(
        entry == 0 or position[i] <= position[j]
        for mode in system.modes
        for i, row in enumerate(mode.A.numerators)
        for j, entry in enumerate(row)
    )


def diagonal_block(system: SwitchedSystem, block: tuple[int, ...]) -> SwitchedSystem:
    """Return the family of one diagonal block of every mode."""
    modes = tuple(
        Mode(
            mode.name,
            RationalMatrix(
                tuple(tuple(mode.A.numerators[i][j] for j in block) for i in block),
                mode.A.denominator,
            ),
        )
        for mode in system.modes
    )
    states = tuple(system.states[i] for i in block)
    return system.with_modes(modes, states, system.switching)

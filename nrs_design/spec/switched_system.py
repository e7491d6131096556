"""The spec of a raw switched system: its state matrices, read exactly."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from nrs_design.spec.faults import fault
from nrs_design.spec.fields import Exact, Label, Name, Title
from nrs_design.spec.model import SpecModel

MAX_DIMENSION = 64
MAX_MODES = 20_000

Row = Annotated[tuple[Exact, ...], Field(min_length=1, max_length=MAX_DIMENSION)]
Matrix = Annotated[tuple[Row, ...], Field(min_length=1, max_length=MAX_DIMENSION)]


class ModeSpec(SpecModel):
    """One mode ``x' = A x`` (or ``x+ = A x``)."""

    name: Label = Field(description="name of the mode, unique in this file")
    A: Matrix = Field(
        description="state matrix as a list of rows, n x n with n <= 64; integers, decimals or "
        '"p/q", read exactly; unit 1/s in continuous time'
    )

    @model_validator(mode="after")
    def _check_square(self) -> ModeSpec:
        n = len(self.A[0])
        for index, row in enumerate(self.A):
            if len(row) != n:
                raise fault(
                    f"row {index + 1} has {len(row)} entries, the first has {n}",
                    "give all rows the same length",
                    "A",
                    index,
                )
        if len(self.A) != n:
            raise fault(
                f"the matrix is {len(self.A)} x {n}, not square",
                "write as many rows as columns",
                "A",
            )
        return self


class SwitchedSystemSpec(SpecModel):
    """A finite family of linear modes."""

    kind: Literal["switched-system"] = Field(description="what this file describes")
    name: Name = Field(description="short name: lower-case letters, digits, '.', '_', '-'")
    title: Title = Field(default="", description="one line for people, at most 200 characters")
    time: Literal["continuous", "discrete"] = Field(
        description="continuous: x' = A x; discrete: x+ = A x"
    )
    modes: Annotated[tuple[ModeSpec, ...], Field(min_length=1, max_length=MAX_MODES)] = Field(
        description="the modes, at least one, all of the same size"
    )
    switching: Literal["arbitrary"] = Field(description="when modes change: arbitrary")

    @property
    def dimension(self) -> int:
        """Number of states n."""
        return len(self.modes[0].A)

    @model_validator(mode="after")
    def _check_modes(self) -> SwitchedSystemSpec:
        names: set[str] = set()
        for index, mode in enumerate(self.modes):
            if mode.name in names:
                raise fault(
                    f"another mode is named {mode.name!r}", "rename it", "modes", index, "name"
                )
            names.add(mode.name)
            if len(mode.A) != self.dimension:
                raise fault(
                    f"the matrix is {len(mode.A)} x {len(mode.A)}, the first mode's is "
                    f"{self.dimension} x {self.dimension}",
                    "all modes share one state",
                    "modes",
                    index,
                    "A",
                )
        return self

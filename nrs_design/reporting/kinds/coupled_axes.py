"""One quadratic function for all axes: its matrix, its multipliers, and a run of one axis."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import product

from nrs_design.proof.evidence import CoupledAxes
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.figures.lyapunov import draw_quadratic
from nrs_design.reporting.formatting import number
from nrs_design.reporting.kinds.abstract import AbstractKindPage
from nrs_design.reporting.kinds.shared import words
from nrs_design.reporting.kinds.shared.bouncing import bouncing_run
from nrs_design.reporting.kinds.shared.conewise import MOVED_REST
from nrs_design.reporting.kinds.shared.matrix import SCALED, matrix_table
from nrs_design.reporting.kinds.shared.run import bounded_run, trials_per_step
from nrs_design.reporting.sections.modes import hardest_modes
from nrs_design.reporting.sections.titles import EVIDENCE
from nrs_design.simulation.contact import clipped
from nrs_design.simulation.norms import quadratic_norm, scaled_matrices
from nrs_design.simulation.switched import worst_direction
from nrs_design.spec.robot_bounds import ON_TRUST

_DECIDED = (
    "Q and the multipliers hold integers over a power of two, and integer arithmetic decides that "
    "Q is positive definite and that the function decreases in every mode, whatever the other axes "
    "do within their bounds. The solver only proposed the numbers"
)
_DECLARED = "They are declared by the spec, and nothing here shows them."
_OF_ROBOT = (
    "They are taken on trust from the file of bounds of the robot, over all poses of a workspace; "
    "`nrs-design gate` and `nrs-design verify --bounds` compute them again from its spec. That the "
    "robot stays in there, and below the speed, is taken for granted."
)
_ONE = (
    "The run is that of a single axis, with the inertia of its links (and what else acts within "
    "the bounds) jumping between the ends at will, which is one of the cases that are covered."
)

# Of more couplings, not every combination of ends is a mode of the run.
MOST_COMBINED = 3


class CoupledAxesPage(AbstractKindPage[CoupledAxes]):
    """Q, the multipliers, and a run of one axis at the ends of what acts on it."""

    @property
    def name(self) -> str:
        """Its kind."""
        return "quadratic function for all axes at once"

    def meaning(self) -> tuple[str, ...]:
        """Say what is added up, and that every axis is in a mode of its own."""
        return (
            "The function is the sum of w' Q w over all axes, with the same Q for each. Every axis "
            "may be under a controller of its own, in contact or not, at any time: for each way in "
            "which axes act on each other there is one multiplier for all modes. How the inertia "
            "depends on the pose, and how fast it changes, does not matter.",
            words.free_bound(self.system),
            *words.unneeded_rules(self.system),
            words.decision(_DECIDED),
        )

    def between_corners(self) -> tuple[str, ...]:
        """Say that they are covered, for each axis at values of its own."""
        return (words.all_corners(self.system, self.evidence),)

    def limits(self) -> tuple[str, ...]:
        """Say what a constant force would change, and that the bounds are assumptions."""
        on_trust = any(ON_TRUST in text for text in self.system.assumptions)
        return (
            MOVED_REST,
            "Poses and speeds in which the links do more than the bounds say. "
            + (_OF_ROBOT if on_trust else _DECLARED),
        )

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show the matrix and the multipliers of the certificate."""
        (Q,) = scaled_matrices(self.evidence.Q)
        system, evidence = self.system, self.evidence
        text = (
            "The certificate holds the matrix Q and the multipliers tau. They are written with "
            f"denominator 2^{evidence.denominator_log2}; here Q is scaled."
        )
        rows = tuple(
            (item.name, number(float(Fraction(tau, 2**evidence.denominator_log2))))
            for item, tau in zip(system.couplings, evidence.taus, strict=True)
        )
        blocks = (
            Paragraph(text),
            *matrix_table("Q divided by its largest entry", Q, system.states),
            Illustration(
                "quadratic",
                "Matrix of the function for each axis",
                SCALED,
                draw_quadratic(Q, system.states),
            ),
            Table("Multipliers", ("what axes do to each other", "tau"), rows),
        )
        return (Section(EVIDENCE, blocks),)

    def run(self) -> Section:
        """Draw a run of one axis in the norm of Q, below its bound."""
        (Q,) = scaled_matrices(self.evidence.Q)
        extreme = extremes(self.system)
        hardest = hardest_modes(extreme, Q, trials_per_step(extreme))
        initial, rate = worst_direction(hardest, Q), float(self.evidence.rate)
        norm, label = quadratic_norm(Q), "in the norm of Q"
        if extreme.contact is None:
            return bounded_run(extreme, hardest, norm, initial, rate, label, f"{_ONE} ")
        return bouncing_run(extreme, hardest, clipped(norm), initial, rate, label, f" {_ONE}")


def extremes(system: SwitchedSystem) -> SwitchedSystem:
    """Return one axis by itself, with all that acts on it at one end or the other.

    Parameters
    ----------
    system : SwitchedSystem
        With couplings.
    """
    names = ["low", "high"]
    contact = system.contact
    modes, free = list[Mode](), list[Mode]()
    every = (*system.modes, *(() if contact is None else contact.free))
    for k, mode in enumerate(every):
        for ends in _ends(len(system.couplings)):
            A = mode.A.fractions()
            for sign, item in zip(ends, system.couplings, strict=True):
                q = item.rows[k].fractions()[0][: system.order]
                for row, (entry,) in zip(A, item.columns[k].fractions(), strict=True):
                    row[:] = [a + sign * entry * b for a, b in zip(row, q, strict=True)]
            label = "/".join((mode.name, *(names[end > 0] for end in ends)))
            part = modes if k < len(system.modes) else free
            part.append(Mode(label, RationalMatrix.from_rows(A)))
    lost = None if contact is None else replace(contact, free=tuple(free))
    return replace(system, modes=tuple(modes), contact=lost, couplings=())


def _ends(count: int) -> list[tuple[int, ...]]:
    """Return at which ends couplings are: all combinations, or of many all at the same end."""
    if count <= MOST_COMBINED:
        return list(product((-1, 1), repeat=count))
    return [(-1,) * count, (1,) * count]

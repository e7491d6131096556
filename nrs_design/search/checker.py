"""TRUSTED: the exact check of evidence for one system, made once for each piece of evidence."""

from __future__ import annotations

from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.fast_check import find_fault


class Checker:
    """Checks evidence for one system.

    A search has to check what it finds, to know whether to go on, and whoever believes it must not
    rely on that. With a checker that both use, the check is made once: systems and evidence never
    change, so what has passed is remembered, by identity and not by value.

    Parameters
    ----------
    system : SwitchedSystem
        The only one that it speaks about.
    """

    def __init__(self, system: SwitchedSystem) -> None:
        self.system = system
        self._passed: list[AbstractEvidence] = []

    def find_fault(self, evidence: AbstractEvidence) -> str | None:
        """Say why evidence does not hold for the system, or None if it holds."""
        if any(evidence is passed for passed in self._passed):
            return None
        fault = find_fault(evidence, self.system)
        if fault is None:
            self._passed.append(evidence)
        return fault

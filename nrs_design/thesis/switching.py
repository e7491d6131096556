"""Chapters 6.3.2, 6.3.3.2 and 6.4.1: what the thesis says about stability under switching."""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.proof.evidence.fields import rate_words
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.certification import Certification
from nrs_design.search.certify import certify
from nrs_design.thesis import thesis
from nrs_design.thesis.comparison import Recomputed
from nrs_design.thesis.matrices import family, hybrid_rows, impedance_rows, printed_rows


def results() -> Iterator[Recomputed]:
    """Prove or refute every claim about stability under switching, exactly."""
    for system in (withdrawal(), family("hybrid", *hybrid_rows()), tool_and_tissue()):
        found = certify(system)
        yield Recomputed(_describe(found), found.verdict == "proved")
    force = ("70183.13", "1231.97")
    found = certify(family("print", printed_rows("-215", force), printed_rows("-104", force)))
    yield Recomputed(_describe(found), found.verdict == "refuted")
    without, with_mass = certify(withdrawal("0")), certify(withdrawal())
    told = f"Mt = 0: {_describe(without)}; Mt = 0.01: {_describe(with_mass)}"
    yield Recomputed(told, without.verdict == with_mass.verdict == "proved")


def withdrawal(Mt: str = "0.01") -> SwitchedSystem:
    """Return the pair of 6.3.2.2 with the right signs, in the states of the thesis."""
    insertion, leaving = (impedance_rows(thesis.SOFT, Mt, Bt, "force") for Bt in ("2.15", "1.04"))
    return family("withdrawal", insertion, leaving)


def tool_and_tissue() -> SwitchedSystem:
    """Return the pair of 6.4.1 with the right digits, in the states of the thesis."""
    tool = impedance_rows(thesis.STIFF, "0.01", "2.11", "force")
    return family("tool", tool, impedance_rows(thesis.SOFT, "0.01", "2.15", "force"))


def _describe(found: Certification) -> str:
    rate = found.evidence.proved_rate(found.system) if found.evidence else None
    if rate is None:
        return str(found.verdict)
    return f"{found.verdict}, {rate_words(rate, found.system.time)}"

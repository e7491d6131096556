"""Chapters 6.3.2, 6.3.3.2 and 6.4.1: what the thesis says about stability under switching."""

from __future__ import annotations

from nrs_design.proof.evidence.fields import rate_words
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.certification import Certification
from nrs_design.search.certify import certify
from nrs_design.thesis import thesis
from nrs_design.thesis.comparison import PrintVerdict, ReproducedValue, claim
from nrs_design.thesis.matrices import family, hybrid_rows, impedance_rows, printed_rows

STABLE = "stable under arbitrary switching"


def rows() -> tuple[ReproducedValue, ...]:
    """Prove or refute every claim about stability under switching, exactly."""
    return (*_designs(), _as_printed(), _zero_mass())


def withdrawal(Mt: str = "0.01") -> SwitchedSystem:
    """Return the pair of 6.3.2.2 with the right signs, in the states of the thesis."""
    insertion, leaving = (impedance_rows(thesis.SOFT, Mt, Bt, "force") for Bt in ("2.15", "1.04"))
    return family("withdrawal", insertion, leaving)


def tool_and_tissue() -> SwitchedSystem:
    """Return the pair of 6.4.1 with the right digits, in the states of the thesis."""
    tool = impedance_rows(thesis.STIFF, "0.01", "2.11", "force")
    return family("tool", tool, impedance_rows(thesis.SOFT, "0.01", "2.15", "force"))


def _designs() -> tuple[ReproducedValue, ...]:
    agility = ("insertion and withdrawal, Bt 2.15 and 1.04", "6.3.2.2", withdrawal())
    hybrid = ("position and force control, Kp 0.02", "6.3.3.2", family("hybrid", *hybrid_rows()))
    both = ("tool and tissue, Bt 2.11 and 2.15", "6.4.1", tool_and_tissue())
    return tuple(_proved(*entry) for entry in (agility, hybrid, both))


def _proved(name: str, section: str, system: SwitchedSystem) -> ReproducedValue:
    found = certify(system)
    return claim(
        name,
        section,
        STABLE,
        _describe(found),
        verdict=PrintVerdict.REPRODUCED,
        holds=found.verdict == "proved",
        note="By a common quadratic function, checked exactly; matrices with the right signs, in "
        "the thesis's states.",
    )


def _as_printed() -> ReproducedValue:
    force = ("70183.13", "1231.97")
    found = certify(family("print", printed_rows("-215", force), printed_rows("-104", force)))
    return claim(
        "A1 and A2 as printed",
        "6.3.2.2",
        STABLE,
        _describe(found),
        verdict=PrintVerdict.PRINTED_DIFFERENTLY,
        errata=("A(2,1)", "6.3.1 k_soft"),
        holds=found.verdict == "refuted",
        note="Neither printed matrix is Hurwitz: the sign of entry (2, 1) is wrong.",
    )


def _zero_mass() -> ReproducedValue:
    without, with_mass = certify(withdrawal("0")), certify(withdrawal())
    return claim(
        "Bt 2.15 and 1.04 without virtual mass",
        "6.3.2.1",
        "Mt = 0 must be avoided",
        f"Mt = 0: {_describe(without)}; Mt = 0.01: {_describe(with_mass)}",
        verdict=PrintVerdict.PRINTED_DIFFERENTLY,
        errata=("6.3.2.1",),
        holds=without.verdict == with_mass.verdict == "proved",
        note="Stability under switching is no reason to avoid Mt = 0: with it, too, the pair has "
        "a common quadratic function.",
    )


def _describe(found: Certification) -> str:
    rate = found.evidence.proved_rate(found.system) if found.evidence else None
    if rate is None:
        return str(found.verdict)
    return f"{found.verdict}, {rate_words(rate, found.system.time)}"

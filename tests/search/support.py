"""What several tests of searches share."""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from typing import Any

from nrs_design.loop.assemble import assemble
from nrs_design.pipeline.runs import run_design
from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.acceptance import Candidates, first_accepted
from nrs_design.search.family import Family, floats_in_silence
from nrs_design.spec import LoadedSpec, parse_spec
from tests.tables import spec_text


def outcome(
    search: Callable[..., Candidates[Any]],
    system: SwitchedSystem,
    *,
    optimize_rate: bool = True,
    **options: Any,
) -> tuple[AbstractEvidence | None, str]:
    """Make one search as `certify` does, with the exact check, but let its errors pass."""
    with floats_in_silence():
        family = Family.of(system, optimize_rate=optimize_rate)
        return first_accepted(search(family, **options), system)


def found(
    search: Callable[..., Candidates[Any]], system: SwitchedSystem, **options: Any
) -> AbstractEvidence | None:
    """Return what the exact check accepts of a search."""
    return outcome(search, system, **options)[0]


TEXT = spec_text("thesis-robot")


def thesis_robot(
    k: tuple[str, str],
    Bt: tuple[str, ...],
    Mt: str,
    tolerance: str = "0",
    load: str | None = None,
    **sections: str,
) -> SwitchedSystem:
    """Return the loop of the thesis with impedance controllers on a spring, as a spec says it."""
    lines = (
        f"  c{i}: {{type: impedance, environment: soft, Mt: {Mt} kg*m^2, Bt: {b} N*m*s/rad}}"
        for i, b in enumerate(Bt)
    )
    text = TEXT.replace("CONTROLLERS", "\n".join(lines))
    text = text.replace("LOW", k[0]).replace("HIGH", k[1])
    nominal = (("GAIN", "4.8417e-4", "rad/s/rpm"), ("TAU", "0.0351", "s"))
    for key, value, unit in nominal:
        low, high = (Decimal(value) * (1 + s * Decimal(tolerance)) for s in (-1, 1))
        ranged = f"{{nominal: {value} {unit}, range: [{low} {unit}, {high} {unit}]}}"
        text = text.replace(key, ranged if Decimal(tolerance) else f"{value} {unit}")
    if load is not None:
        text = text.replace("time_constant:", f"load_inertia: {load} kg*m^2, time_constant:")
    text += "".join(f"{name}: {section}\n" for name, section in sections.items())
    designed = run_design(LoadedSpec(path="soft", sha256="", text=text, spec=parse_spec(text)))
    assert designed is not None
    return assemble(designed.spec, designed.plant, designed.design)

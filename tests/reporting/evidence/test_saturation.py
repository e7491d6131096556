"""The table of limits: nothing is claimed of a lower one."""

from dataclasses import replace
from fractions import Fraction

from nrs_design.reporting.document import Table
from nrs_design.reporting.evidence import page_of
from tests.proof.systems import genuine

SYSTEM, EVIDENCE = genuine("saturated-ellipsoid")


def test_limits_are_rounded_up_and_what_is_proved_down():
    signal, *others = SYSTEM.saturation.signals
    signal = replace(signal, limit=Fraction(1, 3))
    system = replace(SYSTEM, saturation=replace(SYSTEM.saturation, signals=(signal, *others)))
    evidence = replace(EVIDENCE, level=Fraction(2, 3))
    (section,) = page_of(system, evidence).sections()
    table = next(block for block in section.blocks if isinstance(block, Table))
    said = dict(table.rows)
    assert said[f"Limit of the {signal.name}"].startswith("0.333334 ")
    start = SYSTEM.saturation.start.name.capitalize()
    assert said[f"{start} at rest, proved"].startswith("0.666666 ")

"""Obligations of all ends, and text that must steer nothing."""

from pathlib import Path

from nrs_design.gating.obligations import GateOutcome, Obligation, SpecOutcome, Status
from nrs_design.gating.rules import SWITCHING_STABLE

GAINS = {
    "motion": {"Kp": "117359.4375", "Kd": "2060"},
    "hand": {},
    "tissue": {"Mt": "0.00999999977648258209228515625"},
}
HOSTILE = "a: 100%,\r\nb\x1b[31m\x00<&>\"'::error::"


def obligation(status=Status.REFUTED, path="specs/a.nrs.yaml", **changes):
    fields = {"subject": "system", "message": "it grows", "line": 7, "column": 3, **changes}
    return Obligation(SWITCHING_STABLE, Path(path), status=status, **fields)


def outcome_of(*items, **fields):
    path = items[0].path if items else Path("specs/a.nrs.yaml")
    return GateOutcome((SpecOutcome(path, items, **fields),))

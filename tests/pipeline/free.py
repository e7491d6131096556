"""Sampled loops whose gains are free beside Mt and Bt."""

from dataclasses import replace
from pathlib import Path

from nrs_design.pipeline.design import Designed, design_at_least_cost
from nrs_design.spec.document import parse_document
from nrs_design.spec.load import read_spec, respecified
from tests.support import ROOT, replaced

SAMPLED = ROOT / "specs" / "neuroboscope" / "soft-tissue-sampled.nrs.yaml"
FORCE = ROOT / "specs" / "neuroboscope" / "force-limit-sampled.nrs.yaml"
MASS = "Mt: {min: 0.01 kg*m^2, max: 1 kg*m^2}"
DIGITS = "significant_digits: 3"
PD = "motion: {Kp: {min: 0.6, max: 1.6}, Kd: {min: 0.6, max: 1.6}}"


def freed(free: str, *changes: tuple[str, str], path: Path = SAMPLED, digits: int = 3) -> Designed:
    """Design a spec with free gains, and other words in some places."""
    given = (DIGITS, f"significant_digits: {digits}\n  free: {{{free}}}")
    text = replaced(path.read_text(encoding="utf-8"), *changes, given)
    loaded = read_spec(path)
    other = respecified(loaded, parse_document(text, path))
    return design_at_least_cost(replace(other, text=text))

"""Impedance controllers of a design, as admittance_controller computes them."""

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from nrs_design.certificates.certificate import dump
from nrs_design.certificates.prove import prove
from nrs_design.pipeline.runs import run_design
from nrs_design.ros2.export import export_controllers
from nrs_design.ros2.law import read_law
from nrs_design.ros2.parameters import parse_nodes
from nrs_design.ros2.traps import find_traps
from nrs_design.search.certification import Limits
from nrs_design.spec import parse_spec, read_spec
from tests.support import ROOT, replaced

SPEC = ROOT / "specs/neuroboscope/soft-tissue-sampled.nrs.yaml"
LAG = (Fraction(5, 1000), Fraction(20, 1000))


def designed(*changes):
    """The soft-tissue design at one age of the force, with some of its text replaced."""
    loaded = read_spec(SPEC)
    text = replaced(loaded.text, ("delay: [0, 1]", "delay: 1"), *changes)
    return run_design(replace(loaded, text=text, spec=parse_spec(text)))


@pytest.fixture(scope="module")
def design():
    return designed()


def exported(design, lag=LAG, axis="ry"):
    return list(export_controllers(design, axis, lag, Limits()))


@pytest.fixture(scope="module")
def found(design):
    return exported(design)


def law_in(text):
    nodes = parse_nodes(text, Path("exported"))
    return read_law(next(node for node in nodes if node.name == "admittance_controller"))


def test_the_law_is_that_of_the_design(design, found):
    """With stiffness 0: v' = f/M - d v, which is Mt v' + Bt v = F."""
    assert [(item.controller, item.verdict) for item in found] == [
        ("insertion", "proved"),
        ("withdrawal", "proved"),
    ]
    for item, controller in zip(found, design.design.controllers, strict=True):
        law, gains = law_in(item.text), controller.law.gains
        assert law.filter_coefficient == 1
        assert [axis.name for axis in law.axes if axis.selected] == ["ry"]
        assert {axis.mass for axis in law.axes} == {gains["Mt"]}
        assert {axis.stiffness for axis in law.axes} == {0}
        # What is proved is the double that the node holds.
        assert law.joint_damping == Fraction(float(gains["Bt"] / gains["Mt"]))
        (trap,) = find_traps(law, Path("exported"))
        assert "does not start without" in trap.message


def test_the_certificate_is_about_the_numbers_as_written(found):
    for item in found:
        document = json.loads(dump(item.certificate))
        checked = prove(document)
        assert checked.fault is None
        assert checked.certificate.verdict == "proved"
        assert f"certificate: {item.certificate.id}" in item.text
        assert "verdict: PROVED" in item.text
        # The spec asks for a proof through any loss of contact.
        assert checked.certificate.system.contact.required
        assert checked.certificate.evidence.covers_lost_contact


@pytest.mark.slow
def test_every_file_says_what_it_is_worth(design, found):
    for item in found:
        for fact in (
            design.loaded.sha256,
            "sample time: 0.002 s",
            "units: kg*m^2",
            "outside the proof: Input and output",
            "5 to 20 ms",
            "to be given beside this file: joints",
        ):
            assert fact in item.text
        assert exported(design)[found.index(item)] == item


def test_kept_contact_is_said(design):
    kept = designed(("contact: losable", "contact: kept"), ("delay: 1", "delay: [0, 1]"))
    for item in exported(kept):
        assert item.verdict == "proved"
        assert "taken for granted: contact is not lost" in item.text


FILTER = "sensor: {filter: {order: 1, cutoff: 100 rad/s}}\n"


@pytest.mark.slow
def test_the_filter_is_written_out():
    filtered = designed(("contact: losable", f"contact: losable\n{FILTER}"))
    for item in exported(filtered):
        share = law_in(item.text).filter_coefficient
        assert float(share) == pytest.approx(1 - np.exp(-100 * 0.002), rel=1e-6)
        assert len(item.certificate.system.states) == 5

"""Parts of an axis, closed beside the modes of the proof."""

from fractions import Fraction

import control
import numpy as np
import pytest

from nrs_design.design.linear_parts import linear_parts
from nrs_design.loop.assemble import assemble
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import read_spec
from tests.support import ROOT, SOFT_TISSUE

FILTER = "sensor: {filter: {order: 2, cutoff: 60 Hz}}\n"


def filtered(folder):
    """Return soft tissue with a filter of the force."""
    file = folder / "filtered.nrs.yaml"
    file.write_text(SOFT_TISSUE.read_text() + FILTER)
    return file


def space(part):
    return control.ss(part.A, part.B, part.C, part.D)


@pytest.mark.parametrize("name", ["soft-tissue", "force-limit", "tissue-and-tool", "filtered"])
def test_closed_by_python_control_they_are_the_modes_of_the_proof(name, tmp_path):
    """At nominal values; a mode has states of other laws and contacts beside those of its loop."""
    file = ROOT / f"specs/neuroboscope/{name}.nrs.yaml"
    designed = run_design(read_spec(filtered(tmp_path) if name == "filtered" else file))
    system = assemble(designed.spec, designed.plant, designed.design, Fraction(0))
    parts = linear_parts(designed.plant, designed.design)
    before = 1 if parts.force_filter is None else space(parts.force_filter)
    laws = {part.name: part for part in parts.controllers}
    contacts = {part.name: part for part in parts.contacts}
    for controller in designed.design.controllers:
        for contact in controller.contacts:
            (near, *_) = (
                m for m in system.modes if m.name.startswith(f"{controller.name}/{contact}")
            )
            of_mode = np.linalg.eigvals(np.array(near.A.floats()))
            forward = space(parts.motion_loop) * space(laws[controller.name]) * before
            for pole in control.feedback(forward, space(contacts[contact]), sign=1).poles():
                assert np.min(np.abs(of_mode - pole)) < 1e-5 * (1 + abs(pole))


def test_units_of_the_parts():
    designed = run_design(read_spec(SOFT_TISSUE))
    parts = linear_parts(designed.plant, designed.design)
    actuator, motion = parts.actuator, parts.motion_loop
    assert (actuator.input, actuator.outputs) == (("command", "rpm"), (("position", "rad"),))
    assert motion.B.shape == (2, 1)
    law, contact = parts.controllers[0], parts.contacts[0]
    assert (law.input, law.outputs) == (("force", "N*m"), (("velocity", "rad/s"),))
    assert (contact.input, contact.outputs) == (("velocity", "rad/s"), (("contact_force", "N*m"),))

"""Parts of an axis and their closed loops, beside the modes of the proof."""

from fractions import Fraction

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


@pytest.mark.parametrize("name", ["soft-tissue", "force-limit", "tissue-and-tool", "filtered"])
def test_poles_are_those_of_the_modes_of_the_proof(name, tmp_path):
    """At nominal values; a mode has states of other laws and contacts beside those of its loop."""
    file = ROOT / f"specs/neuroboscope/{name}.nrs.yaml"
    designed = run_design(read_spec(filtered(tmp_path) if name == "filtered" else file))
    spec = designed.spec
    loops = linear_parts(designed.plant, designed.design).loops
    assert loops
    system = assemble(spec, designed.plant, designed.design, Fraction(0))
    for loop in loops:
        near = [mode for mode in system.modes if mode.name.startswith(loop.name)]
        assert near, [mode.name for mode in system.modes]
        rows = np.array([[float(entry) for entry in row] for row in near[0].A.fractions()])
        of_mode = np.linalg.eigvals(rows)
        for pole in np.linalg.eigvals(loop.A):
            assert np.min(np.abs(of_mode - pole)) < 1e-5 * (1 + abs(pole))


def test_units_of_the_parts():
    designed = run_design(read_spec(SOFT_TISSUE))
    parts = linear_parts(designed.plant, designed.design)
    actuator, motion = parts.actuator, parts.motion_loop
    assert (actuator.input, actuator.outputs) == (("command", "rpm"), (("position", "rad"),))
    assert motion.B.shape == (2, 1)
    loop, *_ = parts.loops
    assert loop.input == ("force", "N*m")
    assert loop.outputs == (("velocity", "rad/s"), ("contact_force", "N*m"))

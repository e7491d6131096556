"""Parts of an axis, closed beside the modes of the proof."""

from fractions import Fraction

import control
import numpy as np
import pytest

from nrs_design.design.laws.law import Task
from nrs_design.design.linear_parts import linear_parts, open_loops
from nrs_design.loop.assemble import assemble
from nrs_design.loop.cut_loop import characteristic
from nrs_design.pipeline.design import run_analysis, run_open_loops
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import read_spec
from tests.support import ROBOT, ROOT, SOFT_TISSUE, spec_in

FILTER = "sensor: {filter: {order: 2, cutoff: 60 Hz}}\n"


def filtered(folder):
    """Return soft tissue with a filter of the force."""
    return spec_in(folder, SOFT_TISSUE.read_text() + FILTER, "filtered")


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


SPECS = {"pi": ROBOT / "force-limit-pi.nrs.yaml", "viscous": ROBOT / "nose.nrs.yaml"}
FIELDS = ("sensitivity_peak", "gain_margin", "phase_margin", "delay_margin", "disk_margin")


def sampled(folder):
    """Insertion alone, every 2 ms, with a force sample of either age."""
    head, _, _ = SOFT_TISSUE.read_text().partition("  withdrawal:")
    more = "switching: arbitrary\nsampling: {period: 2 ms, delay: [0, 1]}\n"
    return spec_in(folder, head + more)


@pytest.fixture(params=["sampled", *SPECS])
def designed(request, tmp_path):
    file = sampled(tmp_path) if request.param == "sampled" else SPECS[request.param]
    return run_design(read_spec(file))


def test_they_respond_as_the_loops_of_the_margins(designed):
    found = run_open_loops(designed)
    assert found
    for loop in found:
        omega = np.logspace(-1, 2, 7)
        (wanted,) = loop.loops.response(omega)
        period, n = loop.loops.period, len(loop.A)
        points = 1j * omega if period is None else np.exp(1j * omega * period)
        response = [
            (loop.C @ np.linalg.solve(z * np.eye(n) - loop.A, loop.B)).item() for z in points
        ]
        assert np.allclose(response, wanted, rtol=1e-11, atol=0)


def test_closed_they_are_stable_where_the_file_says_it(designed):
    for loop in run_open_loops(designed):
        poles = np.linalg.eigvals(loop.A - loop.B @ loop.C)
        # A state that the loop does not see, such as the position of a velocity mode, may rest.
        seen = poles[np.abs(poles - (0 if loop.loops.period is None else 1)) > 1e-6]
        worst = seen.real.max() if loop.loops.period is None else np.abs(seen).max() - 1
        assert (worst < 0) == bool(loop.loops.stable[0])


def test_the_worst_of_them_are_the_margins_of_the_report(designed):
    analysis, found = run_analysis(designed), run_open_loops(designed)
    for item in analysis.measured:
        mine = [loop.loops for loop in found if loop.controller == item.name]
        worst = {each.measure.goal: each.value for each in item.achieved}
        for name in FIELDS:
            bound, goal = (max, "max_") if name == "sensitivity_peak" else (min, "min_")
            value = bound(float(getattr(loops, name)()[0]) for loops in mine)
            if goal + name in worst:
                assert value == pytest.approx(worst[goal + name], rel=1e-7)
    assert analysis.measured


def test_one_entry_is_exact_to_the_last_bit():
    """What the force adds, taken off again, is the mode that is proved: its polynomial, exactly."""
    designed = run_design(read_spec(SPECS["pi"]))
    task = Task(designed.spec, designed.plant, designed.design.motion)
    controller = next(c for c in designed.design.controllers if c.name == "force")
    corner = task.corners(designed.spec.controllers[controller.name])[0]
    opened, closed = task.axis.modes(controller.law, corner.contact, corner.place)
    cut = task.axis.find_loop(controller.law, corner.contact, corner.place)
    assert (characteristic(opened), characteristic(closed)) == (cut.opened, cut.closed)
    loop = open_loops(designed.spec, designed.plant, designed.design)[0]
    added = np.array([[Fraction(x) for x in row] for row in closed]) - np.array(
        [[Fraction(x) for x in row] for row in opened]
    )
    assert np.allclose(-loop.B @ loop.C, added.astype(float), rtol=1e-15)


def test_a_controller_without_force_and_two_rates_have_none(tmp_path):
    mixed = run_design(read_spec(ROOT / "docs/examples/mixed-controllers.nrs.yaml"))
    names = {loop.controller for loop in run_open_loops(mixed)}
    asked = {c.name for c in mixed.design.controllers}
    assert names < asked
    file = sampled(tmp_path)
    file.write_text(file.read_text().replace("delay: [0, 1]", "outer_period: 0.1 ms, delay: 1"))
    assert run_open_loops(run_design(read_spec(file))) == ()

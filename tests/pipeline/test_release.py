"""What is watched when an axis is let go, against what can be computed by hand or elsewhere."""

import control
import numpy as np
import pytest

from nrs_design.pipeline.release import physical_outputs
from nrs_design.pipeline.runs import run_certification
from nrs_design.search.certification import Limits
from nrs_design.simulation.release import Outputs
from nrs_design.simulation.switched import simulate_switching
from nrs_design.spec import read_spec
from tests.support import COMMUTING, ROBOT, SOFT_TISSUE

QUICK = Limits(optimize_rate=False)


def result_of(path):
    return run_certification(read_spec(path), limits=QUICK)


def changed(folder, *changes):
    """Return the spec of soft tissue with parts of its text exchanged."""
    text = SOFT_TISSUE.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = folder / "changed.nrs.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_followed_position_goes_back_as_the_motion_loop_steps():
    """The position controller alone, let go from a hold: ``1 - step response`` of G."""
    result = result_of(ROBOT / "force-limit.nrs.yaml")
    system, outputs = result.certification.system, physical_outputs(result)
    assert isinstance(outputs, Outputs)
    mode = next(i for i, one in enumerate(system.modes) if one.name == "position")
    step, signal = 1e-4, np.full(2000, mode)
    run = simulate_switching(system, signal, outputs.pressed, step)
    actuator, gains = result.designed.plant, result.design.motion
    loop = actuator.motion_loop(gains.Kp, gains.Kd)
    G = control.tf([*map(float, loop.numerator)], [*map(float, loop.denominator)])
    _, wanted = control.step_response(G, run.time)
    position = run.state @ outputs.deflection
    assert position == pytest.approx(1 - wanted, abs=1e-6)
    # The velocity of that mode is the slope of its position, from the first moment on.
    velocity = run.state @ outputs.velocity[mode]
    assert velocity[1:-1] == pytest.approx(np.gradient(position, step)[1:-1], abs=1e-3)
    assert velocity[0] == pytest.approx(-loop.numerator[0] / loop.denominator[0])


def test_the_torque_is_the_stiffness_times_the_deflection():
    result = result_of(ROBOT / "force-limit.nrs.yaml")
    outputs, (soft,) = physical_outputs(result), result.designed.plant.among(("soft",))
    ends = [float(law.k) for law in soft.corners]
    assert outputs.force @ outputs.pressed == pytest.approx(ends)
    assert (outputs.force @ outputs.start).max() == pytest.approx(0.3)


def test_tissue_that_creeps_is_pressed_in_before_it_does():
    result = result_of(ROBOT / "nose.nrs.yaml")
    outputs = physical_outputs(result)
    # Only the spring k2 has moved: 0.3 N m over 1.1664 N m/rad.
    assert outputs.deflection @ outputs.start == pytest.approx(0.3 / 1.1664)
    assert np.count_nonzero(outputs.start) == 1


def test_tissue_without_a_rest_position_has_no_deflection(tmp_path):
    maxwell = ("model: elastic", "model: maxwell\n    damping: 20 N*s/m")
    outputs = physical_outputs(result_of(changed(tmp_path, maxwell)))
    assert outputs.deflection is None
    assert (outputs.force @ outputs.start).max() == pytest.approx(0.3)


@pytest.mark.parametrize(
    ("name", "reason"),
    [("force-limit-offset", "sets parts of the state anew"), ("soft-tissue-redesigned", None)],
)
def test_what_is_not_shown_has_its_reason(name, reason):
    found = physical_outputs(result_of(ROBOT / f"{name}.nrs.yaml"))
    assert isinstance(found, Outputs) if reason is None else reason in found


def test_given_matrices_have_no_units():
    assert physical_outputs(result_of(COMMUTING)) is None

"""The logic in samples and single precision: that of the spec, rounded to the safe side."""

from fractions import Fraction

import pytest

from nrs_design.controllers.float32 import is_float32
from nrs_design.controllers.step_logic import LONGEST, StepLogic
from nrs_design.errors import DesignError
from nrs_design.spec.threshold_logic import ThresholdLogicSpec

MODES = ("withdrawal", "insertion", "hold")
# Sums of it are exact, in doubles too.
PERIOD = Fraction(1, 1024)


def spec(hold=None, above="0.5 rad/s"):
    command = {"noise": "0.125 rad/s", "age": "4 ms", "largest_rate": "40 rad/s^2"}
    torque = {"noise": "0.001 N*m", "age": "4 ms", "largest_rate": "2 N*m/s"}
    out, back = (
        {"from": "insertion", "to": "withdrawal"},
        {"from": "withdrawal", "to": "insertion"},
    )
    switches = [
        out | {"command": {"below": "-0.5 rad/s"}, "torque": {"above": "0.125 N*m"}},
        back | {"command": {"above": above}},
        back | {"torque": {"below": "0.0625 N*m"}},
    ]
    document = {"type": "thresholds", "start": "insertion", "switches": switches}
    document["signals"] = {"command": command, "torque": torque}
    return ThresholdLogicSpec.model_validate(document | ({"hold": hold} if hold else {}))


def test_thresholds_are_rounded_away_from_each_other():
    logic = StepLogic.create(spec(above="0.1 rad/s"), MODES, PERIOD)
    bounds = [bound for switch in logic.switches for bound in switch.bounds]
    assert all(is_float32(bound.threshold) for bound in bounds)
    found = next(bound for bound in bounds if bound.is_lower and bound.signal == "command")
    assert Fraction(1, 10) < found.threshold < Fraction("0.10000001")
    assert (logic.start, logic.signals, logic.hold_samples[2]) == (1, ("command", "torque"), 0)


@pytest.mark.parametrize(("hold", "samples"), [("50 ms", 52), ("51 ms", 53), ("125 ms", 128)])
def test_times_are_rounded_up_to_samples(hold, samples):
    assert (
        StepLogic.create(spec(hold={"insertion": hold}), MODES, PERIOD).hold_samples[1] == samples
    )


def test_the_count_ends_and_a_mode_that_there_is_not_is_the_first():
    logic = StepLogic.create(spec(), MODES, PERIOD)
    quiet = {"command": 0.0, "torque": 0.1}
    assert logic.step(0, LONGEST, quiet) == (0, LONGEST)
    assert logic.step(3, 7, quiet) == (1, 1)
    assert logic.step(2, 7, {"command": -1.0, "torque": 1.0}) == (2, 8)


def test_a_time_that_cannot_be_counted_is_refused():
    with pytest.raises(DesignError, match="32 bits") as caught:
        StepLogic.create(spec(hold="50 s"), MODES, Fraction(1, 10**9))
    assert caught.value.at == ("mode_logic", "hold")

"""What a statement says of the force signal."""

from fractions import Fraction

from nrs_design.certificates.catalogue import sentences
from nrs_design.controllers.float32 import exact_decimal
from nrs_design.controllers.sensor import LowPass, Sensor
from nrs_design.loop.assemble import assemble
from nrs_design.pipeline.runs import run_design
from tests.loop.support import loaded
from tests.support import SOFT_TISSUE, words_of

SENSOR = Sensor({"bias": Fraction(1, 3), "drift": Fraction(1, 2)}, LowPass(2, Fraction(200)))


def test_without_a_sensor_nothing_is_said():
    assert not list(Sensor().assumptions(None, disturbed=False))


def test_errors_are_summed_rounded_up_and_left_out():
    filtered, errors = sentences(SENSOR.assumptions(None, disturbed=False))
    assert "2 equal lags in a row, x' = w (F - x) with w = 200 rad/s" in filtered
    assert "at most 0.833334 N*m (rounded up) (bias: 0.333334 N*m (rounded up); " in errors
    assert "drift: 0.5 N*m)" in errors
    assert "The statement leaves it out" in errors


def test_bounds_on_disturbances_take_them_up():
    step, errors = sentences(SENSOR.assumptions(Fraction(1, 500), disturbed=True))
    assert "x+ = p x + q F with the single-precision numbers p = 0.67" in step
    assert "It is the force error of the statements that name one" in errors


def sensed(more):
    """Design soft tissue in contact that is kept, with what is sampled and sensed."""
    found = run_design(loaded(SOFT_TISSUE, more=f"contact: kept\n{more}"))
    return found, assemble(found.spec, found.plant, found.design)


def test_the_filter_runs_with_the_outer_loop():
    sampling = "sampling: {period: 2 ms, outer_period: 0.5 ms, delay: 0}\n"
    found, system = sensed(f"{sampling}sensor: {{filter: {{cutoff: 60 Hz}}}}\n")
    step = found.design.sensor.filter.discretize(Fraction(1, 2000))
    (text,) = (text for text in words_of(system) if "through one lag" in text)
    assert f"p = {exact_decimal(step.p)} and" in text
    kept = {mode.A.fractions()[5][5] for mode in system.modes}
    assert kept == {step.p}


def test_the_sampled_loop_takes_the_errors_for_its_force_error():
    _, system = sensed(
        "sampling: {period: 2 ms, delay: 0}\ndisturbances: {encoder_step: 1e-5 rad}\n"
        "sensor: {bias: 5e-3 N*m, filter: {cutoff: 60 Hz}}\n"
    )
    assert system.states[4] == "filtered 1 before [N*m]"
    bounds = {channel.name: channel.bound for channel in system.channels}
    assert bounds["force error"] == Fraction("0.005")

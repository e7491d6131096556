"""The least cost of every controller: in the loop that ships."""

from nrs_design.pipeline.analysis import run_analysis
from nrs_design.pipeline.cost_bounds import run_cost_bounds
from nrs_design.pipeline.runs import run_interaction
from nrs_design.spec import read_spec
from tests.support import SOFT_TISSUE


def analyzed(tmp_path, **changes):
    text = SOFT_TISSUE.read_text()
    for old, new in changes.values():
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / "spec.nrs.yaml"
    path.write_text(text)
    return run_analysis(run_interaction(read_spec(path), "has nothing to design"))


def test_the_bound_is_about_the_motion_loop_that_ships(tmp_path):
    """`design.free` changes Kp and Kd: the cost in the loop of the spec is another one."""
    loop = ("derivative_gain: 2060 ", "derivative_gain: 2572.5 "), ("zero: 56.9706 ", "zero: 73 ")
    chosen, shipped = analyzed(tmp_path), analyzed(tmp_path, Kd=loop[0], zero=loop[1])
    for item in shipped.impedance:
        found = run_cost_bounds(chosen, shipped)[item.name]
        assert abs(float(found.above) - item.cost) < 1e-12
        assert found.reached
        # These gains are the best in that loop, but for their digits.
        assert 0 < found.gap < 1e-4


def test_gains_that_are_given_have_no_bound(tmp_path):
    given = ("{min: 0.01 kg*m^2, max: 1 kg*m^2}", "0.01 kg*m^2")
    damping = ("{min: 0.1 N*m*s/rad, max: 20 N*m*s/rad}", "2.15 N*m*s/rad")
    chosen = analyzed(tmp_path, Mt=given, Bt=damping)
    assert set(run_cost_bounds(chosen, chosen).values()) == {"Mt and Bt are given"}

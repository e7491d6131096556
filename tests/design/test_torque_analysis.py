"""What `tune` and the report say of controllers that make torques."""

import pytest

from nrs_design.errors import SpecError
from nrs_design.pipeline.design import run_analysis
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import parse_spec, read_spec
from nrs_design.spec.templates import TEMPLATES
from tests.support import document_of, replaced, run

TEXT = TEMPLATES["torque-interface"]
AT_ONCE = ((", latency: 0.3 ms", ""), ("  dead_time: 0.2 ms", "  #"))
SHAPED = ("    # inertia", "    inertia")
RANGED = "friction: {nominal: 1 N*m*s/rad, range: [0.4 N*m*s/rad, 2 N*m*s/rad]}"


@pytest.fixture
def analyzed(tmp_path):
    def make(*edits):
        path = tmp_path / "mine.nrs.yaml"
        path.write_text(replaced(TEXT, *edits), encoding="utf-8")
        return run_analysis(run_design(read_spec(path))).torque

    return make


def test_passivity_is_decided_where_the_condition_holds(analyzed):
    """With the least friction of the range: b = 0.4, K T/2 + B."""
    lighter = ("damping: 3 N*m*s/rad", "damping: 0.25 N*m*s/rad")
    soft, firm = analyzed(*AT_ONCE, ("friction: 0.5 N*m*s/rad", RANGED), lighter)
    assert float(soft.margin) == pytest.approx(0.4 - 30 * 0.0005 - 0.25, abs=1e-6)
    assert soft.passive_text.startswith("yes, 0.13")
    assert float(firm.margin) == pytest.approx(0.4 - 60 * 0.0005 - 5, abs=1e-6)
    assert firm.passive_text == "no, -4.63"


@pytest.mark.parametrize("edits", [AT_ONCE[:1], AT_ONCE[1:], (*AT_ONCE, SHAPED)])
def test_it_is_not_decided_otherwise(analyzed, edits):
    assert analyzed(*edits)[0].passive_text == "not decided"


def test_tune_prints_it(tmp_path):
    path = tmp_path / "mine.nrs.yaml"
    path.write_text(TEXT, encoding="utf-8")
    said = run("tune", path, cwd=tmp_path, code=0).stdout
    assert "Stable in the air" in said
    assert "Colgate and Schenkel" in said
    soft, firm = document_of("tune", path, cwd=tmp_path)["torque"]
    # Gil and others: (b + B)/(T/2 + t), about.
    for item, B in ((soft, 3), (firm, 5)):
        assert item["stable_below_in_the_air"] == pytest.approx((0.5 + B) / 0.001, rel=0.05)
        assert item["passivity_margin"] is None


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("    damping: 3 N*m*s/rad", "    damping: -3 N*m*s/rad", "must be zero or positive"),
        ("  friction: 0.5 N*m*s/rad", "  friction: -0.5 N*m*s/rad", "must be positive"),
        ("  friction: 0.5 N*m*s/rad", "  friction: 0 N*m*s/rad", "must be positive"),
        ("  friction: 0.5 N*m*s/rad", "  friction: 0.5 N*s/m", "square of its lever arm"),
        ("  inertia: {nominal: 0.2 kg*m^2,", "  inertia: {nominal: 2 kg,", "square of its lever"),
        ("switching: arb", "  third: {type: position}\nswitching: arb", "does not fit the drive"),
        ("torque_interface:\n", "torque_interfaces:\n", "torque_interface"),
        ("latency: 0.3 ms", "latency: 20 ms", "more than 10 periods"),
        ("sampling: {period: 1 ms, delay: 0, latency: 0.3 ms}", "", "continuous time"),
        ("  bandwidth: 2 Hz", "  command: 100 rpm\n  bandwidth: 2 Hz", "the motor takes N*m"),
        ("    # inertia_ratio: 0.5", "    inertia_ratio: 0 #", "positive"),
        ("limits:\n", "position_interface: {time_constant: 3 ms}\nlimits:\n", "stands beside"),
    ],
)
def test_what_does_not_fit_is_refused_with_a_remedy(old, new, what):
    with pytest.raises(SpecError) as caught:
        parse_spec(replaced(TEXT, (old, new)))
    faults = caught.value.faults or (caught.value,)
    said = " ".join(f"{fault.message} {fault.remedy}" for fault in faults)
    assert what in said
    assert all(fault.remedy for fault in faults)

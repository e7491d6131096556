"""A whole parameter file."""

from fractions import Fraction

import pytest

from nrs_design.errors import SpecError
from nrs_design.gating.obligations import Status
from nrs_design.ros2.check import Question, check_file
from nrs_design.search.certification import Limits
from tests.ros2.support import EXAMPLE, changed

SOFT = (Fraction(200), Fraction(2000))


def statuses(file, question):
    outcome = check_file(file, question, Limits(budget=10), lambda step: None)
    (found,) = outcome.specs
    return found, [item.status for item in found.obligations], outcome.notes


def test_the_example():
    found, status, notes = statuses(EXAMPLE, Question((0, 2), SOFT, None))
    assert found.verdict == "proved"
    assert status == [Status.MET, *[Status.PROVED] * 6]
    assert any("spring without damping" in note for note in notes)


@pytest.mark.slow
def test_too_stiff_says_how_stiff_it_may_be():
    stiff = (Fraction(200), Fraction(90_000))
    found, status, _ = statuses(EXAMPLE, Question((0, 0), stiff, None))
    assert found.verdict == "refuted"
    assert status.count(Status.REFUTED) == 3
    message = found.obligations[1].message
    proved, refuted = message.split("; proved for 200 to ")[1].split(" N/m, refuted for 200 to ")
    safe = Fraction(proved)
    assert 5_000 < safe < Fraction(refuted.removesuffix(" N/m")) < 90_000
    again, _, _ = statuses(EXAMPLE, Question((0, 0), (SOFT[0], safe), None))
    assert again.verdict == "proved"


CHAIN = "sensor_filter_chain: {filter1: {name: low, type: filters/LowPassFilterWrench}}"
BROADCASTER = "force_torque_sensor_broadcaster/ForceTorqueSensorBroadcaster"


def with_node(tmp_path, name, parameters, kind=None, changes=()):
    """Write the example with one more node, whose type the manager says."""
    listed = "    admittance_controller: {type:"
    told = f"    {name}: {{type: {kind}}}\n" if kind else ""
    more = f"{name}:\n  ros__parameters: {{{parameters}}}\n"
    return changed(tmp_path, (listed, told + listed), *changes, more=more)


def test_a_filter_chain_is_one_of_the_broadcaster(tmp_path):
    """The controller passes over it; the broadcaster publishes what it filters."""
    own = changed(tmp_path, ("    control:", f"    {CHAIN}\n    control:"))
    found, _, _ = statuses(own, Question((0, 2), SOFT, None))
    assert found.verdict == "proved"
    (caution,) = found.cautions
    assert "sensor_filter_chain.filter1.name: is for force_torque_sensor_broadc" in caution.message
    other = with_node(tmp_path, "ft", f"sensor_name: tcp_sensor, {CHAIN}", BROADCASTER)
    found, _, notes = statuses(other, Question((0, 2), SOFT, None))
    assert found.verdict == "proved"
    assert found.cautions == ()
    assert "passed over, because they command nothing: ft" in notes


@pytest.mark.parametrize("source", ["ft/tcp_sensor", "ft"])
def test_a_force_that_comes_through_another_controller_is_not_modelled(tmp_path, source):
    """A broadcaster multiplies what it exports, a chained filter filters it."""
    names = [("name: tcp_sensor", f"name: {source}")]
    for kind in (BROADCASTER, "chained_filter_controller/ChainedFilter"):
        file = with_node(tmp_path, "ft", "sensor_name: tcp_sensor", kind, names)
        found, status, _ = statuses(file, Question((0, 2), SOFT, None))
        assert found.verdict == "inconclusive"
        assert status[1:7] == [*[Status.INCONCLUSIVE] * 3, *[Status.PROVED] * 3]
        assert "its force comes through ft, another controller" in found.obligations[1].message


@pytest.mark.parametrize(
    ("kind", "own", "words"),
    [
        ("my_pkg/MyAdmittance", "admittance: {mass: 1.0}", "of type my_pkg/MyAdmittance is here"),
        ("joint_trajectory_controller/JointTrajectoryController", "joints: [a]", "JointTraj"),
        (None, "type: my_pkg/Mine, admittance: {mass: 1.0}", "of type my_pkg/Mine is here"),
        (None, "joints: [a]", "nothing in this file says of which type it is"),
    ],
)
def test_another_controller_of_the_file_is_named_and_undecided(tmp_path, kind, own, words):
    file = with_node(tmp_path, "arm", own, kind)
    found, status, _ = statuses(file, Question((0, 2), SOFT, None))
    assert found.verdict == "inconclusive"
    assert status == [Status.MET, *[Status.PROVED] * 6, Status.INCONCLUSIVE]
    last = found.obligations[-1]
    assert last.message.startswith("arm: passed over, so undecided: ")
    assert words in last.message
    assert last.rule.id == "NRS203"


def test_rates(tmp_path):
    slow = changed(tmp_path, ("update_rate: 500", "update_rate: 20"))
    assert statuses(slow, Question((0, 2), SOFT, None))[0].verdict == "refuted"
    assert statuses(slow, Question((0, 2), SOFT, None, Fraction(500)))[0].verdict == "proved"
    own = changed(tmp_path, ("    joints:", "    update_rate: 20\n    joints:"))
    assert statuses(own, Question((0, 2), SOFT, None))[0].verdict == "refuted"


def test_where_the_rate_comes_from_is_said(tmp_path):
    """A launch file may set another: only this file is read."""
    unseen = "what a launch file, a command line or another file sets is not seen here"

    def said(file, rate=None):
        (note,) = (n for n in statuses(file, Question((0, 0), SOFT, None, rate))[2] if unseen in n)
        return note

    assert "runs 500 times per second, as controller_manager (line 4) says;" in said(EXAMPLE)
    assert "runs 1000 times per second, as --rate says;" in said(EXAMPLE, Fraction(1000))
    own = changed(tmp_path, ("    joints:", "    update_rate: 250\n    joints:"))
    wanted = "runs 250 times per second, as controller_manager (line 4) says together with its own"
    assert f"{wanted} update_rate (line 9);" in said(own)


def test_a_rate_of_its_own_that_does_not_divide_the_rate_of_the_loop(tmp_path):
    """ros2_control then triggers it at uneven periods, or at 500 1/s (controller_manager.cpp)."""
    file = changed(tmp_path, ("    joints:", "    update_rate: 300\n    joints:"))
    with pytest.raises(SpecError, match="300 does not divide 500"):
        statuses(file, Question((0, 0), SOFT, None))
    assert statuses(file, Question((0, 0), SOFT, None, Fraction(300)))[0].verdict == "proved"


@pytest.mark.parametrize(
    "more",
    [
        "/**:\n  ros__parameters: {ft_sensor.filter_coefficient: 0.9}\n",
        "/**/admittance_controller:\n  ros__parameters: {admittance: {joint_damping: 0.0}}\n",
        "/admittance_controller:\n  ros__parameters: {ft_sensor.filter_coefficient: 0.9}\n",
    ],
    ids=["all nodes", "any namespace", "the same name"],
)
def test_what_other_nodes_of_the_file_say_of_the_law_is_not_passed_over(tmp_path, more):
    """ROS 2 gives a node the parameters of wildcards, too; a default was taken for them."""
    file = changed(tmp_path, ("      filter_coefficient: 0.5\n", ""), more=more)
    found, status, _ = statuses(file, Question((0, 0), SOFT, None))
    assert found.verdict is None
    assert Status.ERROR in status
    assert "counts for admittance_controller, too" in found.obligations[0].message


def test_a_wildcard_is_no_controller_beside_those_that_it_means(tmp_path):
    """Each parameter was to be moved to the other of the two; and no controller is called `**`."""
    more = "/**:\n  ros__parameters: {admittance: {joint_damping: 3.0}}\n"
    file = changed(tmp_path, more=more)
    found, _, _ = statuses(file, Question((0, 2), SOFT, None))
    (only,) = [item for item in found.obligations if item.status is Status.ERROR]
    assert "write it at admittance_controller alone" in only.message


def test_a_wildcard_that_says_nothing_of_the_law_and_other_nodes(tmp_path):
    more = "/**:\n  ros__parameters: {use_sim_time: true}\n"
    for other in ("/other/*", "/other/**"):
        more += f"{other}:\n  ros__parameters: {{update_rate: 100}}\n"
    file = changed(tmp_path, more=more)
    assert statuses(file, Question((0, 2), SOFT, None))[0].verdict == "proved"


def test_every_controller_runs_at_the_rate_of_its_own_manager(tmp_path):
    text = changed(tmp_path).read_text()
    left, right = (text.replace("\n", "\n  ") for _ in range(2))
    file = tmp_path / "two.yaml"
    file.write_text(f"left:\n  {left}\nright:\n  {right.replace('500', '20')}\n")
    found, _, _ = statuses(file, Question((0, 2), SOFT, None))
    verdicts = {item.message.partition(":")[0]: item.status for item in found.obligations[::-1]
                if "axis x" in item.message}  # fmt: skip
    assert verdicts == {
        "left/admittance_controller": Status.PROVED,
        "right/admittance_controller": Status.REFUTED,
    }
    file.write_text(f"left:\n  {left}\nright:\n  {right.replace('500', '20')}\n".replace(
        "  admittance_controller:\n    ros", "  arm/admittance_controller:\n    ros"))  # fmt: skip
    with pytest.raises(SpecError, match="rate of the control loop"):
        statuses(file, Question((0, 2), SOFT, None))


def test_a_type_counts_whichever_of_several_managers_says_it(tmp_path):
    """One that is known by its type only, with its mass missing, must not vanish."""
    kind = "admittance_controller/AdmittanceController"
    more = f"/b/controller_manager:\n  ros__parameters: {{second: {{type: {kind}}}}}\n"
    file = changed(tmp_path, more=f"{more}/**/second:\n  ros__parameters: {{joints: [x]}}\n")
    found, status, _ = statuses(file, Question((0, 2), SOFT, None, Fraction(500)))
    assert Status.ERROR in status
    assert any("second" in item.message for item in found.obligations)


def test_what_cannot_be_read_beside_what_is_proved_has_no_verdict(tmp_path):
    file = with_node(tmp_path, "second", "admittance: {mass: 1.0}")
    found, status, _ = statuses(file, Question((0, 2), SOFT, None))
    assert found.verdict is None
    assert {Status.PROVED, Status.ERROR} <= set(status)


def test_what_would_not_start_is_an_error(tmp_path):
    file = changed(tmp_path, ("mass: [5.0, 5.0", "mass: [5, 5"))
    found, status, _ = statuses(file, Question((0, 0), SOFT, None))
    assert found.verdict is None
    assert status == [Status.ERROR, Status.ERROR]
    assert {item.line for item in found.obligations} == {30}


def test_no_admittance_controller(tmp_path):
    file = tmp_path / "a.yaml"
    file.write_text("arm:\n  ros__parameters: {joints: [a]}\n")
    with pytest.raises(SpecError, match="no admittance controller is among its nodes"):
        statuses(file, Question((0, 0), SOFT, None))


def test_a_controller_that_runs_without_a_node_of_its_name(tmp_path):
    other = ("    admittance_controller:", "    admittance:")
    renamed = changed(tmp_path, other)
    found, _, _ = statuses(renamed, Question((0, 2), SOFT, None))
    assert found.verdict == "inconclusive"
    (last,) = [item for item in found.obligations if "no node of this name" in item.message]
    assert last.message.startswith("admittance: passed over, so undecided: controller_manager runs")
    assert last.line == 5
    anyone = changed(tmp_path, other, ("\nadmittance_controller:", "\n/**:"))
    found, _, _ = statuses(anyone, Question((0, 2), SOFT, None))
    assert found.verdict == "proved"

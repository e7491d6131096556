"""A whole parameter file."""

from fractions import Fraction

import pytest

from nrs_design.errors import SpecError
from nrs_design.gating.obligations import Status
from nrs_design.ros2.axis import ControllerContext
from nrs_design.ros2.check import check_file
from nrs_design.search.certification import Limits
from tests.ros2.support import EXAMPLE, changed
from tests.tables import rows

SOFT = (Fraction(200), Fraction(2000))


def statuses(file, question):
    outcome = check_file(file, question, Limits(budget=10), lambda step: None)
    (found,) = outcome.specs
    return found, [item.status for item in found.obligations], outcome.notes


@pytest.mark.slow
def test_what_is_too_stiff_is_refuted():
    found, status, _ = statuses(
        EXAMPLE, ControllerContext((0, 0), (SOFT[0], Fraction(90_000)), None)
    )
    assert found.verdict == "refuted"
    assert status.count(Status.REFUTED) == 3


@pytest.mark.parametrize(
    "more",
    rows(__file__, "test_what_other_nodes_of_the_file_say_of_the_law_is_not_passed_over"),
    ids=["all nodes", "any namespace", "the same name"],
)
def test_what_other_nodes_of_the_file_say_of_the_law_is_not_passed_over(tmp_path, more):
    """ROS 2 gives a node the parameters of wildcards, too; a default was taken for them."""
    file = changed(tmp_path, ("      filter_coefficient: 0.5\n", ""), more=more)
    found, status, _ = statuses(file, ControllerContext((0, 0), SOFT, None))
    assert found.verdict is None
    assert Status.ERROR in status
    assert "counts for admittance_controller, too" in found.obligations[0].message


def test_a_wildcard_is_no_controller_beside_those_that_it_means(tmp_path):
    """Each parameter was to be moved to the other of the two; and no controller is called `**`."""
    more = "/**:\n  ros__parameters: {admittance: {joint_damping: 3.0}}\n"
    file = changed(tmp_path, more=more)
    found, _, _ = statuses(file, ControllerContext((0, 2), SOFT, None))
    (only,) = [item for item in found.obligations if item.status is Status.ERROR]
    assert "write it at admittance_controller alone" in only.message


def test_every_controller_runs_at_the_rate_of_its_own_manager(tmp_path):
    text = changed(tmp_path).read_text()
    left, right = (text.replace("\n", "\n  ") for _ in range(2))
    file = tmp_path / "two.yaml"
    file.write_text(f"left:\n  {left}\nright:\n  {right.replace('500', '20')}\n")
    found, _, _ = statuses(file, ControllerContext((0, 2), SOFT, None))
    verdicts = {item.message.partition(":")[0]: item.status for item in found.obligations[::-1]
                if "axis x" in item.message}  # fmt: skip
    assert verdicts == {
        "left/admittance_controller": Status.PROVED,
        "right/admittance_controller": Status.REFUTED,
    }
    file.write_text(f"left:\n  {left}\nright:\n  {right.replace('500', '20')}\n".replace(
        "  admittance_controller:\n    ros", "  arm/admittance_controller:\n    ros"))  # fmt: skip
    with pytest.raises(SpecError, match="rate of the control loop"):
        statuses(file, ControllerContext((0, 2), SOFT, None))

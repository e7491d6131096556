"""Parameter files for tests."""

from fractions import Fraction

from nrs_design.ros2.axis import ControllerContext
from nrs_design.ros2.law import AXES, AdmittanceLaw, Axis
from nrs_design.ros2.parameters import RosNode
from nrs_design.spec.document import Position
from tests.support import ROOT, replaced

EXAMPLE = ROOT / "docs" / "examples" / "admittance.ros2.yaml"
PLACE = Position(1, 1)
NODE = RosNode("arm", PLACE, {}, {})
F = Fraction


def axis(mass, ratio, stiffness, *, selected=True, rotates=False):
    """An axis with numbers as text."""
    name = AXES[3] if rotates else AXES[0]
    return Axis(name, PLACE, selected, F(mass), F(ratio), F(stiffness))


def law(one, damping, c):
    """A law with one axis."""
    return AdmittanceLaw(NODE, (one,), F(damping), F(c), {})


def around(period, ages, stiffness, lag=(0, 0)):
    """ControllerContext in which all axes meet the same."""
    ends = F(stiffness[0]), F(stiffness[1])
    return ControllerContext(ages, ends, ends, (F(lag[0]), F(lag[1])), F(period))


def changed(tmp_path, *changes, more=""):
    """Write the example with some of its text replaced, and more of it."""
    file = tmp_path / "controllers.yaml"
    file.write_text(replaced(EXAMPLE.read_text(), *changes) + more)
    return file

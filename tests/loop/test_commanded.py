"""A velocity command on the loop of an impedance design."""

from fractions import Fraction

import pytest
from flint import fmpq, fmpq_mat

from nrs_design.controllers.float32 import to_float32
from nrs_design.errors import AssemblyError
from tests.search.support import thesis_robot

SOFT = ("41.5", "44.2")


def at_rest(A, B):
    """Solve ``A x + B = 0``."""
    n = len(A)
    left = fmpq_mat(n, n, [fmpq(e.numerator, e.denominator) for row in A for e in row])
    right = fmpq_mat(n, 1, [fmpq(-e.numerator, e.denominator) for (e,) in B])
    x = left.solve(right)
    return [Fraction(int(x[i, 0].p), int(x[i, 0].q)) for i in range(n)]


COMMAND = {"disturbances": "{command: 8 deg/s}"}


@pytest.mark.parametrize("Mt", ["0.01", "0"])
@pytest.mark.parametrize(
    ("tolerance", "load"), [("0", None), ("0.02", None), ("0", "1.213"), ("0.1", "1.213")]
)
def test_a_constant_command_ends_in_the_force_of_the_damping(Mt, tolerance, load):
    """At rest the admittance moves as commanded, ``F = Bt vc``, whatever motor and stiffness are.

    Thesis 6.2; the motor needs an error for that where the contact loads it, but no other force.
    """
    Bt = to_float32(Fraction("2.15"))
    system = thesis_robot(SOFT, ("2.15",), Mt, tolerance, load, **COMMAND)
    (channel,) = system.channels
    force = system.outputs[0]
    ends = {row.fractions()[0][-1] for row in force.rows}
    assert ends == {Fraction("41.5"), Fraction("44.2")}
    assert len(channel.columns) == len(system.modes) + len(system.contact.free)
    for mode, B in zip(system.modes, channel.columns, strict=False):
        rest = at_rest(mode.A.fractions(), B.fractions())
        stiffness = Fraction("41.5") if "k-min" in mode.name else Fraction("44.2")
        assert stiffness * rest[-1] == Bt


def test_a_free_axis_follows_the_command():
    """``omega = vc`` at rest; the error is what the motor needs to turn at that speed."""
    system = thesis_robot(SOFT, ("2.15",), "0.01", "0.02", "1.213", **COMMAND)
    for mode, B in zip(system.contact.free, system.channels[0].columns[-4:], strict=True):
        A = [row[:-1] for row in mode.A.fractions()[:-1]]
        assert at_rest(A, B.fractions()[:-1])[1] == 1


def test_a_spring_is_refused():
    """The command adds up to a position that the loop does not hold as a state."""
    gains = "2.15 N*m*s/rad, Kt: 0.5 N*m/rad, desired_impedance: 2"
    with pytest.raises(AssemblyError, match="the spring Kt draws the robot to"):
        thesis_robot(SOFT, (gains,), "0.01", **COMMAND)

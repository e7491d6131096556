"""The numbers of bounds for programs: on their safe side, and of the right statement."""

from dataclasses import replace
from fractions import Fraction

from nrs_design.certificates.bounds import bound_on, bounds_summary, keeps_command
from tests.proof.evidence.test_invariant_ellipsoid import BOUNCE
from tests.proof.graphs import common_quadratic
from tests.proof.systems import bouncing, pushed


def test_numbers_are_rounded_to_the_safe_side():
    system = pushed(bouncing(), Fraction(1, 7))
    level = replace(BOUNCE, level=Fraction(2, 3))
    proof = common_quadratic(((1, 0), (0, 1)), 0, Fraction(1))
    (found,) = bounds_summary(system, (proof, level))
    assert Fraction(found["level"]) >= Fraction(2, 3)
    (under,) = found["under"]
    assert Fraction(under["bound"]) <= Fraction(1, 7)
    assert under["name"] == "push"
    assert (found["output"], found["unit"], found["limit"]) == ("force", "N", 1.0)
    assert found["rounding_included"] is False
    (force, *others) = system.outputs
    # The float that is nearest to 11/10 is above it.
    odd = replace(system, outputs=(replace(force, limit=Fraction(11, 10)), *others))
    assert Fraction(bounds_summary(odd, (level,))[0]["limit"]) < Fraction(11, 10) < Fraction(1.1)


def test_the_bound_under_everything_at_once():
    system = pushed(bouncing())
    assert bound_on(system, (BOUNCE,), "force") == BOUNCE.bound(system)
    assert bound_on(system, (BOUNCE,), "velocity") is None
    wind = replace(system.channels[0], name="wind")
    both = replace(system, channels=(*system.channels, wind))
    assert bound_on(both, (BOUNCE,), "force") is None


def test_a_command_is_kept_where_rounding_is_covered_and_the_limit_is_not_passed():
    system = pushed(bouncing())
    (force, *others) = system.outputs
    named = replace(force, name="motor command", limit=BOUNCE.level)
    driven = replace(system, outputs=(named, *others))
    bound = replace(BOUNCE, output="motor command")
    rounded = replace(bound, roundings=(1,))
    assert keeps_command(driven, (rounded,))
    assert not keeps_command(driven, (bound,))
    assert not keeps_command(driven, (replace(rounded, level=2 * BOUNCE.level),))
    assert not keeps_command(system, (replace(BOUNCE, roundings=(1,)),))

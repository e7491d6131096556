"""What is asked about a robot: each kind with an example, which its option takes as it stands."""

from __future__ import annotations

from fractions import Fraction

from nrs_design.spec.quantity import QuantityKind

# The ends.
Range = tuple[Fraction, Fraction]

STIFFNESS = QuantityKind("a stiffness for translations", ("N/m",), "200..2000 N/m")
ROTATIONAL = QuantityKind("a stiffness for rotations", ("N*m/rad",), "5..40 N*m/rad")
LAG = QuantityKind("a time", ("s",), "5..20 ms")

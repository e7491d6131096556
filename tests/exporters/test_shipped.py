"""The law of an export, beside what its proof takes for granted."""

from fractions import Fraction

from nrs_design.controllers.float32 import exact_decimal
from nrs_design.controllers.shipped import shipped_law

PERIOD = Fraction(1, 500)


def test_every_coefficient_is_in_what_the_proof_takes_for_granted(sampled, sampled_export):
    """To the last digit, as the certificate lists them."""
    texts = " ".join(sampled_export.certificate.system.assumptions)
    law = shipped_law(sampled.spec, sampled_export.design, PERIOD)
    numbers = [n for c in law.coefficients for n in c.values if not c.name.endswith("_limit")]
    assert len(numbers) == 5
    assert all(f"= {exact_decimal(number)}" in texts for number in numbers)

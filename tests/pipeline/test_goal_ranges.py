"""A goal `delay` beyond the declared one is proved as if the spec declared it."""

import pytest

from nrs_design.errors import DesignError
from nrs_design.pipeline.design import declaring, run_analysis, wanted_age
from nrs_design.pipeline.free_gains import add_problems
from tests.tables import rows

from .free import freed

KP = "motion: {Kp: {min: 0.6, max: 1.6}}"


def wanting(delay):
    return freed(KP, ("contact: losable", f"contact: losable\ngoals: {{delay: {delay}}}"))


@pytest.mark.parametrize(("delay", "age"), rows(__file__, "test_ages_are_whole_samples"))
def test_ages_are_whole_samples(delay, age):
    assert wanted_age(wanting(delay)) == age


def test_an_age_that_is_not_modelled():
    with pytest.raises(DesignError, match="is 11 samples, and at most 10 are modelled"):
        wanted_age(wanting("20.1 ms"))


def test_a_design_as_if_the_spec_declared_it():
    designed = wanting("4 ms")
    later = declaring(designed, 2)
    assert designed.spec.sampling.delay == (0, 1)
    assert later.spec.sampling.delay == later.loaded.spec.sampling.delay == (0, 2)
    # Goals of controllers are held at every age, the oldest included.
    analysis = add_problems(later, run_analysis(designed))
    ages = {corner.place.texts for corner in analysis.impedance[0].requirement.corners}
    assert any("delay 2" in text for texts in ages for text in texts)
    assert later.spec.design.free == designed.spec.design.free

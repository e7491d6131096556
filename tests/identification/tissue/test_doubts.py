"""When a record does not determine a law, that is said."""

import numpy as np
import pytest

from nrs_design.identification.datasets.records import TissueRecord
from nrs_design.identification.tissue.output_error import fit_record
from nrs_design.models.contact import (
    LAWS,
    Elastic,
    HuntCrossley,
    KelvinBoltzmann,
    KelvinVoigt,
    Maxwell,
    Motion,
)
from tests.identification import synthetic
from tests.identification.support import quick, record, slow, source
from tests.tables import rows


def doubts(kind, law, motion, noise=0.01, resolution=0.0):
    return "; ".join(fit_record(kind, record(law, motion, noise, 5, resolution)).doubts)


LATE = Motion(slow().time[120:] - slow().time[120], slow().deflection[120:])


@pytest.mark.parametrize(
    ("kind", "law", "motion", "noise", "said"),
    [
        # Thesis table 2.4: the Maxwell nose relaxes in 106 s.
        (Maxwell, Maxwell(1.129, 120.233), slow(), 0.001,
         "the record (80 s) is shorter than the relaxation time (1"),
        (KelvinVoigt, Elastic(750.0), quick(), 0.1, "b has a relative standard error of"),
        (KelvinBoltzmann, Elastic(750.0), quick(), 0.1, "relative standard error"),
        (HuntCrossley, Elastic(0.5), slow(), 0.01, "phi is at the lower end"),
        (KelvinBoltzmann, synthetic.CONCHA, LATE, 0.01, "begins at"),
        (KelvinBoltzmann, synthetic.CONCHA, slow(), 0.01, ""),
    ],
    ids=["too short", "no damper", "no relaxation", "exponent", "loaded start", "sound"],
)  # fmt: skip
def test_what_a_record_does_not_determine(kind, law, motion, noise, said):
    text = doubts(kind, law, motion, noise)
    assert said in text
    assert bool(text) == bool(said)


@pytest.mark.parametrize(("times", "said"), rows(__file__, "test_another_unit_is_suspected"))
def test_another_unit_is_suspected(times, said):
    motion = quick()
    made = Motion(times[0] * motion.time, times[1] * motion.deflection)
    assert said in doubts(Elastic, Elastic(750.0 / times[1]), made)


@pytest.mark.parametrize(("parts", "said"), [(200, True), (3500, False)])
def test_rounding_that_moves_a_damping_by_half_its_error(parts, said):
    """Far less than a tenth of the power of the velocity, but seen in so long a record."""
    law = KelvinVoigt(0.574, 0.957)
    text = doubts(KelvinVoigt, law, slow(), 0.0114, 0.35 / parts)
    assert ("of the power of the velocity is rounding" in text) is said


def test_a_tissue_that_is_torn():
    """The force falls by a half while the probe goes on."""
    time = np.arange(3000) / 100
    force = 0.2 * time * np.where(time < 15, 1.0, 0.5)
    force += 0.02 * np.random.default_rng(0).standard_normal(3000)
    torn = TissueRecord(source("torn"), Motion(time, 0.0005 * time), force, False)
    for kind in LAWS.values():
        assert any("the residual is" in doubt for doubt in fit_record(kind, torn).doubts)

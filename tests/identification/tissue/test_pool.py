"""Several records of one tissue."""

import numpy as np
import pytest

from nrs_design.identification.statistics import student_quantile
from nrs_design.identification.tissue import fit_model
from nrs_design.models.contact import Elastic
from tests.identification import synthetic
from tests.identification.support import quick, record


def specimens(fits):
    return [
        record(Elastic(k), quick(seed), noise, seed, synthetic.COUNT)
        for seed, (k, noise) in enumerate(fits)
    ]


# Thesis 6.1 and reference means 747.14 and 1070.53 N/m.
@pytest.mark.parametrize(("fits", "mean"), [(synthetic.SOFT, 747.14), (synthetic.STIFF, 1070.53)])
def test_silicone(fits, mean):
    model = fit_model(Elastic, specimens(fits))
    (pooled,), (wide,) = model.estimates, model.ranges
    assert pooled.covers(mean)
    assert pooled.value == pytest.approx(mean, rel=5e-3)
    # The spread of the experiments is in the interval, not just the noise of each.
    logs = np.log([k for k, _ in fits])
    half = student_quantile(2) * logs.std(ddof=1) / np.sqrt(3)
    assert np.log(pooled.high / pooled.low) == pytest.approx(2 * half, rel=0.15)
    for (k, _), fit in zip(fits, model.fits, strict=True):
        assert fit.estimates[0].covers(k)
        assert wide.covers(k)
        assert wide.low <= fit.estimates[0].low <= fit.estimates[0].high <= wide.high


def test_one_record_stands_for_itself():
    model = fit_model(Elastic, specimens(synthetic.SOFT[:1]))
    assert model.estimates == model.fits[0].estimates == model.ranges

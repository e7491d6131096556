"""The generator, and the samples that are committed."""

import numpy as np
import pytest

from tests.identification import synthetic
from tests.support import ROOT

DATA = ROOT / "specs" / "data"
SAMPLES = dict(synthetic.samples())


def test_committed_samples_are_all_there():
    assert {path.name for path in DATA.glob("*.csv")} == set(SAMPLES)


@pytest.mark.parametrize("name", SAMPLES)
def test_committed_sample_is_what_the_generator_makes(name):
    committed = (DATA / name).read_text(encoding="utf-8").splitlines()
    made = SAMPLES[name].splitlines()
    assert committed[:2] == made[:2]
    assert "synthetic" in committed[0]
    assert "not a measurement" in committed[0]
    old, new = (np.loadtxt(lines[2:], delimiter=",") for lines in (committed, made))
    # Other builds of numpy may round the last digit differently.
    assert np.allclose(old, new, rtol=0, atol=1.1e-3)

"""Designs that are certified once for all tests of exports."""

import pytest

from nrs_design.exporters.export import Execution, export_design
from nrs_design.spec import read_spec
from tests.support import ROOT

CONTINUOUS = ROOT / "specs/neuroboscope/soft-tissue.nrs.yaml"


@pytest.fixture(scope="session")
def continuous():
    return read_spec(CONTINUOUS)


@pytest.fixture(scope="session")
def sampled(tmp_path_factory):
    """Insertion alone, every 2 ms, with a force sample of any of two ages."""
    head, _, _ = CONTINUOUS.read_text().partition("  withdrawal:")
    file = tmp_path_factory.mktemp("specs") / "sampled.nrs.yaml"
    file.write_text(f"{head}switching: arbitrary\nsampling: {{period: 2 ms, delay: [0, 1]}}\n")
    return read_spec(file)


@pytest.fixture(scope="session")
def continuous_export(continuous):
    return export_design(continuous)


@pytest.fixture
def record(continuous_export):
    return continuous_export.record


@pytest.fixture(scope="session")
def sampled_export(sampled):
    return export_design(sampled, execution=Execution())

"""What the report says of the passivity of impedance controllers."""

import pytest

from nrs_design.pipeline.design import run_analysis
from nrs_design.pipeline.runs import run_design
from nrs_design.reporting.document import Table
from nrs_design.reporting.sections.impedance import impedance_section
from nrs_design.spec import read_spec
from tests.support import ROOT


@pytest.mark.parametrize(("name", "said"), [("soft-tissue", True), ("soft-tissue-sampled", False)])
def test_the_band_is_that_of_the_loop_in_continuous_time_alone(name, said):
    designed = run_design(read_spec(ROOT / f"specs/neuroboscope/{name}.nrs.yaml"))
    section = impedance_section(designed, run_analysis(designed).impedance)
    (table,) = (block for block in section.blocks if isinstance(block, Table))
    labels = {row[0] for row in table.rows}
    assert ("Displayed admittance passive up to [Hz], exact" in labels) == said

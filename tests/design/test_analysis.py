"""What a design achieves, as people see it."""

from nrs_design.pipeline.analysis import run_analysis
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import read_spec
from tests.support import SOFT_TISSUE

# Thesis 6.1 as printed.
GIVEN = """motion_loop:
  transfer_function: {numerator: [0.99, 56.82], denominator: [0.0351, 1.99, 56.82]}
"""


def analysis(path):
    loaded = read_spec(path)
    return run_analysis(run_design(loaded))


def test_given_motion_loop(tmp_path):
    text = SOFT_TISSUE.read_text().replace("motion_loop:\n", GIVEN)
    path = tmp_path / "given.nrs.yaml"
    path.write_text(text)
    found = analysis(path)
    assert found.motion_source == "given"
    assert found.motion.numerator == (0.99, 56.82)

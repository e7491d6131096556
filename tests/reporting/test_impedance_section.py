"""What the report says of the passivity of impedance controllers."""

from nrs_design.pipeline import run_analysis, run_design
from nrs_design.reporting.document import Paragraph, Table
from nrs_design.reporting.sections.impedance import impedance_section
from nrs_design.spec import read_spec
from tests.support import ROOT

LABELS = (
    "Displayed admittance passive up to [Hz], exact",
    "The same, sampled [Hz], exact",
    "Sampled, not passive near [Hz]",
)


def rows_of(name):
    designed = run_design(read_spec(ROOT / f"specs/neuroboscope/{name}.nrs.yaml"))
    section = impedance_section(designed, run_analysis(designed).impedance)
    (table,) = (block for block in section.blocks if isinstance(block, Table))
    said = " ".join(block.text for block in section.blocks if isinstance(block, Paragraph))
    return {row[0]: [str(cell) for cell in row[1:]] for row in table.rows}, said


def test_bands_of_the_worst_age():
    """48.3287 and 42.1284 rad/s with the sample one period old, against 60.9 and 48.9 rad/s."""
    rows, said = rows_of("soft-tissue-sampled")
    assert [rows[label] for label in LABELS] == [
        ["9.691", "7.775"],
        ["7.690", "6.704"],
        ["7.693", "6.706"],
    ]
    assert "No law that samples a force is passive for every force" in said


def test_nothing_is_said_without_sampling():
    rows, said = rows_of("soft-tissue")
    assert LABELS[0] in rows
    assert not {*LABELS[1:]} & {*rows}
    assert "samples a force" not in said

"""What the report says of the passivity of impedance controllers."""

from nrs_design.pipeline.design import run_analysis
from nrs_design.pipeline.runs import run_design
from nrs_design.reporting.document import Paragraph, Table
from nrs_design.reporting.sections.impedance import impedance_section
from nrs_design.spec import LoadedSpec
from nrs_design.spec.load import parse_spec
from tests.support import ROOT, replaced

LABELS = (
    "Displayed admittance passive up to [Hz], exact",
    "Sampled: passive up to [Hz], exact",
    "Sampled, not passive near [Hz]",
)


SAMPLED = "soft-tissue-sampled"
# Of its motor, known to 2 %.
RANGED = (
    (
        "{nominal: 4.8417e-4 rad/s/rpm, range: [4.744866e-4 rad/s/rpm, 4.938534e-4 rad/s/rpm]}",
        "4.8417e-4 rad/s/rpm",
    ),
    ("{nominal: 0.0351 s, range: [0.034398 s, 0.035802 s]}", "0.0351 s"),
)


def rows_of(name, *replacements):
    text = replaced((ROOT / f"specs/neuroboscope/{name}.nrs.yaml").read_text(), *replacements)
    designed = run_design(LoadedSpec(path=name, sha256="", text=text, spec=parse_spec(text)))
    section = impedance_section(designed, run_analysis(designed).impedance)
    (table,) = (block for block in section.blocks if isinstance(block, Table))
    said = " ".join(block.text for block in section.blocks if isinstance(block, Paragraph))
    return {row[0]: [str(cell) for cell in row[1:]] for row in table.rows}, said


def test_bands_of_the_worst_age():
    """48.3287 and 42.1284 rad/s with the sample one period old."""
    rows, said = rows_of(SAMPLED, *RANGED)
    assert [rows[label] for label in LABELS[1:]] == [["7.690", "6.704"], ["7.693", "6.706"]]
    # That of the loop that is not sampled is another one's.
    assert LABELS[0] not in rows
    assert "No law that samples a force is passive for every force" in said


def test_what_is_not_computed_is_said_and_nothing_stands_in_its_place():
    rows, said = rows_of(SAMPLED)
    assert not {*LABELS} & {*rows}
    assert "is not computed with two periods, a spring Kt, late commands, a filter" in said


def test_nothing_is_said_without_sampling():
    rows, said = rows_of("soft-tissue")
    assert LABELS[0] in rows
    assert not {*LABELS[1:]} & {*rows}
    assert "samples a force" not in said

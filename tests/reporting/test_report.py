from fractions import Fraction

import numpy as np
import pytest

from nrs_design.errors import DesignError
from nrs_design.pipeline.design import run_analysis
from nrs_design.pipeline.runs import run_certification
from nrs_design.reporting import build_report
from nrs_design.reporting.document import Bullets, Listing, Paragraph, Table
from nrs_design.reporting.figures.run import draw_run
from nrs_design.search.method import Method
from nrs_design.simulation.switched import SwitchedRun
from nrs_design.spec import read_spec
from tests.reporting.conftest import KINDS, ROOT, cases
from tests.support import COMMUTING, GIVEN, SOFT_TISSUE, family, replaced, spec_in, write_spec
from tests.tables import entry

# Figures by their names, in order.
FIGURES = dict.fromkeys(KINDS, "eigenvalues run") | {
    "proved": "root-locus displayed-impedance sensitivity eigenvalues run worst-case",
    "force": "root-locus force-locus-force eigenvalues run",
    "refuted": "eigenvalues run",
    "resets": "eigenvalues",
    "mixture": "eigenvalues",
    "discrete": "eigenvalues run",
    "marginal": "eigenvalues run",
}
del FIGURES["inconclusive-leaving"]


def words(report):
    parts = [report.claim, *report.remarks, *(f"{label}: {value}" for label, value in report.facts)]
    for section in report.sections:
        parts.append(section.title)
        for block in section.blocks:
            match block:
                case Paragraph(text):
                    parts.append(text)
                case Table(title, columns, rows):
                    parts += [title, *columns, *(cell for row in rows for cell in row)]
                case Bullets(title, items) | Listing(title, items):
                    parts += [title, *items]
                case _:
                    parts += [block.title, block.caption]
    return "\n".join(parts)


def lines(illustration):
    return {line.get_label(): line for line in illustration.figure.axes[0].get_lines()}


def table_of(report, title):
    section = next(part for part in report.sections if part.title == title)
    return next(block for block in section.blocks if isinstance(block, Table))


def figure(report, name):
    return next(item for item in report.illustrations if item.name == name)


@pytest.mark.parametrize("case", cases(FIGURES))
def test_every_case_has_its_figures_in_order_with_a_unit_at_every_axis(report, case):
    found = [*report(case).illustrations]
    assert [item.name for item in found] == FIGURES[case].split()
    for item in found:
        axes = item.figure.axes
        lowest = axes[-1] if item.name in ("run", "worst-case") else axes[0]
        labels = [lowest.get_xlabel(), axes[0].get_ylabel()]
        assert all("[" in label and label.endswith("]") for label in labels), (item.name, labels)
        assert item.caption.endswith("."), item.name


@pytest.mark.slow
def test_worst_values_stand_beside_the_goals(tmp_path):
    goals = "goals: {max_sensitivity_peak: 2, min_delay_margin: 5 ms}\nswitching:"
    path = spec_in(tmp_path, replaced(SOFT_TISSUE.read_text(), *GIVEN, ("switching:", goals)))
    result = run_certification(read_spec(path), method=Method.LMI)
    found = build_report(result, run_analysis(result.designed))
    table = table_of(found, "Design goals")
    rows = {row[:2]: row[2:] for row in table.rows}
    where = "soft, k = 44.2466 N·m/rad"
    assert rows["insertion", "sensitivity peak Ms"] == ("at most 2", "3.753", where, "MISSED")
    assert rows["insertion", "delay margin"] == ("at least 5 ms", "9.89 ms", where, "met")
    assert rows["insertion", "disk margin"][0] == "–"
    lights = {light.name: light.text for light in found.lights}
    assert lights["Goals"] == "2 of 4 missed (floating point)"
    text = words(found)
    assert "not a proof; between corners a goal is looked at in some points" in text
    assert "insertion: factor off the desired impedance 2.066 (usual: at most 2)" in text


def test_proved_report_says_what_is_not_covered(report):
    text = words(report("proved"))
    for topic in ("Sampling", "Friction", "saturation", "contact", "outside the declared ranges"):
        assert topic in text
    assert "floating-point illustrations and no part of the proof" in text
    assert "nrs-design verify soft-tissue.cert.json soft-tissue.nrs.yaml" in text


@pytest.mark.slow
def test_what_is_proved_is_not_listed_as_left_out():
    result = run_certification(read_spec(ROOT / "specs/neuroboscope/soft-tissue-sampled.nrs.yaml"))
    text = words(build_report(result))
    assert "What the processor rounds" not in text
    assert "Coupling between the axes" in text


def test_refuted_report_shows_the_witness_and_no_bound(report):
    refuted = report("refuted")
    assert refuted.verdict == "refuted"
    assert "Mode insertion is not Hurwitz" in refuted.claim
    assert "10.6523" in refuted.claim
    run = lines(figure(refuted, "run"))
    assert "run" in run
    assert not any("bound" in label for label in run)
    assert run["run"].get_ydata().max() > 30
    marked = lines(figure(refuted, "eigenvalues"))["not in the stable region"]
    assert (marked.get_xdata() > 0).all()
    assert "Lyapunov evidence" not in words(refuted)


def test_inconclusive_report_says_so_plainly(report):
    inconclusive = report("inconclusive")
    text = words(inconclusive)
    assert inconclusive.verdict == "inconclusive"
    assert "Neither a proof nor a refutation was found" in inconclusive.claim
    assert "The 2 modes" in text
    assert "mode quadratic" in text
    assert "period" in text
    assert "proved bound" not in str(list(lines(figure(inconclusive, "run"))))
    assert "says nothing about stability" in text
    assert "a longer dwell time or fewer transitions" in text
    assert report("inconclusive-leaving").verdict == "inconclusive"


@pytest.mark.parametrize(
    "case", cases(("proved", "force", "discrete", "polynomial", "dwell", "parameter"))
)
def test_simulated_run_stays_below_its_bound(report, case):
    curves = lines(figure(report(case), "run"))
    bound = next(line for label, line in curves.items() if label.startswith("proved bound"))
    assert (curves["run"].get_ydata() <= bound.get_ydata() * (1 + 1e-9)).all()


@pytest.mark.slow
def test_given_motion_loop_is_named(tmp_path):
    # Thesis 6.1 prints G with these rounded coefficients.
    text = SOFT_TISSUE.read_text().replace(
        "  derivative_gain: 2060 rpm*s/rad\n  zero: 56.9706 1/s\n",
        "  transfer_function:\n    numerator: [0.99, 56.82]\n"
        "    denominator: [0.0351, 1.99, 56.82]\n",
    )
    loaded = read_spec(spec_in(tmp_path, text, "printed"))
    result = run_certification(loaded)
    text = words(build_report(result, run_analysis(result.designed)))
    assert "G(s) = (0.99 s + 56.82) / (0.0351 s^2 + 1.99 s + 56.82)" in text
    assert "The spec states this G itself" in text


def test_unstable_force_loop_is_reported_without_margins(tmp_path):
    text = (ROOT / "specs/neuroboscope/force-limit.nrs.yaml").read_text()
    text = text.replace(
        "settling_time: 0.1404 s\n  derivative_gain: 2060 rpm*s/rad\n  zero: 56.9706 1/s\n",
        "settling_time: 0.1404 s\n  transfer_function: {numerator: [1], denominator: [1, 1, -1]}\n",
    )
    loaded = read_spec(spec_in(tmp_path, text, "unstable"))
    result = run_certification(loaded)
    with pytest.raises(DesignError):
        run_analysis(result.designed)
    unstable = build_report(result, None)
    assert unstable.verdict == "refuted"
    gains = next(part for part in unstable.sections if part.title == "Designed gains")
    assert Fraction(gains.blocks[0].rows[1][4]) > 0


@pytest.mark.slow
def test_many_modes_are_shortened(tmp_path):
    loaded = write_spec(tmp_path / "many.nrs.yaml", *([[-i, 1], [-1, -2]] for i in range(1, 41)))
    many = build_report(run_certification(loaded))
    assert "The 40 modes, the 24 slowest of them" in words(many)


SAID = entry(__file__, "SAID")


@pytest.mark.parametrize("case", cases(SAID))
def test_head_and_box_fit_the_kind_of_evidence(report, case):
    head, box = SAID[case]
    facts = "\n".join(f"{label}: {value}" for label, value in report(case).facts)
    first = next(section for section in report(case).sections if section.boxed)
    said = "\n".join(
        "\n".join(block.items) if isinstance(block, Bullets) else block.text
        for block in first.blocks
    )
    assert [text for text in head if text not in facts] == []
    assert [text for text in box if text not in said] == []


@pytest.mark.parametrize("case", cases(["period", "word", "dwell-refuted"]))
def test_witness_grows_from_period_to_period(report, case):
    curves = lines(figure(report(case), "run"))
    line = next(curve for label, curve in curves.items() if label.startswith("factor"))
    assert float(line.get_label().split()[1]) > 1
    norm, expected = curves["run"].get_ydata(), line.get_ydata()
    assert norm[-1] == pytest.approx(expected[-1], rel=1e-6)
    assert norm[-1] > 1


def test_factor_of_the_word_is_that_of_the_golden_ratio(report):
    # 0.49 times the larger eigenvalue of [[2, 1], [1, 1]].
    text = words(report("word"))
    assert f"grows by the factor {0.49 * (3 + 5**0.5) / 2:.6g}" in text
    assert "growth rate" not in text
    assert "a mean growth rate of" in words(report("period"))


def test_mixture_shows_the_eigenvalue_of_the_average(report):
    assert "Eigenvalues of the average: " in words(report("mixture"))


def test_dwell_run_keeps_the_dwell_time(report):
    below = figure(report("dwell"), "run").figure.axes[1]
    spans = [
        (path.vertices[:, 0].min(), path.vertices[:, 0].max())
        for row in below.collections
        for path in row.get_paths()
    ]
    last = max(end for _, end in spans)
    assert len(spans) > 4
    assert all(end - begin >= 2.76 - 1e-9 for begin, end in spans if end < last)


def test_obstruction_weights_sum_to_one(report):
    table = table_of(report("polynomial"), "No common quadratic function")
    assert {row[0] for row in table.rows} <= {"a", "b"}
    assert sum(float(row[1]) for row in table.rows) == pytest.approx(1, abs=1e-3)


def test_declared_rules_that_a_proof_does_not_need_are_named(tmp_path):
    path = spec_in(tmp_path, COMMUTING.read_text().replace("arbitrary", "{dwell_time: 1 s}"), "c")
    text = words(build_report(run_certification(read_spec(path))))
    assert "The proof does not need the declared rules of switching" in text
    assert "The run switches freely, which is more than the spec allows." in text


def test_modes_without_a_row_of_their_own_are_named_together():
    """A cycle through 30 modes, of which none is stable alone."""
    loaded = family(*([[-1 - i, 1], [-1, -1 - i]] for i in range(30)))
    count = len(loaded.modes)
    response = SwitchedRun(np.arange(count + 1.0), np.ones((count + 1, 2)), np.arange(count))
    drawn = draw_run(response, np.ones(count + 1), None, loaded, "norm [1]")
    rows = [row.get_text() for row in drawn.axes[1].get_yticklabels()]
    assert rows == [*(f"m{i}" for i in range(23)), "7 other modes"]

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.errors import DesignError
from nrs_design.pipeline import run_certification, run_evidence
from nrs_design.reporting import build_report
from nrs_design.reporting.document import Bullets, Paragraph, Table
from nrs_design.spec import read_spec
from tests.reporting.conftest import ROOT

FIGURES = {
    "proved": [
        "root-locus",
        "displayed-impedance",
        "sensitivity",
        "eigenvalues",
        "quadratic",
        "mode-rates",
        "run",
    ],
    "force": [
        "root-locus",
        "force-locus-force",
        "eigenvalues",
        "quadratic",
        "mode-rates",
        "run",
        "phase-plane",
    ],
    "refuted": ["eigenvalues", "run"],
    "inconclusive": ["eigenvalues", "run", "phase-plane"],
    "discrete": ["eigenvalues", "quadratic", "mode-rates", "run", "phase-plane"],
    "marginal": ["eigenvalues", "run", "phase-plane"],
}


def words(report):
    """All text of a report in one string."""
    parts = [report.claim]
    for section in report.sections:
        parts.append(section.title)
        for block in section.blocks:
            if isinstance(block, Paragraph):
                parts.append(block.text)
            elif isinstance(block, Bullets):
                parts += [block.title, *block.items]
            elif isinstance(block, Table):
                parts += [
                    block.title,
                    *block.columns,
                    *(cell for row in block.rows for cell in row),
                ]
            else:
                parts += [block.title, block.caption]
    return "\n".join(parts)


def lines(illustration):
    """Labelled curves of the first axes."""
    return {line.get_label(): line for line in illustration.figure.axes[0].get_lines()}


def figure(report, name):
    return next(item for item in report.illustrations if item.name == name)


@pytest.mark.parametrize("case", FIGURES)
def test_every_case_has_its_figures_in_order(report, case):
    assert [item.name for item in report(case).illustrations] == FIGURES[case]


@pytest.mark.parametrize("case", FIGURES)
def test_every_axis_is_labelled_with_its_unit(report, case):
    for item in report(case).illustrations:
        axes = item.figure.axes
        below = axes[-1].get_xlabel() if item.name == "run" else axes[0].get_xlabel()
        labels = [below, axes[0].get_ylabel()]
        assert all(labels), item.name
        if item.name == "quadratic":
            labels = [axes[1].get_ylabel()]
        elif item.name == "mode-rates":
            labels = [below]
        assert all("[" in label and label.endswith("]") for label in labels), (item.name, labels)
        assert item.caption.endswith("."), item.name


@pytest.mark.parametrize(
    ("case", "section", "label", "published", "tolerance"),
    [
        # Thesis 6.3.2.1: insertion and withdrawal.
        ("proved", "Impedance control", "Bt as shipped [N·m·s/rad]", (2.15, 1.04), 1e-9),
        ("proved", "Impedance control", "Mt as shipped [kg·m²]", (0.01, 0.01), 1e-9),
        # Thesis 6.3.3.1.
        ("force", "Force control", "Damping ratio [1]", (0.741,), 5e-4),
        ("force", "Force control", "Natural frequency [rad/s]", (54.9,), 0.05),
    ],
)
def test_published_values(report, case, section, label, published, tolerance):
    part = next(part for part in report(case).sections if part.title == section)
    table = next(block for block in part.blocks if isinstance(block, Table))
    row = next(row for row in table.rows if row[0] == label)
    assert [float(cell) for cell in row[1:]] == pytest.approx(published, abs=tolerance)


def test_source_of_the_motion_loop_is_named(report):
    text = words(report("proved"))
    assert "G(s) = (0.99739 s + 56.82" in text
    assert "whose derivative gain and zero the spec gives" in text


def test_proved_report_says_what_is_not_covered(report):
    text = words(report("proved"))
    for topic in ("Sampling", "Friction", "saturation", "contact", "outside the declared ranges"):
        assert topic in text
    assert "floating-point illustrations and no part of the proof" in text
    assert "nrs-design verify soft-tissue.cert.json soft-tissue.nrs.yaml" in text


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


def test_marginal_mode_neither_grows_nor_decays(report):
    norm = lines(figure(report("marginal"), "run"))["run"].get_ydata()
    assert norm == pytest.approx(1.0)
    assert "not Schur" in report("marginal").claim


def test_inconclusive_report_says_so_plainly(report):
    inconclusive = report("inconclusive")
    text = words(inconclusive)
    assert inconclusive.verdict == "inconclusive"
    assert "Neither a proof nor a refutation was found" in inconclusive.claim
    assert "The 2 modes" in text
    assert "lmi" in text
    assert "gradient" in text
    assert "proved bound" not in str(list(lines(figure(inconclusive, "run"))))
    assert "There is no certificate to check" in text


@pytest.mark.parametrize("case", ["proved", "force", "discrete"])
def test_simulated_run_stays_below_its_bound(report, case):
    curves = lines(figure(report(case), "run"))
    bound = next(line for label, line in curves.items() if label.startswith("proved bound"))
    assert (curves["run"].get_ydata() <= bound.get_ydata() * (1 + 1e-9)).all()


def test_times_of_the_search_are_left_out(report):
    search = next(part for part in report("proved").sections if part.title == "Search")
    assert [block.columns for block in search.blocks] == [("Step", "Outcome")]


def test_without_evidence_only_the_gains_are_shown():
    result = run_certification(read_spec(ROOT / "specs/neuroboscope/soft-tissue.nrs.yaml"))
    bare = build_report(result)
    assert "What the gains achieve is not shown" in words(bare)
    assert "sensitivity" not in [item.name for item in bare.illustrations]


def test_given_motion_loop_is_named(tmp_path):
    # Thesis 6.1 prints G with these rounded coefficients.
    text = (ROOT / "specs/neuroboscope/soft-tissue.nrs.yaml").read_text()
    text = text.replace(
        "  derivative_gain: 2060 rpm*s/rad\n  zero: 56.9706 1/s\n",
        "  transfer_function:\n    numerator: [0.99, 56.82]\n"
        "    denominator: [0.0351, 1.99, 56.82]\n",
    )
    path = tmp_path / "printed.nrs.yaml"
    path.write_text(text)
    loaded = read_spec(path)
    result = run_certification(loaded)
    text = words(build_report(result, run_evidence(loaded, result.design)))
    assert "G(s) = (0.99 s + 56.82) / (0.0351 s^2 + 1.99 s + 56.82)" in text
    assert "The spec states this G itself" in text


def test_unstable_force_loop_is_reported_without_margins(tmp_path):
    text = (ROOT / "specs/neuroboscope/force-limit.nrs.yaml").read_text()
    text = text.replace(
        "settling_time: 0.1404 s\n  derivative_gain: 2060 rpm*s/rad\n  zero: 56.9706 1/s\n",
        "settling_time: 0.1404 s\n  transfer_function: {numerator: [1], denominator: [1, 1, -1]}\n",
    )
    path = tmp_path / "unstable.nrs.yaml"
    path.write_text(text)
    loaded = read_spec(path)
    result = run_certification(loaded)
    with pytest.raises(DesignError):
        run_evidence(loaded, result.design)
    unstable = build_report(result, None)
    assert unstable.verdict == "refuted"
    assert Fraction(unstable.sections[1].blocks[0].rows[1][4]) > 0


def test_many_modes_are_shortened(report, tmp_path):
    modes = "\n".join(f"  - {{name: m{i}, A: [[-{i + 1}, 1], [0, -2]]}}" for i in range(40))
    path = tmp_path / "many.nrs.yaml"
    path.write_text(
        f"kind: switched-system\nname: many\ntime: continuous\nmodes:\n{modes}\n"
        "switching: arbitrary\n"
    )
    many = build_report(run_certification(read_spec(path)))
    assert "The 40 modes, the 24 slowest of them" in words(many)
    assert "24 with the least slack" in words(many)


def test_titles_and_names_stay_with_the_spec(report):
    discrete = report("discrete")
    assert discrete.name == "sampled"
    assert replace(discrete, title="").title == ""

"""A cell of the map says what a spec with that stiffness and those ages says."""

from dataclasses import replace

import pytest

from nrs_design.certificates.certificate import Verdict
from nrs_design.errors import DesignError
from nrs_design.pipeline import run_certification, search_limits
from nrs_design.pipeline.stability_map import run_stability_map
from nrs_design.spec import read_spec
from tests.support import ROOT, SOFT_TISSUE

SAMPLED = "sampling: {period: 2 ms, delay: [0, 1]}\n"
AT_ONCE = ROOT / "docs" / "examples" / "tissue-and-tool-at-once.nrs.yaml"


def certified(tmp_path, change, name="a"):
    path = tmp_path / f"{name}.nrs.yaml"
    path.write_text(change(SOFT_TISSUE.read_text(encoding="utf-8")) + SAMPLED, encoding="utf-8")
    loaded = read_spec(path)
    return run_certification(loaded, limits=search_limits(loaded.spec, optimize_rate=False))


def test_a_loop_that_is_not_sampled_has_no_map():
    with pytest.raises(DesignError, match="is for sampled loops") as caught:
        run_stability_map(run_certification(read_spec(SOFT_TISSUE)))
    assert caught.value.line


def test_contacts_at_once_have_no_map(tmp_path):
    text = AT_ONCE.read_text(encoding="utf-8")
    path = tmp_path / "a.nrs.yaml"
    path.write_text(text + SAMPLED, encoding="utf-8")
    result = run_certification(read_spec(path))
    with pytest.raises(DesignError, match="one at a time"):
        run_stability_map(result)


@pytest.mark.slow
def test_cells_say_what_specs_say(tmp_path):
    result = certified(tmp_path, lambda text: text)
    limits = replace(search_limits(result.loaded.spec), budget=3.0)
    found = run_stability_map(result, limits)
    ((name, low, high),) = found.contacts
    assert (name, found.shortest, found.delay) == ("soft", 0, 1)
    assert found.verdicts[found.delays.index(1), found.factors.index(1)] is Verdict.PROVED
    by_verdict = {
        verdict: [cell for cell, v in found.verdicts.items() if v is verdict and cell[0] == 1]
        for verdict in (Verdict.PROVED, Verdict.REFUTED)
    }
    edges = {Verdict.PROVED: max, Verdict.REFUTED: min}
    for verdict, edge in edges.items():
        _, column = edge(by_verdict[verdict])
        # 0.24 m is the arm: N m/rad over its square is N/m.
        ends = [float(end) / 0.24**2 for end in (low, found.factors[column] * high)]

        def change(text, ends=ends):
            old = "stiffness: {nominal: 747.1461 N/m, range: [720.56 N/m, 768.17 N/m]}"
            assert old in text
            low, high = (f"{end:.6f} N/m" for end in ends)
            return text.replace(
                old, f"stiffness: {{nominal: 747.1461 N/m, range: [{low}, {high}]}}"
            )

        assert certified(tmp_path, change, str(verdict)).certification.verdict is verdict

"""The library at the door."""

import doctest
import subprocess
import sys
from fractions import Fraction

import control
import numpy as np
import pytest

import nrs_design as nrs
from nrs_design import api
from nrs_design.errors import DesignError, OutputError, SpecError
from tests.support import FORCE_LIMIT, ROOT, SOFT_TISSUE

# Dayawansa and Martin 1999: a = 5 has a common quadratic function, a = 6 has none and is stable,
# a = 12 is not stable.
ROTATION = [[-1, -1], [1, -1]]


def pair(a):
    return [ROTATION, [[-1, -a], [Fraction(1, a), -1]]]


@pytest.mark.parametrize(
    ("a", "verdict", "common_quadratic"),
    [
        (5, "proved", "exists"),
        (6, "proved", "impossible"),
        (12, "refuted", "impossible"),
    ],
)
def test_known_answers(a, verdict, common_quadratic):
    decision = nrs.certify(pair(a))
    assert (decision.verdict, decision.common_quadratic) == (verdict, common_quadratic)
    assert (decision.decay_rate is not None) == (verdict == "proved")
    assert decision.claim in str(decision)
    assert decision.attempts
    assert decision.assumptions[0].startswith("The modes are the matrices")


def test_ways_to_give_the_same_modes():
    texts = nrs.certify([[["-1", "-1"], ["1", "-1"]], [["-1", "-5"], ["1/5", "-1"]]])
    exact = nrs.certify({"m1": ROTATION, "m2": pair(5)[1]})
    assert texts.decay_rate == exact.decay_rate
    floats = nrs.certify([np.array(ROTATION), np.array([[-1, -5], [0.2, -1]])])
    (_, second) = floats.result.certification.system.modes
    assert second.A.fractions()[1][0] == Fraction(0.2) != Fraction(1, 5)


def test_state_spaces_decide_the_time():
    # Ando and Shih 1998, scale 0.7: stable in discrete time.
    matrices = ([[0.7, 0], [0.7, 0]], [[0, 0.7], [0, -0.7]])
    sampled = [control.ss(A, [[0], [0]], [[0, 0]], 0, 0.002) for A in matrices]
    decision = nrs.certify(sampled)
    assert decision.verdict == "proved"
    assert 0 < decision.decay_rate < 1
    assert "x+ = A x" in decision.claim


def test_constrained_switching():
    # Geromel and Colaneri 2006: stable from a dwell time of about 2.75 s on.
    modes = {"a": [[0, 1], [-10, -1]], "b": [[0, 1], ["-0.1", "-0.5"]]}
    assert nrs.certify(modes, dwell_time="2.76 s").verdict == "proved"
    assert nrs.certify(modes, dwell_time=2).verdict == "refuted"
    assert nrs.certify(modes, transitions=[]).verdict == "proved"


def test_resets_and_parameters():
    decay = {"a": [[-1]], "b": [[-2]]}
    halves = {("a", "b"): [[0.5]], ("b", "a"): [[0.5]]}
    assert nrs.certify(decay, resets=halves).verdict == "proved"
    stretched = nrs.certify([[["-1 - k", 0], [0, -1]]], parameters={"k": (0, 1)})
    assert stretched.verdict == "proved"
    nominal = {"nominal": 0, "range": (0, "1/3"), "varies": "false"}
    assert nrs.certify([[["-1 - k"]]], parameters={"k": nominal}).verdict == "proved"


def test_stays_of_single_modes():
    """An unstable mode that is left in time, and a stable one that lasts: exp(0.5 - 1) < 1."""
    modes = {"up": [[1]], "down": [[-1]]}
    rules = {"longest_dwell_time": {"up": "0.5 s"}, "dwell_time": {"down": 1}}
    assert nrs.certify(modes, **rules).verdict == "proved"
    assert nrs.certify(modes, **(rules | {"dwell_time": {"down": 0.25}})).verdict == "refuted"


def test_several_resets_between_two_modes():
    """Either of them may happen, so the growing one decides."""
    modes, small, large = [[[-1]], [[-2]]], np.array([[0.5]]), [[3]]
    both = {("m1", "m2"): [small, large], ("m2", "m1"): [[1]]}
    assert nrs.certify(modes, resets=both | {("m1", "m2"): small}).verdict == "proved"
    for maps in ([small, large], (large, small), [[["0.5"]], large]):
        assert nrs.certify(modes, resets=both | {("m1", "m2"): maps}).verdict == "refuted"


def test_names_may_be_numbers():
    rules = {"dwell_time": {1: 2}, "transitions": [(1, 2)], "resets": {(1, 2): [[3]]}}
    assert nrs.certify({1: [[-1]], 2: [[-2]]}, **rules).verdict == "proved"


def test_save_and_verify(tmp_path):
    file = nrs.certify(pair(6), name="pair").save(tmp_path)
    assert file == tmp_path / "pair.cert.json"
    assert nrs.verify(file, tmp_path / "pair.nrs.yaml").fault is None
    other = nrs.certify(pair(5), name="pair")
    other.save(tmp_path / "other")
    assert nrs.verify(file, tmp_path / "other" / "pair.nrs.yaml").fault is not None


def test_a_file_is_no_folder(tmp_path):
    """What looks like a file would become a folder of that name."""
    with pytest.raises(OutputError, match=r"name of a file; .*pair\.cert\.json"):
        nrs.certify(pair(6), name="pair").save(tmp_path / "mine.cert.json")
    assert not list(tmp_path.iterdir())


def test_unknown_method():
    with pytest.raises(DesignError, match="no method 'foo'"):
        nrs.certify(pair(6), method="foo")


def test_saving_overwrites_no_other_spec(tmp_path, monkeypatch):
    """Neither where the files go, nor in the working folder, where one has the same name."""
    spec, place = tmp_path / "pair.nrs.yaml", tmp_path / "place"
    text = (ROOT / "specs/examples/commuting.nrs.yaml").read_text().replace("commuting", "pair")
    spec.write_text(text)
    decision = nrs.certify(pair(6), name="pair")
    with pytest.raises(OutputError, match="is another spec"):
        decision.save(tmp_path)
    assert spec.read_text() == text
    assert not (tmp_path / "pair.cert.json").exists()
    monkeypatch.chdir(tmp_path)
    assert nrs.verify(decision.save(place), place / "pair.nrs.yaml").fault is None
    decision.save(place)
    assert spec.read_text() == text


def test_nothing_shown_is_not_saved(tmp_path):
    inconclusive = nrs.certify(pair(6), method="lmi")
    assert inconclusive.verdict == "inconclusive"
    with pytest.raises(OutputError, match="no certificate"):
        inconclusive.save(tmp_path)
    assert not list(tmp_path.iterdir())


def test_figures_and_page(tmp_path):
    decision = nrs.certify(pair(5))
    assert decision.plot().axes
    with pytest.raises(DesignError, match="no figure 'nope'"):
        decision.plot("nope")
    other = tmp_path / "thesis.html"
    other.write_text("mine")
    with pytest.raises(OutputError, match="not overwritten"):
        decision.report(other)
    assert other.read_text() == "mine"
    page = decision.report(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text() == page
    shown = decision._repr_html_()
    assert "PROVED" in shown
    assert "<script" not in shown


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (([],), "no modes"),
        (([[[1, 2]]],), "not square"),
        (([[[1, 2], [3]]],), "different lengths"),
        (([[[float("nan")]]],), "not a finite"),
        (([[[1]], [[1, 0], [0, 1]]],), "states"),
        (({"a b": [[1]]},), "not a name"),
    ],
)
def test_wrong_input_is_told_in_words(arguments, said):
    with pytest.raises(SpecError, match=said) as caught:
        nrs.certify(*arguments)
    assert caught.value.line is None


def test_wrong_options():
    with pytest.raises(SpecError, match="two ends"):
        nrs.certify([[["k"]]], parameters={"k": 3})
    with pytest.raises(SpecError) as caught:
        nrs.certify([[["-1 - k"]]])
    assert caught.value.remedy == "name what is uncertain: parameters={'k': (lowest, highest)}"
    with pytest.raises(SpecError, match="comma") as caught:
        nrs.certify([[["1,5"]]])
    assert "parameters" not in str(caught.value.remedy)
    with pytest.raises(SpecError, match="time"):
        nrs.certify([[[-1]]], time="now")
    with pytest.raises(SpecError, match="there is no mode"):
        nrs.certify([[[-1]], [[-2]]], transitions=[("m1", "m9")])
    for transitions in (["m1", "m2"], "m1"):
        with pytest.raises(SpecError, match="expected two names"):
            nrs.certify([[[-1]], [[-2]]], transitions=transitions)


@pytest.mark.parametrize(
    "matrix", [-np.eye(2), [[-1, 0], [0, -1]], control.ss(-np.eye(2), np.eye(2), np.eye(2), 0)]
)
def test_one_matrix_is_no_list_of_modes(matrix):
    for ask in (nrs.certify, lambda modes: nrs.check_lyapunov(modes, [[1, 0], [0, 1]])):
        with pytest.raises(SpecError, match="one matrix") as caught:
            ask(matrix)
        assert "[A]" in caught.value.remedy
    assert nrs.certify([matrix]).verdict == "proved"


def test_check_lyapunov_says_where_it_fails():
    good = nrs.check_lyapunov(pair(5), [[1, 0], [0, 5]])
    assert good.holds
    bad = nrs.check_lyapunov(pair(5), np.eye(2))
    assert bad.counterexample.mode == "m2"
    # Only the symmetric part of P counts.
    assert nrs.check_lyapunov(pair(5), [[1, 1], [-1, 5]]) == good
    with pytest.raises(SpecError, match="P is not a matrix"):
        nrs.check_lyapunov(pair(5), 3)
    for P in ([[1, 0]], [[1]]):
        with pytest.raises(Exception, match="x") as caught:
            nrs.check_lyapunov(pair(5), P)
        assert isinstance(caught.value, nrs.api.NrsDesignError)


def test_a_study_of_a_spec(tmp_path):
    study = nrs.load(SOFT_TISSUE)
    assert [c.name for c in study.design().controllers] == ["insertion", "withdrawal"]
    decision = study.certify(coordinates="deflection")
    assert decision.verdict == "proved"
    decision.save(tmp_path)
    # The spec is a file already, so no second copy is made.
    assert [file.name for file in tmp_path.iterdir()] == ["soft-tissue.cert.json"]
    assert study.export(tmp_path / "soft-tissue.cert.json").verdict == "proved"
    assert nrs.verify(tmp_path / "soft-tissue.cert.json", FORCE_LIMIT).fault is not None


def test_import_loads_nothing_heavy():
    code = (
        "import sys, nrs_design; print(sorted({'numpy', 'pydantic', 'scipy'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
    assert set(nrs.__all__) <= set(dir(nrs))
    with pytest.raises(AttributeError, match="no attribute 'nope'"):
        _ = nrs.nope


def test_examples_in_docstrings(monkeypatch):
    monkeypatch.chdir(ROOT)
    found = doctest.testmod(api)
    assert found.attempted >= 6
    assert found.failed == 0


def test_the_readme_runs_as_it_stands():
    text = (ROOT / "README.md").read_text()
    code = text.partition("## From Python\n\n```python\n")[2].partition("```")[0]
    names: dict[str, object] = {}
    exec(code, names)
    assert names["decision"].verdict == "proved"


def test_scenarios_are_simulated():
    study = nrs.load(ROOT / "docs/examples/scenarios.nrs.yaml")
    switched, not_switched = study.simulate("withdrawal-switched", "withdrawal-not-switched")
    (sooner,), (later,) = (one.metrics["withdrawal_times"] for one in (switched, not_switched))
    # Thesis 6.3.2.3 measures about 20 %, from torques that it does not print.
    assert 1 - sooner / later == pytest.approx(0.289, abs=0.002)
    (one,) = study.simulate("shaken", period=0.001)
    assert one.run.sampling == (0.001, 0, 0)
    with pytest.raises(DesignError, match="no engine"):
        study.simulate(engine="fast")
    with pytest.raises(DesignError, match="describes no interaction"):
        nrs.load(ROOT / "specs/examples/commuting.nrs.yaml").simulate()

"""`verify` on certificates of every kind of evidence: whole files, genuine and attacked."""

import json
from functools import cache

import pytest

from nrs_design.certificates.certificate import Certificate, content_id, dump
from nrs_design.certificates.verify import read_document, verify_document
from nrs_design.search.certify import Limits, certify
from nrs_design.search.method import Method
from nrs_design.spec import read_spec
from nrs_design.switched.assemble import assemble_from_text
from tests.proof.tamper import mutations
from tests.proof.truth import holds

DAYAWANSA_MARTIN_6 = [["-1", "-1"], ["1", "-1"]], [["-1", "-6"], ["1/6", "-1"]]
BRANICKY = [["-1", "10"], ["-100", "-1"]], [["-1", "100"], ["-10", "-1"]]
COMMUTING = [["-1", "1"], ["-1", "-1"]], [["-2", "3"], ["-3", "-2"]]
SHEARS = [["-1", "10"], ["0", "-1"]], [["-1", "0"], ["10", "-1"]]
ROTATIONS = (
    [["-1", "0", "0"], ["0", "-1", "-1"], ["0", "1", "-1"]],
    [["-1", "0", "0"], ["0", "-1", "-6"], ["0", "1/6", "-1"]],
)
GEROMEL_COLANERI = [["0", "1"], ["-10", "-1"]], [["0", "1"], ["-0.1", "-0.5"]]
ANDO_SHIH = [["0.99", "0"], ["0.99", "0"]], [["0", "0.99"], ["0", "-0.99"]]
HALF = [["1/2", "0"], ["0", "1/2"]]

SPECS = {
    "graph, one form": {"A": COMMUTING},
    "graph, polynomial": {"A": DAYAWANSA_MARTIN_6},
    "no-common-quadratic": {"A": DAYAWANSA_MARTIN_6},
    "block-triangular": {"A": ROTATIONS},
    "growing-sequence, mode": {"A": ([["0", "1"], ["-1", "0"]],)},
    "growing-sequence, average": {"A": SHEARS, "method": Method.MIXTURE},
    "growing-sequence, period": {"A": BRANICKY},
    "graph, modes": {"A": GEROMEL_COLANERI, "switching": {"dwell_time": "2.76 s"}},
    "graph, modes in steps": {"A": ANDO_SHIH, "time": "discrete"},
    "graph, resets": {
        "A": GEROMEL_COLANERI,
        "switching": {"transitions": [["m0", "m1"], ["m1", "m0"]]},
        "resets": [
            {"from": "m0", "to": "m1", "map": [["1/9", "0"], ["0", "1/9"]]},
            {"from": "m1", "to": "m0", "map": [["1/9", "0"], ["0", "1/9"]]},
        ],
    },
    "growing-sequence, value": {
        "A": ([["-1", "3*k"], ["3 - 3*k", "-1"]],),
        "parameters": {"k": {"nominal": "0", "range": ["0", "1"], "varies": "false"}},
    },
    "growing-sequence, average at a value": {
        "A": ([["-1", "10*k"], ["0", "-1"]], [["-1", "0"], ["10 - 10*k", "-1"]]),
        "parameters": {"k": {"nominal": "0", "range": ["0", "1"], "varies": "false"}},
    },
    "parameter-quadratic": {
        "A": ([["0", "1"], ["-2 - k", "-1"]],),
        "parameters": {"k": {"nominal": "1", "range": ["0", "50"], "varies": "false"}},
    },
}
# Every change to these, of whose kinds tests/proof changes the evidence alone, is slow.
LONG = ("graph, polynomial", "no-common-quadratic", "block-triangular", "graph, modes")


@pytest.fixture(scope="module")
def issue(tmp_path_factory):
    """Write a spec, certify it, and read both files back as `verify` does."""

    @cache
    def make(example):
        folder = tmp_path_factory.mktemp("certified")
        details = dict(SPECS[example])
        method = details.pop("method", Method.AUTO)
        modes = [{"name": f"m{i}", "A": A} for i, A in enumerate(details.pop("A"))]
        defaults = {"kind": "switched-system", "name": "given", "time": "continuous"}
        defaults |= {"switching": "arbitrary", "modes": modes}
        path = folder / "given.nrs.yaml"
        path.write_text(json.dumps({**defaults, **details}))
        spec = read_spec(path)
        system = assemble_from_text(spec.spec, {}, None)
        found = certify(system, method, Limits(optimize_rate=False))
        certificate = Certificate(
            spec.spec.name, spec.sha256, None, {}, system, found.statements, "0"
        )
        file = folder / "given.certificate.json"
        file.write_text(dump(certificate))
        return spec, system, read_document(file)

    return make


def sign(document):
    return {**document, "id": content_id(document)}


@pytest.mark.parametrize("example", SPECS)
def test_genuine_certificates_are_valid(issue, example):
    spec, _, document = issue(example)
    verification = verify_document(document, spec)
    assert verification.fault is None
    kinds = [statement["kind"] for statement in document["statements"]]
    assert example.split(",")[0] in kinds


@pytest.mark.parametrize("example", SPECS)
def test_changes_without_a_new_id_are_noticed(issue, example):
    spec, _, document = issue(example)
    for _, statement in mutations(document["statements"][0]):
        changed = {**document, "statements": [statement, *document["statements"][1:]]}
        if changed != document:
            assert verify_document(changed, spec).fault is not None


@pytest.mark.parametrize(
    "example",
    [pytest.param(e, marks=[pytest.mark.slow] if e in LONG else []) for e in SPECS],
)
def test_changes_signed_anew_are_rejected_or_true_all_the_same(issue, example):
    spec, system, document = issue(example)
    for words, statement in mutations(document["statements"][0]):
        changed = sign({**document, "statements": [statement, *document["statements"][1:]]})
        verification = verify_document(changed, spec)
        if verification.fault is None:
            assert all(holds(system, item) for item in verification.certificate.statements), words


@pytest.mark.parametrize("example", SPECS)
@pytest.mark.parametrize("verdict", ["proved", "refuted", "inconclusive"])
def test_the_verdict_is_the_one_that_follows(issue, example, verdict):
    spec, _, document = issue(example)
    changed = sign({**document, "verdict": verdict})
    assert (verify_document(changed, spec).fault is None) is (verdict == document["verdict"])


@pytest.mark.parametrize("example", SPECS)
def test_statements_of_one_spec_prove_nothing_about_another(issue, example):
    _, _, document = issue(example)
    said = {field: document[field] for field in ("verdict", "statements")}
    false = []
    for other in SPECS:
        spec, system, target = issue(other)
        verification = verify_document(sign({**target, **said}), spec)
        if verification.fault is None:
            statements = verification.certificate.statements
            false += [(other, item.kind) for item in statements if not holds(system, item)]
    assert not false


@pytest.mark.parametrize(
    "statements",
    [
        [],
        [{}],
        [None],
        {},
        "proved",
        [{"kind": "block-triangular", "blocks": [[0, 1]], "parts": [], "claim": ""}],
        [{"kind": "block-triangular", "blocks": [[], [0, 1]], "parts": [{}], "claim": ""}],
        [{"kind": "growing-sequence", "steps": [], "doublings": 3, "claim": ""}],
        [{"kind": "growing-sequence", "steps": [["m0"]], "doublings": 3, "claim": ""}],
        [{"kind": "growing-sequence", "weights": [], "eigenvalue": "", "claim": ""}],
        [{"kind": "graph", "nodes": [], "rate": "1", "claim": ""}],
        [{"kind": "graph", "nodes": [{}], "rate": "1", "claim": ""}],
        [{"kind": "common-quadratic", "Q": {}, "rate": "1", "claim": ""}],
        [{"kind": "no-common-quadratic", "factors": [["m0", []]], "claim": ""}],
        [{"kind": "no-common-quadratic", "factors": [["m9", [[1], [1]]]], "claim": ""}],
        [{"kind": "graph", "degree": 2, "vanishing": [[]], "rate": "1", "claim": "",
          "denominator_log2": 0, "nodes": [{"place": "modes", "form": []}]}],
        [{"kind": "graph", "nodes": [], "denominator_log2": 0, "rate": "1", "claim": ""}],
        [{"kind": "growing-sequence", "share": "1/2", "claim": ""}],
        [{"kind": "growing-sequence", "share": "1/2", "part": [], "claim": ""}],
        [{"kind": "growing-sequence", "share": "1/0", "part": {"kind": "growing-sequence"}}],
        [{"kind": "parameter-quadratic", "rate": "1", "claim": "",
          "Q_low": {"numerators": [], "denominator_log2": 0},
          "Q_high": {"numerators": [], "denominator_log2": 0}}],
    ],
)  # fmt: skip
def test_malformed_statements_are_rejections_and_not_crashes(issue, statements):
    spec, _, document = issue("growing-sequence, period")
    verification = verify_document(sign({**document, "statements": statements}), spec)
    assert verification.fault is not None
    assert verification.certificate is None or verification.certificate.statements

"""Tampering with certificates, field by field.

A certificate is signed by nothing but its own hash, so an attacker can always compute the id anew.
These re-signed changes are legitimate, because the result is another true statement about the
same spec, and `verify` says in its answer what it has checked (`TestLegitimate` below lists them):

- ``package.version``: any text; it says who wrote the file, not what holds;
- ``Q.denominator_log2``: any natural number; Q is scaled by a positive factor, and neither the
  proof nor the norm in the claim depends on it;
- the numbers of any evidence and its ``rate``: others, if they prove what the (regenerated) claim
  says;
- ``gains`` of which the spec fixes only the bounds: other single-precision numbers with their own
  modes, or the same ones written otherwise, for which the evidence still holds;
- ``statements``: some left out, said twice or in another order, if they carry the same verdict;
- an unstable mode: any other mode that is unstable, with its own eigenvalue.

Everything else must be rejected, and nothing may crash.
"""

import copy
import json
from collections.abc import Iterator
from contextlib import suppress
from fractions import Fraction
from functools import cache
from pathlib import Path

import pytest

from nrs_design.certificates.certificate import content_id, dump
from nrs_design.certificates.verify import Verification, read_document, verify, verify_document
from nrs_design.controllers.float32 import exact_decimal
from nrs_design.errors import CertificateError
from nrs_design.loop.assemble import assemble_from_text
from nrs_design.pipeline.runs import run_certification
from nrs_design.proof.evidence.fields import system_fields
from nrs_design.proof.evidence.growing_sequence import staying
from nrs_design.search.certify import Limits
from nrs_design.search.method import Method
from nrs_design.spec import LoadedSpec, read_spec
from tests.proof.graphs import common_quadratic
from tests.support import COMMUTING, FORCE_LIMIT, PRINT_ERROR, ROOT, SOFT_TISSUE, holds, write_spec
from tests.tables import rows

EXAMPLES = ROOT / "specs" / "examples"
SPECS = {
    "given": COMMUTING,
    "impedance": SOFT_TISSUE,
    "force": FORCE_LIMIT,
    "unstable": PRINT_ERROR,
    "polynomial": EXAMPLES / "dayawansa-martin-6.nrs.yaml",
    "dwell": EXAMPLES / "geromel-colaneri.nrs.yaml",
    "discrete": EXAMPLES / "ando-shih.nrs.yaml",
    "constant": EXAMPLES / "unknown-constant.nrs.yaml",
    "value": ROOT / "docs" / "examples" / "flutter.nrs.yaml",
    "period": ROOT / "docs" / "examples" / "wide-range.nrs.yaml",
    "saturating": ROOT / "docs" / "examples" / "saturating.nrs.yaml",
    "blocks": ROOT / "tests" / "specs" / "certified-blocks.yaml",
    "average": ROOT / "tests" / "specs" / "certified-average.yaml",
    "resets": ROOT / "tests" / "specs" / "certified-resets.yaml",
}
METHODS = {"average": Method.MIXTURE}
# Every change to the others, which are larger, is left to the slow tests.
SMALL = ("given", "discrete")
ALL = [name if name in SMALL else pytest.param(name, marks=pytest.mark.slow) for name in SPECS]
# For each kind, the fields that may hold other numbers. A weaker rate is true, too.
NUMBERS = {
    "block-triangular": {"rate", "blocks", "parts"},
    "graph": {"rate", "nodes", "denominator_log2", "vanishing", "multipliers"},
    "constants-quadratic": {"rate", "functions", "multipliers", "denominator_log2"},
    "saturated-ellipsoid": {"rate", "Q", "H", "level"},
    "no-common-quadratic": {"factors"},
    "growing-sequence": {"steps", "doublings", "shares"},
}
ANY_RATE = Limits(optimize_rate=False)
FIRST = ("statements", 0)
DROP = object()
NOT_ITS_MODES = "is not that of the spec"


@cache
def signed(name: str) -> tuple[dict, LoadedSpec]:
    loaded = read_spec(SPECS[name])
    method = METHODS.get(name, Method.AUTO)
    found = run_certification(loaded, method=method, limits=ANY_RATE)
    return json.loads(dump(found.certificate)), loaded


def resign(document):
    return {**document, "id": content_id(document)}


def leaves(node, path=()) -> Iterator[tuple]:
    """Every place in a document, inner nodes too."""
    if path:
        yield path
    if isinstance(node, (dict, list)):
        children = node.items() if isinstance(node, dict) else enumerate(node)
        for key, child in children:
            yield from leaves(child, (*path, key))


def at(document, path):
    for key in path:
        document = document[key]
    return document


def changed(document, path, value):
    """Copy of a document with one place replaced or dropped."""
    tampered = copy.deepcopy(document)
    parent = at(tampered, path[:-1])
    if value is DROP:
        del parent[path[-1]]
    else:
        parent[path[-1]] = value
    return tampered


def with_modes(document, spec):
    """Copy of a document with the modes that its gains make of a spec."""
    system = assemble_from_text(spec.spec, document["gains"])
    return {**document, **system_fields(system)}


def restate(document, **fields):
    """Copy of a document with other fields in its first statement."""
    first, *rest = document["statements"]
    return {**document, "statements": [{**first, **fields}, *rest]}


def mutations(value) -> list:
    """Ways to spoil one value."""
    common = [DROP, None, True, False, 0, 1, -1, "", "x", [], {}, [value], {"x": value}, "\ud800"]
    if isinstance(value, bool) or value is None:
        special = []
    elif isinstance(value, int):
        special = [-value, value + 1, value - 1, value ^ 1, value ^ (1 << 7), str(value), 2 * value]
    elif isinstance(value, str):
        special = [value + " ", value[:-1], value.upper(), value[::-1], "-" + value, value + "0"]
        special += [value.replace("1", "2"), value.replace("max", "min"), value + "\x00"]
        special += [value.replace("proved", "refuted"), value.replace("8", "9", 1)]
    elif isinstance(value, list):
        special = [value[::-1], value[1:], value[:-1], value + value[-1:], [*value, None]]
    else:
        special = [{**value, "extra": None}, {**value, "": 0}, list(value), dict.fromkeys(value, 0)]
    return [m for m in common + special if m is DROP or type(m) is not type(value) or m != value]


def is_true(outcome: Verification) -> bool:
    certificate = outcome.certificate
    return all(holds(certificate.system, statement) for statement in certificate.statements)


def may_change(path, document) -> bool:
    """Tell whether a re-signed change at this place alone can be legitimate."""
    if path == ("package", "version"):
        return True
    if path[0] == "statements":
        return len(path) <= 2 or path[2] in NUMBERS[at(document, path[:2])["kind"]]
    return path[0] == "gains" and len(path) == 3


def test_untouched_certificates_hold(pair):
    document, spec = pair
    outcome = verify_document(document, spec)
    assert outcome.fault is None
    assert is_true(outcome)


@pytest.mark.parametrize("pair", ALL, indirect=True)
def test_every_change_is_noticed_by_the_id(pair):
    document, spec = pair
    count = 0
    for path in leaves(document):
        for value in mutations(at(document, path)):
            tampered = changed(document, path, value)
            outcome = verify_document(tampered, spec)
            assert outcome.fault == "its content does not match its id: it was altered", path
            count += 1
    assert count > 500


def test_every_kind_of_verdict_is_among_the_certificates():
    kinds = {item["kind"] for name in SPECS for item in signed(name)[0]["statements"]}
    assert kinds == set(NUMBERS)


@pytest.mark.parametrize("pair", ALL, indirect=True)
def test_every_re_signed_change_is_rejected_or_true(pair):
    """Accepted only where `may_change`, and then what is said is true in exact arithmetic."""
    document, spec = pair
    accepted = []
    for path in leaves(document):
        if path == ("id",):
            continue
        for value in mutations(at(document, path)):
            outcome = verify_document(resign(changed(document, path, value)), spec)
            if outcome.fault is None:
                accepted.append(path)
                assert may_change(path, document), (path, value)
                assert is_true(outcome), (path, value)
    assert ("package", "version") in accepted


@pytest.mark.parametrize("extra", ["note", "unstable_mode", "", "Q ", "\ud800", "ID"])
def test_fields_that_do_not_belong(pair, extra):
    document, spec = pair
    for value in (None, 0, "", {}):
        outcome = verify_document(resign({**document, extra: value}), spec)
        assert outcome.fault is not None


class TestLegitimate:
    """The list at the top of this file: accepted, and true."""

    def accept(self, document, spec):
        outcome = verify_document(resign(document), spec)
        assert outcome.fault is None
        assert is_true(outcome)
        return outcome.certificate

    def test_version(self, pair):
        document, spec = pair
        self.accept(changed(document, ("package", "version"), "99.0"), spec)

    @pytest.mark.parametrize("exponent", [0, 7, 14_000])
    def test_scale_in_the_exponent(self, exponent):
        document, spec = signed("given")
        self.accept(changed(document, (*FIRST, "denominator_log2"), exponent), spec)

    @pytest.mark.parametrize("factor", [3, 10**100])
    def test_scale_in_the_numerators(self, factor):
        document, spec = signed("impedance")
        for k in range(len(at(document, (*FIRST, "nodes")))):
            place = (*FIRST, "nodes", k, "form")
            scaled = [[factor * q for q in row] for row in at(document, place)]
            document = changed(document, place, scaled)
        self.accept(document, spec)

    def test_slower_rate(self):
        document, spec = signed("impedance")
        slower = Fraction(at(document, FIRST)["rate"]) / 2
        restated = restate(document, rate=str(slower))
        assert self.accept(restated, spec).evidence.rate == slower

    def test_other_gain_within_the_bounds(self):
        document, spec = signed("impedance")
        # One unit in the last place of the single-precision 2.15.
        other = Fraction(document["gains"]["insertion"]["Bt"]) + Fraction(1, 2**22)
        tampered = changed(document, ("gains", "insertion", "Bt"), exact_decimal(other))
        assert NOT_ITS_MODES in verify_document(resign(tampered), spec).fault
        own = with_modes(tampered, spec)
        assert self.accept(own, spec).gains["insertion"]["Bt"] == exact_decimal(other)

    def test_same_gain_written_otherwise(self):
        document, spec = signed("impedance")
        self.accept(changed(document, ("gains", "motion", "Kd"), "2.06e3"), spec)

    def test_other_unstable_mode(self):
        document, spec = signed("unstable")
        other = run_certification(spec).certificate.system.modes[1]
        restated = restate(document, **staying(other.name).to_fields())
        assert at(document, FIRST)["steps"] == [["insertion", "1"]]
        assert self.accept(restated, spec).evidence.steps == (("withdrawal", 1),)

    def test_statements_in_another_order_and_twice(self):
        document, spec = signed("polynomial")
        proof, remark = document["statements"]
        for statements in ([remark, proof], [proof, proof, remark], [proof]):
            certificate = self.accept({**document, "statements": statements}, spec)
            assert certificate.verdict == "proved"

    def test_a_remark_alone_with_the_verdict_that_it_carries(self):
        document, spec = signed("polynomial")
        remark = {**document, "statements": document["statements"][1:]}
        certificate = self.accept({**remark, "verdict": "inconclusive"}, spec)
        assert (certificate.evidence, certificate.common_quadratic) == (None, "impossible")
        assert verify_document(resign(remark), spec).fault is not None


class TestForgery:
    """Deliberate attacks, each with the id computed anew."""

    def reject(self, document, spec, reason):
        outcome = verify_document(resign(document), spec)
        assert outcome.fault is not None
        assert reason in outcome.fault

    def test_faster_rate(self):
        document, spec = signed("given")
        for rate in (Fraction(1), Fraction(2), Fraction(10**6)):
            self.reject(restate(document, rate=str(rate)), spec, "does not decrease")

    @pytest.mark.parametrize(
        "rate",
        ["0", "-1", "1/0", "2/4", "1e-3", "nan", "", " 1", "1\n", "1_0", "\uff11", "1" * 2001, 1],
    )
    def test_malformed_rate(self, rate):
        document, spec = signed("given")
        self.reject(restate(document, rate=rate), spec, "")

    def test_a_sentence_is_no_part_of_a_statement(self):
        document, spec = signed("given")
        self.reject(restate(document, claim="Every solution decays at once."), spec, "'claim'")

    def test_other_words_of_what_is_taken_for_granted(self):
        document, spec = signed("given")
        first, *others = document["assumptions"]
        for other in ({**first, "id": "matrices.guessed"}, {**first, "fields": [["scale", ["2"]]]}):
            spoiled = {**document, "assumptions": [other, *others]}
            self.reject(spoiled, spec, "'assumptions'")
        self.reject({**document, "assumptions": ["anything"]}, spec, "malformed")

    def test_dropped_and_swapped_modes(self):
        document, spec = signed("impedance")
        self.reject({**document, "modes": document["modes"][1:]}, spec, "'modes'")
        self.reject({**document, "modes": document["modes"][::-1]}, spec, "'modes'")

    def test_a_proof_for_a_narrow_range_is_none_for_a_wide_one(self, tmp_path):
        document, _ = signed("impedance")
        path = tmp_path / "wide.nrs.yaml"
        path.write_text(SOFT_TISSUE.read_text().replace("768.17 N/m", "2000 N/m"))
        wide = read_spec(path)
        other = json.loads(dump(run_certification(wide, limits=ANY_RATE).certificate))
        assert other["verdict"] == "refuted"
        # Everything but the numbers is taken from the other certificate.
        forged = {**other, "verdict": "proved", "statements": document["statements"]}
        self.reject(forged, wide, "does not decrease")
        self.reject({**document, "spec": other["spec"]}, wide, "")

    def test_changed_spec(self, tmp_path):
        spec = write_spec(tmp_path / "a.yaml", [[-1, 0], [0, -1]])
        document = json.loads(dump(run_certification(spec).certificate))
        assert verify_document(document, spec).fault is None
        unstable = write_spec(tmp_path / "b.yaml", [[1, 0], [0, -1]])
        assert "another spec" in verify_document(document, unstable).fault
        moved = {**document, "spec": {"name": "given", "sha256": unstable.sha256}}
        self.reject(moved, unstable, NOT_ITS_MODES)
        self.reject(with_modes(moved, unstable), unstable, "does not decrease")

    def test_comments_and_line_ends_are_no_other_spec(self, tmp_path):
        path = tmp_path / "a.yaml"
        spec = write_spec(path, [[-1, 0], [0, -1]])
        document = json.loads(dump(run_certification(spec).certificate))
        path.write_bytes(b"# mine\n" + path.read_bytes().replace(b"\n", b"\r\n"))
        assert verify_document(document, read_spec(path)).fault is None
        path.write_text(path.read_text().replace('"-1"', '"-1.0"', 1))
        assert "another spec" in verify_document(document, read_spec(path)).fault

    @pytest.mark.parametrize("origin", ["a.yaml", "../../nowhere", 7, None, ["a"]])
    def test_where_the_spec_was_says_nothing(self, origin):
        document, spec = signed("given")
        assert verify_document({**document, "origin": origin}, spec).fault is None

    def test_refutation_of_a_stable_system(self):
        document, spec = signed("given")
        for name in ("a", "b", "c", "\ud800"):
            forged = {"kind": "growing-sequence", **staying(name).to_fields()}
            refuted = {**document, "verdict": "refuted", "statements": [forged]}
            reason = f"mode {name} is stable" if name in "ab" else "modes that do not exist"
            self.reject(refuted, spec, reason)

    def test_proof_of_an_unstable_system(self):
        document, spec = signed("unstable")
        identity = tuple(tuple(int(i == j) for j in range(4)) for i in range(4))
        evidence = common_quadratic(identity, 0, Fraction(1, 1000))
        forged = {"kind": "graph", **evidence.to_fields()}
        proved = {**document, "verdict": "proved", "statements": [forged]}
        self.reject(proved, spec, "does not decrease")

    def test_evidence_of_another_system(self):
        """Every statement of every other certificate, restated for this spec."""
        document, spec = signed("given")
        for name in SPECS:
            for statement in signed(name)[0]["statements"]:
                if name != "given":
                    forged = {**document, "statements": [statement]}
                    assert verify_document(resign(forged), spec).fault is not None

    @pytest.mark.slow
    def test_a_bound_with_other_names_or_numbers(self, tmp_path):
        text = SOFT_TISSUE.read_text().replace("[720.56 N/m, 768.17 N/m]", "[747 N/m, 748 N/m]")
        path = tmp_path / "bounded.nrs.yaml"
        path.write_text(
            f"{text}\nsampling: {{period: 2 ms, delay: 0}}\ndisturbances: {{command: 8 deg/s}}\n"
        )
        spec = read_spec(path)
        document = json.loads(dump(run_certification(spec, limits=ANY_RATE).certificate))
        assert verify_document(document, spec).fault is None
        proof, bound, _ = document["statements"]
        assert (bound["kind"], bound["output"]) == ("offset-ellipsoid", "force")
        for field, value in (
            ("level", str(Fraction(bound["level"]) * Fraction(9, 10))),
            ("channels", ["friction"]),
            ("output", "torque"),
            ("multipliers", []),
            ("shares", ["1"]),
            ("roundings", [-1] * len(bound["roundings"])),
            ("roundings", bound["roundings"][1:]),
        ):
            forged = {**document, "statements": [proof, {**bound, field: value}]}
            assert verify_document(resign(forged), spec).fault is not None
        for field, key, value in (("channels", "bound", "1/1000"), ("outputs", "limit", "9")):
            changed_ = {**document, field: [{**document[field][0], key: value}]}
            assert verify_document(resign(changed_), spec).fault is not None
        alone = {**document, "statements": [bound], "verdict": "inconclusive"}
        outcome = verify_document(resign(alone), spec)
        assert outcome.fault is None
        assert outcome.certificate.verdict == "inconclusive"

    def test_a_false_remark_beside_a_true_proof(self):
        document, spec = signed("given")
        remark = signed("polynomial")[0]["statements"][1]
        renamed = {**remark, "factors": [["a", [[1], [0]]], ["b", [[0], [1]]]]}
        both = {**document, "statements": [*document["statements"], renamed]}
        self.reject(both, spec, "not positive definite")

    def test_another_degree(self):
        document, spec = signed("polynomial")
        for degree in (1, 3, 0, -2, 10**6):
            self.reject(changed(document, (*FIRST, "degree"), degree), spec, "")

    def test_shorter_dwell_time_than_declared(self):
        """The signal must be one of those that the spec allows, and must grow."""
        document, spec = signed("period")
        steps = at(document, FIRST)["steps"]
        for factor in (0, 1000, Fraction(1, 1000)):
            other = [[name, str(factor * Fraction(dwell))] for name, dwell in steps]
            self.reject(restate(document, steps=other), spec, "")

    def test_no_statements(self, pair):
        document, spec = pair
        for verdict in ("proved", "refuted", "inconclusive"):
            self.reject({**document, "verdict": verdict, "statements": []}, spec, "states nothing")

    @pytest.mark.parametrize(
        ("controller", "gain", "value"), rows(__file__, "test_gains_outside_the_spec")
    )
    def test_gains_outside_the_spec(self, controller, gain, value):
        document, spec = signed("impedance")
        self.reject(changed(document, ("gains", controller, gain), value), spec, "gain")

    def test_gain_for_which_the_evidence_does_not_hold(self):
        document, spec = signed("impedance")
        tampered = changed(document, ("gains", "withdrawal", "Bt"), "0.125")
        self.reject(tampered, spec, NOT_ITS_MODES)
        self.reject(with_modes(tampered, spec), spec, "does not decrease")

    def test_gain_that_overflows_the_other(self, tmp_path):
        """With only the zero fixed, Kp = Kd z leaves single precision."""
        text = SOFT_TISSUE.read_text().replace("  derivative_gain: 2060 rpm*s/rad\n", "")
        path = tmp_path / "zero.nrs.yaml"
        path.write_text(text)
        spec = read_spec(path)
        document = json.loads(dump(run_certification(spec, limits=ANY_RATE).certificate))
        tampered = changed(document, ("gains", "motion", "Kd"), str(2**127))
        self.reject(tampered, spec, "single precision")

    @pytest.mark.parametrize("coordinates", ["deflection", "force", ""])
    def test_coordinates_of_given_matrices(self, coordinates):
        document, spec = signed("given")
        self.reject({**document, "coordinates": coordinates}, spec, "")

    def test_nesting_too_deep_for_the_canonical_form(self):
        document, spec = signed("given")
        node: list = []
        for _ in range(100_000):
            node = [node]
        deep = {**document, "assumptions": node}
        assert "malformed" in verify_document(deep, spec).fault
        # Unchain it step by step: freeing it at once would overflow the stack, too.
        while node:
            node = node.pop()

    def test_integer_too_long_for_text(self):
        document, spec = signed("given")
        long = changed(document, (*FIRST, "denominator_log2"), 10**5000)
        assert "malformed" in verify_document(long, spec).fault


class TestFiles:
    """Whatever the file holds: one clear error or a rejection."""

    @pytest.mark.parametrize(
        ("content", "reason"),
        [
            *rows(__file__, "test_not_a_certificate"),
            ('{"rate": 0.' + "1" * 10_000 + "}", "floating-point"),
            ('{"Q": ' + "7" * 4301 + "}", "4300"),
            ('{"a": ' + "[" * 5000 + "]" * 5000 + "}", "recursion"),
        ],
    )
    def test_not_a_certificate(self, tmp_path, content, reason):
        path = tmp_path / "c.json"
        path.write_bytes(content.encode("latin-1"))
        with pytest.raises(CertificateError, match=reason) as caught:
            verify(path, signed("given")[1])
        assert caught.value.path == path
        assert len(str(caught.value)) < 500

    @pytest.mark.parametrize("depth", range(900, 1000, 3))
    def test_no_depth_slips_between_reading_and_hashing(self, tmp_path, depth):
        path = tmp_path / "c.json"
        path.write_text('{"a": ' + "[" * depth + "]" * depth + "}")
        with suppress(CertificateError):
            assert verify(path, signed("given")[1]).fault

    @pytest.mark.parametrize("content", ["{}", '{"id": null}', '{"id": 1}', '{"id": {}}'])
    def test_objects_without_content(self, tmp_path, content):
        path = tmp_path / "c.json"
        path.write_text(content)
        assert "id" in verify(path, signed("given")[1]).fault

    def test_missing_file(self, tmp_path):
        with pytest.raises(CertificateError, match="No such file"):
            verify(tmp_path / "none.json", signed("given")[1])

    def test_directory(self, tmp_path):
        with pytest.raises(CertificateError, match="directory"):
            verify(tmp_path, signed("given")[1])

    def test_device(self):
        with pytest.raises(CertificateError, match="not a regular file"):
            verify(Path("/dev/zero"), signed("given")[1])

    def test_too_large(self, tmp_path, monkeypatch):
        monkeypatch.setattr("nrs_design.certificates.prove.MAX_BYTES", 100)
        path = tmp_path / "c.json"
        path.write_text(json.dumps(signed("given")[0]))
        with pytest.raises(CertificateError, match="larger"):
            verify(path, signed("given")[1])

    def test_round_trip(self, tmp_path, pair):
        document, spec = pair
        path = tmp_path / "c.json"
        path.write_text(json.dumps(document))
        assert read_document(path) == document
        assert verify(path, spec).fault is None


@pytest.mark.parametrize("name", SPECS)
def test_wrong_kind_of_spec(name):
    document, _ = signed(name)
    accepted = []
    for other in SPECS:
        spec = signed(other)[1]
        moved = {**document, "spec": {"name": spec.spec.name, "sha256": spec.sha256}}
        for given in (document, resign(moved)):
            if verify_document(given, spec).fault is None:
                accepted.append(other)
    assert accepted == [name, name]


@pytest.mark.parametrize(
    "statements", rows(__file__, "test_malformed_statements_are_rejections_and_not_crashes")
)
def test_malformed_statements_are_rejections_and_not_crashes(statements):
    document, spec = signed("average")
    assert verify_document(resign({**document, "statements": statements}), spec).fault is not None


def test_other_schemas_are_made_again(pair):
    document, spec = pair
    for schema in ("nrs-design/certificate/8", "nrs-design/certificate/10", 2, None):
        other = resign({**document, "schema": schema})
        for outcome in (verify_document(other), verify_document(other, spec)):
            assert "make it again with certify-switching" in outcome.fault

"""A program is proved only where its sampled loop is."""

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

from nrs_design.certificates.certificate import dump
from nrs_design.certificates.verify import Verification
from nrs_design.controllers.float32 import exact_decimal
from nrs_design.controllers.shipped import shipped_law
from nrs_design.errors import DesignError
from nrs_design.exporters.export import Execution, export_design
from nrs_design.exporters.record import header_lines
from nrs_design.spec import parse_spec
from tests.support import words_of

PERIOD = Fraction(2, 1000)


def test_a_proof_of_the_sampled_loop_is_one_of_the_program(sampled_export):
    record = sampled_export.record
    assert (sampled_export.verdict, record.verdict, record.unproved) == ("proved", "proved", None)
    assert (record.sample_time.exact, record.delay) == ("0.002", (0, 1))
    assert not [text for text in record.outside if "continuous" in text]


def test_sample_time_and_delay_are_in_every_header(sampled_export, continuous_export):
    record = sampled_export.record
    for shown, said in (
        (record, "0.002 s, force sample 0 to 1 sample old"),
        (record.model_copy(update={"delay": (1, 1)}), "0.002 s, force sample 1 sample old"),
        (record.model_copy(update={"delay": None}), "0.002 s"),
        (continuous_export.record, "none, the statement is about continuous time"),
    ):
        assert f"sample time: {said}" in header_lines(shown)


def test_the_sample_time_may_be_repeated_but_not_changed(sampled, sampled_export, tmp_path):
    file = tmp_path / "proof.cert.json"
    file.write_text(dump(sampled_export.certificate))
    assert export_design(sampled, file, execution=Execution(PERIOD)) == sampled_export
    with pytest.raises(DesignError, match="not every"):
        export_design(sampled, file, execution=Execution(2 * PERIOD, unproved=True))


def test_a_proof_in_continuous_time_is_none_of_a_program(continuous, continuous_export):
    loaded = continuous
    with pytest.raises(DesignError, match="nothing says when"):
        export_design(loaded, execution=Execution(unproved=True))
    refused = export_design(loaded, execution=Execution(PERIOD))
    assert (refused.verdict, refused.record) == ("inconclusive", None)
    with pytest.raises(DesignError, match="continuous time"):
        refused.shipped()
    record = export_design(loaded, execution=Execution(PERIOD, unproved=True)).record
    assert (record.verdict, record.sample_time.exact, record.delay) == ("unproved", "0.002", None)
    assert "nothing is proved of a law that runs every 0.002 s" in record.unproved
    assert record.proof.certificate_id == refused.certificate.id
    assert "continuous time" in record.outside[0]
    assert record.controllers == continuous_export.record.controllers


def test_a_refuted_program_says_that_nothing_is_proved(sampled):
    """With a force sample that is five samples of 20 ms old, the loop is unstable."""
    text = sampled.text.replace("delay: [0, 1]", "delay: 5").replace("2 ms", "20 ms")
    loaded = replace(sampled, spec=parse_spec(text))
    refused = export_design(loaded, execution=Execution())
    assert (refused.verdict, refused.record) == ("refuted", None)
    assert "--unproved" not in refused.reason
    export = export_design(loaded, execution=Execution(unproved=True))
    record = export.record
    assert (export.verdict, record.verdict, record.proof) == ("refuted", "unproved", None)
    assert record.outside == ("Everything: nothing is proved.",)
    assert "certificate: none" in header_lines(record)
    assert "verdict: UNPROVED: the design is not proved: refuted" in header_lines(record)


def test_a_certificate_that_is_rejected_is_not_exported_on_request(
    sampled, continuous_export, tmp_path
):
    file = tmp_path / "wrong.cert.json"
    file.write_text(dump(continuous_export.certificate))
    export = export_design(sampled, file, execution=Execution(unproved=True))
    assert (export.verdict, export.record) == ("rejected", None)


def test_a_certificate_that_proves_nothing_is_inconclusive(sampled, sampled_export, monkeypatch):
    """As one holds no more than that there is no common quadratic function."""
    nothing = replace(sampled_export.certificate, statements=())
    outcome = Verification(nothing, None)
    monkeypatch.setattr("nrs_design.exporters.export.verify", lambda *_, **__: outcome)
    refused = export_design(sampled, Path("a.cert.json"), execution=Execution())
    assert (refused.verdict, refused.record) == ("inconclusive", None)
    assert refused.reason == "a.cert.json proves nothing"
    asked = export_design(sampled, Path("a.cert.json"), execution=Execution(unproved=True))
    assert (asked.verdict, asked.record.verdict) == ("inconclusive", "unproved")


def test_every_coefficient_is_in_what_the_proof_takes_for_granted(sampled, sampled_export):
    """To the last digit, as the certificate lists them."""
    texts = " ".join(words_of(sampled_export.certificate.system))
    law = shipped_law(sampled.spec, sampled_export.design, PERIOD)
    numbers = [n for c in law.coefficients for n in c.values if not c.name.endswith("_limit")]
    assert len(numbers) == 5
    assert all(f"= {exact_decimal(number)}" in texts for number in numbers)


def test_a_law_of_two_periods_is_not_exported(sampled):
    text = sampled.text.replace("delay: [0, 1]", "outer_period: 1 ms, delay: 0")
    loaded = replace(sampled, spec=parse_spec(text))
    for execution in (None, Execution(), Execution(PERIOD, unproved=True)):
        with pytest.raises(DesignError, match="some of them at another") as caught:
            export_design(loaded, execution=execution)
        assert caught.value.at == ("sampling", "outer_period")

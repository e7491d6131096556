"""The lines that every exported file holds."""

from fractions import Fraction

import pytest

from nrs_design.exporters.export import Execution, export_design
from nrs_design.exporters.header import header_lines


@pytest.fixture(params=["sampled", "continuous"])
def proved(request):
    return request.getfixturevalue(f"{request.param}_export")


def test_what_is_proved(proved):
    lines = header_lines(proved.record)
    assert not [line for line in lines if "\n" in line]
    assert "verdict: PROVED" in lines
    assert f"certificate: {proved.certificate.id}" in lines
    assert f"claim: {proved.record.proof.claim}" in lines
    assert f"spec: soft-tissue, sha256 {proved.record.spec.sha256}" in lines


def test_everything_that_is_left_out(proved):
    lines = header_lines(proved.record)
    left = [text.removeprefix("outside the proof: ") for text in lines if "outside" in text]
    assert left == [*proved.record.outside]


def test_sample_time_and_delay(sampled_export, continuous_export):
    assert "sample time: 0.002 s, force sample 0 to 1 sample old" in header_lines(
        sampled_export.record
    )
    once = sampled_export.record.model_copy(update={"delay": (1, 1)})
    assert "sample time: 0.002 s, force sample 1 sample old" in header_lines(once)
    unknown = sampled_export.record.model_copy(update={"delay": None})
    assert "sample time: 0.002 s" in header_lines(unknown)
    assert "sample time: none, the statement is about continuous time" in header_lines(
        continuous_export.record
    )


def test_what_is_not_proved(continuous):
    record = export_design(continuous, execution=Execution(Fraction(1, 500), unproved=True)).record
    (verdict,) = [line for line in header_lines(record) if line.startswith("verdict")]
    assert verdict.startswith("verdict: UNPROVED: the certificate is about continuous time")
    bare = record.model_copy(update={"proof": None})
    assert "certificate: none" in header_lines(bare)
    assert not [line for line in header_lines(bare) if line.startswith("claim")]

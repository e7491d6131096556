"""The lines that every exported file holds."""

import pytest

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
    left = [text.removeprefix("outside the proof: ") for text in lines if "outside" in text]
    assert left == [*proved.record.outside]


def test_sample_time_and_delay(sampled_export, continuous_export):
    record = sampled_export.record
    for shown, said in (
        (record, "0.002 s, force sample 0 to 1 sample old"),
        (record.model_copy(update={"delay": (1, 1)}), "0.002 s, force sample 1 sample old"),
        (record.model_copy(update={"delay": None}), "0.002 s"),
        (continuous_export.record, "none, the statement is about continuous time"),
    ):
        assert f"sample time: {said}" in header_lines(shown)

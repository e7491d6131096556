"""The lines that every exported file holds."""

from nrs_design.exporters.header import header_lines


def test_sample_time_and_delay(sampled_export, continuous_export):
    record = sampled_export.record
    for shown, said in (
        (record, "0.002 s, force sample 0 to 1 sample old"),
        (record.model_copy(update={"delay": (1, 1)}), "0.002 s, force sample 1 sample old"),
        (record.model_copy(update={"delay": None}), "0.002 s"),
        (continuous_export.record, "none, the statement is about continuous time"),
    ):
        assert f"sample time: {said}" in header_lines(shown)

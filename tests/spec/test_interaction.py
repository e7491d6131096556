from .samples import IMPEDANCE, place_of, refusal, spoiled


def test_reports_the_first_fault_and_counts_the_others() -> None:
    text = spoiled(IMPEDANCE, "0.0351 s", "0.0351 m")
    text = spoiled(text, "8 deg/s", "8 m")
    text = spoiled(text, "747.1461 N/m", "nan N/m")
    error = refusal(text)
    assert "actuator.time_constant" in error.message
    assert [(f.line, f.column) for f in error.faults] == [
        place_of(text, "0.0351 m"),
        place_of(text, "8 m"),
        place_of(text, "nan N/m"),
    ]
    assert str(error).endswith("; 2 more faults in this file")
    one = refusal(spoiled(spoiled(IMPEDANCE, "0.0351 s", "0.0351 m"), "8 deg/s", "8 m"))
    assert str(one).endswith("; 1 more fault in this file")


def test_entries_are_limited() -> None:
    many = "".join(f"  e{i}: {{model: elastic, stiffness: 1 N*m/rad}}\n" for i in range(65))
    error = refusal(spoiled(IMPEDANCE, "  soft:\n", many + "  soft:\n"))
    assert "environments: more than 64 entries are not read" in error.message

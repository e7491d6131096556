from pathlib import Path

from nrs_design.cli.init import named_after


def test_a_spec_is_named_after_its_file() -> None:
    template = "kind: robot\nname: my-robot     # name\n"
    assert named_after(Path("a/Left Arm.nrs.yaml"), template) == (
        "kind: robot\nname: left-arm     # name\n"
    )
    assert "name: very-long-name # name" in named_after(Path("very-long-name.yml"), template)
    assert named_after(Path("---.nrs.yaml"), template) == template

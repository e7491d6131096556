from pathlib import Path

import pytest

from nrs_design.spec import load_spec
from nrs_design.spec.load import axes_at

ROOT = Path(__file__).resolve().parents[2]
PATHS = sorted([*ROOT.glob("specs/**/*.nrs.yaml"), *ROOT.glob("docs/examples/*.nrs.yaml")])


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.name)
def test_names_are_those_of_the_files(path: Path) -> None:
    for axis in axes_at(path):
        file, _, name = axis.name.partition("#")
        said = file.removesuffix(".nrs.yaml") + f"-{name}" * bool(name)
        assert load_spec(axis).name == said

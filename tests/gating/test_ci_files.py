"""The files that other projects copy or refer to name commands and options that exist."""

import re
from pathlib import Path

import pytest
from ruamel.yaml import YAML
from typer.main import get_command

from nrs_design.cli.app import make_app

ROOT = Path(__file__).parents[2]


def commands_in(path):
    text = "\n".join(line.partition("#")[0] for line in path.read_text().splitlines())
    return re.findall(r"nrs-design ((?:check|gate)\b.*)", text)


@pytest.mark.parametrize("name", [".pre-commit-hooks.yaml", "docs/ci/github-actions.yml"])
def test_commands_and_options_exist(name):
    known = get_command(make_app()).commands
    found = commands_in(ROOT / name)
    assert found
    for words in map(str.split, found):
        options = {option for p in known[words[0]].params for option in p.opts}
        assert {word for word in words[1:] if word.startswith("-")} <= options


def test_hooks():
    hooks = {hook["id"]: hook for hook in YAML(typ="safe").load(ROOT / ".pre-commit-hooks.yaml")}
    assert set(hooks) == {"nrs-design-check", "nrs-design-gate"}
    for hook in hooks.values():
        assert hook["language"] == "python"
        assert re.search(hook["files"], "specs/a.nrs.yaml")
        assert not re.search(hook["files"], "specs/a.yaml")
    assert hooks["nrs-design-gate"]["pass_filenames"] is False


def test_workflow_is_yaml_with_two_jobs():
    workflow = YAML(typ="safe").load(ROOT / "docs/ci/github-actions.yml")
    assert set(workflow["jobs"]) == {"locked", "gate"}

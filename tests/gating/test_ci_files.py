"""The files that other projects copy or refer to work in a repository as it is."""

import os
import re
import shlex
import shutil
import sys
from pathlib import Path

import pytest
from ruamel.yaml import YAML
from typer.main import get_command

from nrs_design.cli.app import make_app
from tests.support import run, spec_in, started

from .conftest import STABLE

ROOT = Path(__file__).parents[2]
WORKFLOW = ROOT / "docs/ci/github-actions.yml"
GITLAB = ROOT / "docs/ci/gitlab-ci.yml"
HOOKS = ROOT / ".pre-commit-hooks.yaml"
PRE_COMMIT = ROOT / ".pre-commit-config.yaml"
CLEARED = "rm -rf gate"
ACTION = ROOT / "docs/ci/action.yml"


def parse(text):
    return YAML(typ="safe").load(text)


def steps():
    return [step for job in parse(WORKFLOW)["jobs"].values() for step in job["steps"]]


def local_hooks():
    (own,) = (each for each in parse(PRE_COMMIT)["repos"] if each["repo"] == "local")
    return own["hooks"]


def gitlab_lines():
    return [line for job in parse(GITLAB).values() for line in job.get("script", [])]


def commands():
    """Every command line of nrs-design in these files, as words without the program."""
    lines = [step["run"] for step in steps() if "run" in step] + gitlab_lines()
    lines += [" ".join([hook["entry"], *hook.get("args", [])]) for hook in parse(HOOKS)]
    lines += [hook["entry"] for hook in local_hooks()]
    lines += re.findall(r"#\s+(nrs-design .*)", WORKFLOW.read_text())
    return [shlex.split(line)[1:] for line in lines if line.startswith("nrs-design ")]


def test_commands_and_options_exist():
    known = get_command(make_app()).commands
    assert len(commands()) == 11
    for name, *words in commands():
        options = {option for p in known[name].params for option in p.opts}
        assert {word for word in words if word.startswith("-")} <= options


@pytest.mark.slow
def test_commands_work_in_a_project(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("specs").mkdir()
    Path("specs/a.nrs.yaml").write_text(STABLE)
    (tmp_path / "head").mkdir()
    Path("specs").rename("head/specs")
    shutil.copytree("head", "base")
    shutil.copytree("head", "target")
    monkeypatch.chdir("head")
    # Those that make the lock file come first, as in a project.
    for words in sorted(commands(), key=lambda words: ("--locked" in words, "--lock" in words)):
        arguments = [*words, "specs/a.nrs.yaml"] if words[0] == "check" else words
        run(*arguments, cwd=Path.cwd(), code=0)
    assert Path("../gate/gate.sarif").is_file()


def test_actions_are_pinned_by_commit():
    used = [step["uses"] for step in steps() if "uses" in step]
    assert len(used) == 13
    assert all(re.fullmatch(r"[\w./-]+@[0-9a-f]{40}", action) for action in used)


def test_nothing_of_a_pull_request_is_run():
    """The event takes the recipe from the base; tool and requirements are installed from there."""
    workflow = parse(WORKFLOW)
    assert workflow["on"] == ["push", "pull_request_target"]
    for name, job in workflow["jobs"].items():
        if name == "scanning":
            continue
        checkouts = [step["with"] for step in job["steps"] if "checkout" in step.get("uses", "")]
        base, head, *others = checkouts
        # What is compared with, is the branch that would change.
        assert [(each["path"], "base.ref" in each["ref"]) for each in others] == [
            ("target", True)
        ] * (name == "weaker")
        assert (base["path"], "ref" in base) == ("base", False)
        assert (head["path"], "refs/pull" in head["ref"]) == ("head", True)
        assert not any(each["persist-credentials"] for each in checkouts)
        for step in job["steps"]:
            if "run" in step:
                installs = "pip install" in step["run"]
                assert step["working-directory"] == ("base" if installs else "head")
                assert installs or step["run"].startswith("nrs-design gate specs ")
    assert "secrets" not in WORKFLOW.read_text().replace("no secret", "")


def test_a_pull_request_may_only_read():
    workflow = parse(WORKFLOW)
    assert set(workflow["jobs"]) == {"locked", "weaker", "gate", "scanning"}
    assert workflow["permissions"] == {"contents": "read"}
    writing = {name for name, job in workflow["jobs"].items() if "permissions" in job}
    assert writing == {"scanning"}
    assert workflow["jobs"]["scanning"]["if"] == "always() && github.event_name == 'push'"


@pytest.mark.parametrize("lines", [[s.get("run", "") for s in steps()], gitlab_lines()])
def test_from_scratch_means_without_a_lock_file_of_the_pull_request(lines):
    """A lock file that it brought would be believed about the bounds of robots."""
    (place,) = (k for k, line in enumerate(lines) if "gate/nrs.lock" in line)
    assert "--lock ../gate/nrs.lock" in lines[place] or lines[place - 1] == CLEARED


def test_the_action_installs_by_no_module_of_the_checkout(tmp_path):
    """It is the checkout that is judged."""
    (tmp_path / "pip.py").write_text("raise SystemExit('taken over')")
    (step,) = (s for s in parse(ACTION)["runs"]["steps"] if "pip install" in s.get("run", ""))
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    given = {**step["env"], "PACKAGE": "--help", "PATH": path}
    done = started("bash", "-c", step["run"], cwd=tmp_path, python=False, **given)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.slow
@pytest.mark.parametrize("weaker", [False, True])
def test_the_action_writes_the_summary_of_the_job(tmp_path, weaker):
    """Its lines as bash runs them; what is weaker than the base fails, and is in the summary."""
    (tmp_path / "head/specs").mkdir(parents=True)
    spec = spec_in(tmp_path, STABLE, "head/specs/a")
    run("gate", "specs", "--no-reports", cwd=tmp_path / "head", code=0)
    shutil.copytree(tmp_path / "head", tmp_path / "base")
    if weaker:
        spec.write_text(STABLE.replace("arbitrary", "{dwell_time: 1 s}"))
        run("gate", "specs", "--no-reports", cwd=tmp_path / "head")
    environment = {
        "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}",
        "SPECS": "specs",
        "BASE": "../base",
        "RUNNER_TEMP": str(tmp_path),
        "GITHUB_STEP_SUMMARY": str(tmp_path / "summary.md"),
    }
    lines = [step["run"] for step in parse(ACTION.read_text())["runs"]["steps"] if "run" in step]
    gate, summary = lines[1:3]
    bash = ("bash", "-eo", "pipefail", "-c")
    codes = [
        started(*bash, line, cwd=tmp_path / "head", python=False, **environment).returncode
        for line in (gate, summary)
    ]
    assert codes == [int(weaker), 0]
    said = (tmp_path / "summary.md").read_text()
    assert ("weaker" in said and "NRS110" in said) if weaker else "✅ nrs" in said

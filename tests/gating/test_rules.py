import re

import pytest

from nrs_design import errors
from nrs_design.gating.obligations import Status
from nrs_design.gating.rules import RULES, WORDS
from nrs_design.identification.errors import DataError
from nrs_design.robot.models.geometry import PoseError
from tests.support import ROOT, run

# Ids are stable: baselines of code scanners and lock files outlive a release.
PUBLISHED = [
    *(f"NRS00{i}" for i in range(9)),
    *(f"NRS1{i:02}" for i in range(1, 11)),
    "NRS201",
    "NRS202",
    "NRS203",
    "NRS900",
]


def test_ids_are_stable():
    assert list(RULES) == PUBLISHED
    assert all(rule.id == key for key, rule in RULES.items())


def test_every_error_has_its_rule():
    classes = {errors.NrsDesignError, *errors.NrsDesignError.__subclasses__()}
    assert {DataError, PoseError} < classes
    assert len({error.rule for error in classes}) == len(classes)
    assert {error.rule for error in classes} <= RULES.keys()


@pytest.mark.parametrize("rule", RULES.values(), ids=lambda rule: rule.id)
def test_every_rule_says_what_it_means_and_what_to_do(rule):
    assert re.fullmatch("NRS[0-9]{3}", rule.id)
    assert not rule.title.endswith(".")
    assert rule.explanation.endswith(".")
    assert rule.remedy.endswith(".")


def test_every_status_is_explained_with_its_exit_code():
    assert WORDS.keys() == {str(status) for status in Status}
    assert "Exit code 3." in WORDS["inconclusive"].remedy


def test_options_that_are_advised_exist():
    advised = {
        option
        for item in (*RULES.values(), *WORDS.values())
        for option in re.findall("--[a-z-]+", f"{item.explanation} {item.remedy}")
    }
    commands = (["certify-switching"], ["simulate"], ["gate"], ["identify", "tissue"])
    help_ = "".join(run(*command, "--help", cwd=ROOT).stdout for command in commands)
    assert advised - {"--help"} <= set(re.findall("--[a-z-]+", help_))

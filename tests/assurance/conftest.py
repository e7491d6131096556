"""Folders of evidence, made once by the command and copied for each test."""

import shutil

import pytest

from tests.support import COMMUTING, ROBOT, ROOT, run

SAMPLED = ROBOT / "soft-tissue-sampled.nrs.yaml"


def made(folder, spec, *options):
    """Make evidence with the certificate that ships."""
    name = spec.name.removesuffix(".nrs.yaml")
    proof = ROOT / "reports" / f"{name}.cert.json"
    options = ("--certificate", proof, "--out", folder / "evidence", *options)
    run("evidence", spec, *options, cwd=folder, code=0)
    return folder / "evidence"


@pytest.fixture(scope="session")
def matrices_folder(tmp_path_factory):
    return made(tmp_path_factory.mktemp("matrices"), COMMUTING)


@pytest.fixture(scope="session")
def sampled_folder(tmp_path_factory):
    return made(tmp_path_factory.mktemp("sampled"), SAMPLED)


@pytest.fixture
def folder(matrices_folder, tmp_path):
    """A copy of evidence for given matrices, to change."""
    return shutil.copytree(matrices_folder, tmp_path / "evidence")

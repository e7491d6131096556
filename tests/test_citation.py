"""CITATION.cff keeps to version 1.2.0 of its format, and to what the package says of itself."""

import re
import tomllib

from ruamel.yaml import YAML

import nrs_design
from tests.support import ROOT

CITATION = YAML(typ="safe").load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
# All keys at the top that the schema of the format knows.
TOP = {
    *("abstract", "authors", "cff-version", "commit", "contact", "date-released", "doi"),
    *("identifiers", "keywords", "license", "license-url", "message", "preferred-citation"),
    *("references", "repository", "repository-artifact", "repository-code", "title", "type"),
    *("url", "version"),
}
OF_ENTITIES = {"name", "address", "city", "country", "email", "website", "orcid", "alias"}


def test_keys_and_authors_are_those_of_the_format():
    assert CITATION.keys() >= {"cff-version", "message", "title", "authors"}
    assert CITATION.keys() <= TOP
    assert (CITATION["cff-version"], CITATION["type"]) == ("1.2.0", "software")
    assert len(set(CITATION["keywords"])) == len(CITATION["keywords"])
    (thesis,) = CITATION["references"]
    for work in (CITATION, thesis):
        assert work["authors"]
        assert all("name" in one and one.keys() <= OF_ENTITIES for one in work["authors"])
    assert CITATION["authors"] == [{"name": "nrs-design contributors"}]


def test_the_dissertation_is_a_reference():
    (thesis,) = CITATION["references"]
    assert thesis["type"] == "thesis"
    assert thesis["institution"].keys() <= OF_ENTITIES
    page = (ROOT / "docs/explanation/thesis.md").read_text(encoding="utf-8")
    assert thesis["title"] in page
    assert thesis["institution"]["name"] in page


def test_version_and_licence_are_those_of_the_package():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert CITATION["version"] == nrs_design.__version__
    assert CITATION["license"] == project["license"]["text"]
    assert CITATION["title"] == project["name"]
    assert re.fullmatch(r"[\w .,-]+", CITATION["abstract"])

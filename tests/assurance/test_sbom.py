"""The parts list against what CycloneDX 1.5 asks for (schema bom-1.5, ECMA-424's forerunner)."""

import re
from importlib.metadata import PackageNotFoundError, distribution

import jsonschema
import pytest

from nrs_design.assurance import sbom
from nrs_design.errors import NrsDesignError

TEXT = {"type": "string", "minLength": 1}
# What the format says of the parts that we write; nothing else may be in them.
COMPONENT = {
    "type": "object",
    "required": ["type", "name"],
    "additionalProperties": False,
    "properties": {
        "type": {"enum": ["application", "library", "platform"]},
        "bom-ref": TEXT,
        "name": TEXT,
        "version": TEXT,
        "purl": {"type": "string", "pattern": r"^pkg:pypi/[a-z0-9-]+@[^@/ ]+$"},
        "licenses": {
            "oneOf": [
                {
                    "type": "array",
                    "items": {
                        "type": "object",
                        "required": ["license"],
                        "additionalProperties": False,
                        "properties": {
                            "license": {
                                "type": "object",
                                "required": ["name"],
                                "additionalProperties": False,
                                "properties": {"name": TEXT},
                            }
                        },
                    },
                },
                {
                    "type": "array",
                    "minItems": 1,
                    "maxItems": 1,
                    "items": {
                        "type": "object",
                        "required": ["expression"],
                        "additionalProperties": False,
                        "properties": {"expression": TEXT},
                    },
                },
            ]
        },
    },
}
BOM = {
    "type": "object",
    "required": ["bomFormat", "specVersion"],
    "additionalProperties": False,
    "properties": {
        "bomFormat": {"const": "CycloneDX"},
        "specVersion": {"const": "1.5"},
        "version": {"type": "integer", "minimum": 1},
        "metadata": {
            "type": "object",
            "additionalProperties": False,
            "properties": {"component": COMPONENT},
        },
        "components": {"type": "array", "items": COMPONENT, "uniqueItems": True},
        "dependencies": {
            "type": "array",
            "uniqueItems": True,
            "items": {
                "type": "object",
                "required": ["ref"],
                "additionalProperties": False,
                "properties": {
                    "ref": TEXT,
                    "dependsOn": {"type": "array", "items": TEXT, "uniqueItems": True},
                },
            },
        },
    },
}


@pytest.fixture(scope="module")
def document():
    return sbom.parts_list()


def test_the_document_is_as_the_format_asks(document):
    jsonschema.Draft7Validator(BOM).validate(document)


def test_references_are_unique_and_lead_to_components(document):
    parts = [document["metadata"]["component"], *document["components"]]
    refs = [part["bom-ref"] for part in parts]
    assert len(refs) == len(set(refs))
    for entry in document["dependencies"]:
        assert {entry["ref"], *entry["dependsOn"]} <= set(refs)
    # Whatever is listed is needed by something, from the tool down.
    needed = {ref for entry in document["dependencies"] for ref in entry["dependsOn"]}
    assert needed == set(refs[1:])


def test_it_lists_what_is_installed_and_needed(document):
    versions = {part["name"].lower(): part["version"] for part in document["components"]}
    declared = [re.match(r"[\w-]+", text)[0] for text in distribution("nrs-design").requires or ()]
    extras = [text for text in distribution("nrs-design").requires or () if "extra ==" in text]
    assert "numpy" in declared
    assert versions["numpy"] == distribution("numpy").version
    assert versions["python-flint"] == distribution("python-flint").version
    # Of matplotlib, which the tool needs.
    assert versions["pillow"] == distribution("pillow").version
    assert any(text.startswith("pytest") for text in extras)
    assert "pytest" not in versions


def test_what_runs_without_being_installed_has_no_list(monkeypatch):
    def missing(name):
        raise PackageNotFoundError(name)

    monkeypatch.setattr(sbom, "distribution", missing)
    with pytest.raises(NrsDesignError, match="nrs-design is not installed") as caught:
        sbom.parts_list()
    assert caught.value.remedy

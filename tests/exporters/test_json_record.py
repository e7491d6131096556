"""The record as a file: read again, it is the same record; without one there is no file."""

import json
from dataclasses import replace

import pytest

from nrs_design.errors import DesignError
from nrs_design.exporters import format_of
from nrs_design.exporters.formats.json import render
from nrs_design.exporters.record import ExportRecord


def test_the_file_is_the_record(sampled_export):
    files = render(sampled_export)
    assert files.keys() == format_of("json").files.keys()
    (content,) = files.values()
    assert content.startswith(*format_of("json").files.values())
    assert ExportRecord.model_validate_json(content) == sampled_export.record
    # Everywhere the same bytes, and every number of them one that JSON has.
    assert content == content.decode("ascii").encode()
    json.loads(content, parse_constant=pytest.fail)


def test_what_may_not_be_exported_is_no_file(sampled_export):
    refused = replace(sampled_export, record=None, reason="the design is not proved: refuted")
    with pytest.raises(DesignError, match="not exported: the design is not proved"):
        render(refused)

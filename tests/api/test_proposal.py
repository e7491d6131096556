"""Proposals in JSON files, whichever program found them."""

import json

import numpy as np
import pytest

from nrs_design.api.proposal import read_proposal
from nrs_design.errors import DataError

A = np.array([[[-1.0, -1.0], [1.0, -1.0]], [[-1.0, -5.0], [0.25, -1.0]]])
P = np.diag([1.0, 5.0])


def check(proposal):
    assert tuple(proposal.modes) == ("A1", "A2")
    assert [np.array(M, float).tolist() for M in proposal.modes.values()] == A.tolist()
    assert np.array(proposal.P, float).tolist() == P.tolist()


def test_a_list_of_modes_and_numbered_ones(tmp_path):
    file = tmp_path / "a.json"
    file.write_text(json.dumps({"A": A.tolist(), "P": P.tolist()}))
    check(read_proposal(file))
    numbered = {"A2": A[1].tolist(), "A1": A[0].tolist(), "P": P.tolist(), "time": "discrete"}
    file.write_text(json.dumps(numbered))
    found = read_proposal(file)
    check(found)
    assert (found.rate, found.time) == (None, "discrete")


def test_json_reads_decimals_as_written(tmp_path):
    file = tmp_path / "a.json"
    file.write_text('{"A": {"in": [[-0.1]], "out": [["-1/3"]]}, "P": [[1]], "rate": 0.05}')
    found = read_proposal(file)
    assert found.modes == {"in": [["-0.1"]], "out": [["-1/3"]]}
    assert found.rate == "0.05"


def test_one_matrix_alone(tmp_path):
    (tmp_path / "a.json").write_text(json.dumps({"A": A[0].tolist(), "P": P.tolist()}))
    assert list(read_proposal(tmp_path / "a.json").modes) == ["A1"]


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("a.json", b"{", "cannot be read"),
        ("a.json", b"[]", "expected a JSON object"),
        ("a.json", b'{"P": [[1]], "A1": [[5]], "A1": [[-1]]}', "occurs twice"),
        ("a.json", b'{"P": [[1]], "A": {"a": [[5]], "a": [[-1]]}}', "occurs twice"),
        ("a.json", b'{"P": [[1]], "A": [[-1]], "Time": "discrete"}', "'Time' is not known"),
        ("a.json", b'{"A": [[1]]}', "holds no `P`"),
        ("a.json", b'{"P": [[1]]}', "holds no modes"),
        ("a.json", b'{"P": [[1]], "A": []}', "holds no modes"),
        ("a.json", b'{"P": [[1]], "A": [[1]], "A1": [[1]]}', "both `A` and numbered"),
        ("a.json", b'{"P": [[1]], "A": [[1]], "time": "now"}', "`time` is neither"),
        ("a.json", b'{"P": [[NaN]], "A": [[1]]}', "not a finite number"),
        ("a.json", b"\xff", "cannot be read"),
        ("a.json", b'{"P": [[1]], "A%s": [[1]]}' % (b"1" * 5000), "is not known here"),
        ("a.json", b'{"P": [[1]], "A": [%s1]}' % (b"1," * 200_000), "more than 200000 entries"),
        ("a.json", b'{"P": [[1]], "A": [%s[]]}' % (b"[]," * 600_000), "more than 1000000 values"),
        ("a.json", b" " * (16 * 2**20 + 1), "larger than"),
        ("a.npz", b"PK", "are not read"),
        ("a.mat", b"MATLAB", "are not read"),
        ("a.txt", b"", "are not read"),
    ],
)
def test_wrong_files_are_refused(tmp_path, name, content, said):
    file = tmp_path / name
    file.write_bytes(content)
    with pytest.raises(DataError, match=said):
        read_proposal(file)


def test_an_empty_row_is_a_matrix_of_none(tmp_path):
    (tmp_path / "a.json").write_text('{"P": [[1]], "A": [[]]}')
    assert read_proposal(tmp_path / "a.json").modes == {"A1": [[]]}


def test_missing_file(tmp_path):
    with pytest.raises(DataError, match="No such file"):
        read_proposal(tmp_path / "a.json")

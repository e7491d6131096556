"""Proposals in files of other programs."""

import json
import struct
import zlib

import numpy as np
import pytest
import scipy.io

from nrs_design.arrays.files import read_proposal
from nrs_design.errors import DataError

A = np.array([[[-1.0, -1.0], [1.0, -1.0]], [[-1.0, -5.0], [0.25, -1.0]]])
P = np.diag([1.0, 5.0])


def check(proposal, names=("A1", "A2")):
    assert tuple(proposal.modes) == names
    assert [np.array(M).tolist() for M in proposal.modes.values()] == A.tolist()
    assert np.array(proposal.P).tolist() == P.tolist()


def test_times_are_no_numbers(tmp_path):
    np.savez(tmp_path / "a.npz", A=A.astype("timedelta64[s]"), P=P)
    with pytest.raises(DataError, match="A holds times or dates"):
        read_proposal(tmp_path / "a.npz")


def test_npz_stack_and_numbered(tmp_path):
    np.savez(tmp_path / "a.npz", A=A, P=P)
    check(read_proposal(tmp_path / "a.npz"))
    np.savez(tmp_path / "b.npz", A2=A[1], A1=A[0], P=P, rate=0.5, time="discrete")
    found = read_proposal(tmp_path / "b.npz")
    check(found)
    assert (found.rate, found.time) == (0.5, "discrete")


def test_mat_stack_cells_and_numbered(tmp_path):
    scipy.io.savemat(tmp_path / "a.mat", {"A": np.moveaxis(A, 0, 2), "P": P})
    check(read_proposal(tmp_path / "a.mat"))
    cells = np.empty((1, 2), dtype=object)
    cells[0, 0], cells[0, 1] = A
    scipy.io.savemat(tmp_path / "b.mat", {"A": cells, "P": P, "rate": 0.25, "time": "continuous"})
    found = read_proposal(tmp_path / "b.mat")
    check(found)
    assert (found.rate, found.time) == (0.25, "continuous")
    scipy.io.savemat(tmp_path / "c.mat", {"A1": A[0], "A2": A[1], "P": P})
    check(read_proposal(tmp_path / "c.mat"))


def test_json_reads_decimals_as_written(tmp_path):
    file = tmp_path / "a.json"
    file.write_text('{"A": {"in": [[-0.1]], "out": [["-1/3"]]}, "P": [[1]], "rate": 0.05}')
    found = read_proposal(file)
    assert found.modes == {"in": [["-0.1"]], "out": [["-1/3"]]}
    assert found.rate == "0.05"


def test_one_matrix_alone(tmp_path):
    np.savez(tmp_path / "a.npz", A=A[0], P=P)
    assert list(read_proposal(tmp_path / "a.npz").modes) == ["A1"]
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
        ("a.json", b'{"P": [[1]], "A": [[1]], "time": "now"}', "`time` is not known"),
        ("a.json", b'{"P": [[NaN]], "A": [[1]]}', "not a finite number"),
        ("a.json", b"\xff", "cannot be read"),
        ("a.json", b'{"P": [[1]], "A%s": [[1]]}' % (b"1" * 5000), "is not known here"),
        ("a.json", b'{"P": [[1]], "A": [%s1]}' % (b"1," * 200_000), "more than 200000 entries"),
        ("a.json", b'{"P": [[1]], "A": [%s[]]}' % (b"[]," * 600_000), "more than 1000000 values"),
        ("a.json", b" " * (16 * 2**20 + 1), "is larger than"),
        ("a.npz", b"PK", "cannot be read"),
        ("a.mat", b"MATLAB", "cannot be read"),
        ("a.txt", b"", "are not read"),
    ],
)
def test_wrong_files_are_refused(tmp_path, name, content, said):
    file = tmp_path / name
    file.write_bytes(content)
    with pytest.raises(DataError, match=said):
        read_proposal(file)


def test_pickles_are_never_loaded(tmp_path):
    np.savez(tmp_path / "a.npz", A=np.array([{"evil": 1}], dtype=object), P=P)
    with pytest.raises(DataError, match="cannot be read"):
        read_proposal(tmp_path / "a.npz")


def test_an_empty_row_is_a_matrix_of_none(tmp_path):
    (tmp_path / "a.json").write_text('{"P": [[1]], "A": [[]]}')
    assert read_proposal(tmp_path / "a.json").modes == {"A1": [[]]}


def test_few_bytes_with_many_entries_are_refused(tmp_path):
    """What takes more than the process that reads may hold ends there: `tests/test_confined.py`."""
    many = np.zeros((500, 500), dtype=np.int8)
    np.savez_compressed(tmp_path / "b.npz", P=many)
    scipy.io.savemat(tmp_path / "b.mat", {"P": many}, do_compression=True)
    for suffix in (".npz", ".mat"):
        with pytest.raises(DataError, match="more than 200000 entries"):
            read_proposal(tmp_path / f"b{suffix}")


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("packed", [False, True])
def test_cells_in_each_other_do_not_exhaust_the_stack(tmp_path, order, packed):
    (tmp_path / "a.mat").write_bytes(nested_cells(100_000, order, packed))
    with pytest.raises(DataError):
        read_proposal(tmp_path / "a.mat")


def nested_cells(depth, order, packed):
    """Write a MATLAB file with a cell in a cell in a cell ..."""
    cell = struct.pack(f"{order}II IIII IIii II", 14, 48, 6, 8, 1, 0, 5, 8, 1, 1, 1, 0)
    content = cell * depth + struct.pack(f"{order}II", 14, 0)
    if packed:
        content = zlib.compress(content)
        content = struct.pack(f"{order}II", 15, len(content)) + content
    marks = struct.pack(f"{order}HH", 0x100, 0x4D49)
    return b"MATLAB 5.0 MAT-file".ljust(124) + marks + content


def test_missing_file(tmp_path):
    with pytest.raises(DataError, match="is not a file"):
        read_proposal(tmp_path / "a.json")

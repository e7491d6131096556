"""``nrs-design check-lyapunov`` as a user types it."""

import json

import numpy as np

from tests.support import ROOT, document_of, run, typed

EXAMPLE = ROOT / "docs" / "examples" / "lyapunov.json"


def test_holds(tmp_path):
    done = typed("check-lyapunov", EXAMPLE, cwd=tmp_path, code=0)
    assert done.stdout.startswith("HOLDS")
    assert "alpha >= 0.105572 1/s" in done.stdout
    assert "every mode: a, b" in done.stdout


def test_rate_that_is_too_fast(tmp_path):
    document = document_of("check-lyapunov", EXAMPLE, "--rate", "0.11", cwd=tmp_path, code=1)
    assert document["schema"] == "nrs-design/check-lyapunov/1"
    assert (document["holds"], document["weak"]) == (False, True)
    assert document["counterexample"]["mode"] in ("a", "b")
    assert document["modes"] == ["a", "b"]


def test_decay_that_is_slower_than_asked_is_told(tmp_path):
    """x' = -x decays, though not at the rate 2: nobody may read that it does not."""
    file = tmp_path / "a.json"
    file.write_text('{"A": [[-1]], "P": [[1]], "rate": 2}')
    done = run("check-lyapunov", file, cwd=tmp_path, code=1)
    assert "in mode A1 it does not decrease at this rate" in done.stdout
    assert "x' (A'P + PA + 2 alpha P) x = 2" in done.stdout
    assert "decreases strictly in every mode, proved at alpha >= 0.999" in done.stdout
    assert "no decay" not in done.stdout


def test_an_option_does_not_turn_a_rate_in_one_over_seconds_into_one_per_step(tmp_path):
    file = tmp_path / "a.json"
    file.write_text('{"A": [["-0.3"]], "P": [[1]], "rate": "0.4", "time": "continuous"}')
    done = run("check-lyapunov", file, "--discrete", cwd=tmp_path, code=2)
    assert "its time is continuous" in done.stderr


def test_wrong_input(tmp_path):
    for name in ("missing.mat", "missing.txt"):
        assert run("check-lyapunov", name, cwd=tmp_path, code=2).stderr.startswith("error[NRS006]")
    file = tmp_path / "a.json"
    file.write_text('{"A": [[0.5]], "P": [[1]]}')
    for rate in ("-1", "fast", "nan"):
        run("check-lyapunov", file, f"--rate={rate}", cwd=tmp_path, code=2)


def write_matrices(file, A, P):
    file.write_text(json.dumps({"A": A.tolist(), "P": P.tolist()}))


def test_large_numbers(tmp_path):
    file = tmp_path / "a.json"
    write_matrices(file, np.ones((40, 40)) / 3 - 40 * np.eye(40), np.eye(40) / 3 + 0.001)
    run("check-lyapunov", file, "--rate", "1", cwd=tmp_path, code=0)
    write_matrices(file, np.ones((30, 30)) / 3 + np.diag(np.arange(30) / 7 - 40), -np.eye(30) / 3)
    run("check-lyapunov", file, cwd=tmp_path, code=1)
    # A vector with integers of more than 4300 digits.
    n = 24
    long = [[f"{7 ** (90 - i - j)}.{3 ** (i * j % 9)}" for j in range(n)] for i in range(n)]
    write_matrices(file, -np.eye(n), np.array(long))
    for option in ((), ("--json",)):
        run("check-lyapunov", file, *option, cwd=tmp_path, code=1)

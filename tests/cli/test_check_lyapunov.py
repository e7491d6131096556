"""``nrs-design check-lyapunov`` as a user types it."""

import json

import numpy as np

from tests.support import run


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

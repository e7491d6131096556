"""Readers as a hostile file may turn them, to be run by `nrs_design.confined`."""

import os
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np


def told(file, path) -> Any:
    return {
        "all": file.read(),
        "numbers": [1, 2.5, True, None, 1 + 2j, "text"],
        "array": np.arange(6).reshape(2, 3),
        "words": np.array(["a", "bc"]),
        "folder": os.listdir(),
        "secret": os.environ.get("SECRET"),
        "places": [place for place in sys.path if not os.path.isabs(place)],
        "modules": sorted({"evil"} & sys.modules.keys()),
        "path": str(path),
    }


def crash(file, path) -> Any:
    os.abort()


def memory(file, path) -> Any:
    return bytes(8 << 30)


def processor(file, path) -> Any:
    while True:
        pass


def sleep(file, path) -> Any:
    time.sleep(60)


def leave(file, path) -> Any:
    os._exit(0)


def pickled(file, path) -> Any:
    return np.array([print], dtype=object)


def large(file, path) -> Any:
    return np.zeros(1 << 24, np.int8)


def write(file, path) -> Any:
    Path("a").write_text("a")


def outside(file, path) -> Any:
    Path(str(path) + ".new").write_text("a")


def remove(file, path) -> Any:
    os.remove(path)


def program(file, path) -> Any:
    subprocess.run(["true"], check=True)


def fork(file, path) -> Any:
    os.fork()


def network(file, path) -> Any:
    socket.create_connection(("127.0.0.1", 9), timeout=1)


def print_much(file, path) -> Any:
    print("no answer")
    os.write(2, b"no answer")
    return "answer"

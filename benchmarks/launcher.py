"""Run a command and print what it took as JSON. Imports as little as possible."""

import json
import os
import sys
import tempfile
import time


def main() -> None:
    with tempfile.TemporaryFile() as output:
        start = time.perf_counter()
        actions = [(os.POSIX_SPAWN_DUP2, output.fileno(), 1)]
        pid = os.posix_spawn(sys.argv[1], sys.argv[1:], os.environ, file_actions=actions)
        _, status, usage = os.wait4(pid, 0)
        seconds = time.perf_counter() - start
        output.seek(0)
        text = output.read().decode()
    facts = {
        "seconds": seconds,
        "processor": usage.ru_utime + usage.ru_stime,
        "megabytes": usage.ru_maxrss / 1024,
        "output": text,
        "code": os.waitstatus_to_exitcode(status),
    }
    print(json.dumps(facts))


main()

"""What workers of tests do; it loads nothing that takes time."""

import os
import signal


def square(point):
    return point * point


def killed(own, point):
    assert os.getpid() != own
    os.kill(os.getpid(), signal.SIGKILL)

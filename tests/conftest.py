"""Settings of libraries, for all tests.

One thread for small matrices, as the commands of the program set it: tests run side by side. And no
deadline for examples of hypothesis: how fast a machine is decides nothing.
"""

import os

from hypothesis import settings

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")

"""One thread for small matrices, as the commands of the program set it: tests run side by side."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

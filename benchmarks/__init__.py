"""Speed against what a user would do without this package, measured side by side in one run."""

import os

# One thread for small matrices on both sides, as the commands of this package set it; it counts
# only before NumPy is loaded.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

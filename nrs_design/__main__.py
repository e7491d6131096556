"""Run the command line as ``python -m nrs_design``.

Python then looks for modules in the working folder first, which may be a stranger's. From here on
none is imported from there; ``python -P -m nrs_design`` and ``nrs-design`` do so from the start.
"""

import sys

if __name__ == "__main__":
    if not sys.flags.safe_path:
        del sys.path[0]
    from nrs_design.cli import main

    main()

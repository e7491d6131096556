"""Run the command line as ``python -m nrs_design``."""

from nrs_design.cli import main

if __name__ == "__main__":
    main()

"""Records that are shipped."""

from tests.support import ROOT

DATA = ROOT / "specs" / "data"
SOFT = sorted(DATA.glob("silicone-soft-*.csv"))
NOSE = sorted(DATA.glob("nose-*.csv"))
SINUSOIDS = sorted(DATA.glob("actuator-*hz.csv"))

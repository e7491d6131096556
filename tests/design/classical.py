"""What the thesis's loop G Ze H Y bears, by python-control: an oracle for margins."""

import math
from types import SimpleNamespace

import control
import numpy as np

from nrs_design.design.impedance import open_loop
from nrs_design.design.transfer import frequency_response, to_control


def loop_margins(loop, Mt, Bt):
    """Crossovers by python-control, peaks on a fine grid."""
    tf = open_loop(loop, Mt, Bt)
    gains, degrees, _, at_gain, at_phase, _ = control.stability_margins(
        to_control(tf), returnall=True
    )
    phases = [(math.radians(d), w) for d, w in zip(degrees, at_phase, strict=True) if w > 0]
    S = 1 / (1 + frequency_response(tf, np.geomspace(1e-2, 1e5, 400_001)))
    return SimpleNamespace(
        sensitivity_peak=max(1.0, np.abs(S).max()),
        gain_margin=min(
            # The pole of the integrator shows as a crossover at zero frequency.
            (g for g, w in zip(gains, at_gain, strict=True) if w > 0 and g > 1),
            default=math.inf,
        ),
        phase_margin=min((abs(phase) for phase, _ in phases), default=math.inf),
        # A delay only takes phase away: a lead of -10 degrees is lost after 350 more.
        delay_margin=min((phase % (2 * math.pi) / w for phase, w in phases), default=math.inf),
        disk_margin=min(2.0, 1 / np.abs(S - 0.5).max()),
    )

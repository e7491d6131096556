"""Motion loops and contact of the published designs."""

from nrs_design.design.transfer import TransferFunction

# Thesis 6.1 as printed, and with the exact coefficients of Kd = 2060, z = 56.9706.
PRINTED = TransferFunction((0.99, 56.82), (0.0351, 1.99, 56.82))
EXACT = TransferFunction((0.9974, 56.822), (0.0351, 1.9974, 56.822))
SOFT = 43.0356

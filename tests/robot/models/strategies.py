"""Poses and motions for property tests."""

from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

ANGLES = st.floats(-0.24, 0.24)
# Every leg reaches these with a margin.
poses = st.tuples(ANGLES, st.floats(-0.33, 0.33), st.floats(0.155, 0.24))
rates = arrays(float, 3, elements=st.floats(-3, 3, allow_subnormal=False))
tilts = st.floats(-1.3, 0.0)

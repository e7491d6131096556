"""Your robot from Python: a notebook, which the documentation runs and the tests check."""

# ruff: noqa: E402

# %% [markdown]
# # Your robot from Python
#
# A notebook that every build of these pages runs: what stands below a cell is what it printed.
# Take it along as [a notebook of Jupyter](tutorial-python.ipynb) and run it in a checkout, in whose
# folder `specs` the robot of the examples lies.
#
# You will decide a switched system that you type in, prove a robot, see it fail and mend it, check
# somebody else's Lyapunov function, and take the proof along. The same from the shell:
# [your robot in twenty minutes](tutorial.md).
#
# ## Part 1: two matrices
#
# Two modes, each stable alone. May they be switched at will?

# %%
import nrs_design as nrs

slow = [[-1, -1], [1, -1]]
fast = [[-1, -6], ["1/6", -1]]
decision = nrs.certify({"slow": slow, "fast": fast})
print(decision.verdict, "- a common quadratic function:", decision.common_quadratic)
print(decision.claim)

# %% [markdown]
# Proved, although no quadratic function does it: both statements are exact, about exactly these
# numbers. `"1/6"` is one sixth; the float `1 / 6` would be another number next to it.
#
# Stretch the second mode a little more, and it is over:

# %%
stretched = [[-1, -13], ["1/13", -1]]
refuted = nrs.certify({"slow": slow, "fast": stretched})
print(refuted.verdict)
print(refuted.claim)

# %% [markdown]
# The claim names the signal that makes it grow. That is the witness: simulate it, and see.

# %%
refuted.plot()

# %% [markdown]
# ## Part 2: a robot
#
# A spec file says what the world is like and what is wanted. This one has two impedance controllers
# for soft tissue, between which the robot of the dissertation switches.

# %%
study = nrs.load("specs/neuroboscope/soft-tissue.nrs.yaml")
for controller in study.design().controllers:
    gains = controller.law
    Mt, Bt = float(gains.Mt), float(gains.Bt)
    print(f"{controller.name}: Mt = {Mt:.6g} kg m^2, Bt = {Bt:.6g} N m s/rad")

# %%
proved = study.certify()
print(proved.verdict, "at", proved.decay_rate, "1/s")
proved.plot()

# %% [markdown]
# The line is a bad run, found by an adversary; the bound above it is the claim. The run is an
# illustration and the bound is proved. What it takes for granted belongs to the claim:

# %%
for line in proved.assumptions[:4]:
    print("-", line)

# %% [markdown]
# ## Part 3: a range that is too wide
#
# One controller, whose contact may jump between 1 and 200 N m/rad. Every constant stiffness is
# stable.

# %%
wide = nrs.load("docs/examples/wide-range.nrs.yaml").certify()
modes = wide.state_spaces()
for name, mode in modes.items():
    print(name, "slowest pole", round(max(mode.poles().real), 2), "1/s")
print(wide.verdict)

# %% [markdown]
# Poles say nothing about switching. Which range would do? Lower its end until there is a proof;
# from the shell, `certify-switching --margin` [does this for you](sweeps.md#margin).

# %%
from pathlib import Path
from tempfile import mkdtemp

folder = Path(mkdtemp())
text = Path("docs/examples/wide-range.nrs.yaml").read_text(encoding="utf-8")
for top in (150, 100, 50):
    file = folder / "narrower.nrs.yaml"
    narrower = text.replace("range: [1 N*m/rad, 200 N*m/rad]", f"range: [1 N*m/rad, {top} N*m/rad]")
    file.write_text(narrower.replace("name: wide-range", "name: narrower"), encoding="utf-8")
    narrow = nrs.load(file).certify()
    print(f"1 to {top} N m/rad: {narrow.verdict}")
    if narrow.verdict == "proved":
        break

# %% [markdown]
# ## Part 4: somebody else's function
#
# A solver has given you a P, in floating point. Does `x' P x` decrease in every mode? A solver's
# "optimal" does not say so; exact arithmetic does.

# %%
import numpy as np
from scipy.linalg import solve_continuous_lyapunov

A = np.array([[0.0, 1.0], [-2.0, -3.0]])
P = solve_continuous_lyapunov(A.T, -np.eye(2))
found = nrs.check_lyapunov([A], P)
print("holds:", found.holds, "at the rate", found.rate, "1/s")

# %%
other = nrs.check_lyapunov([A, [[0, 1], [-20, "-0.1"]]], P)
print("holds for both modes:", other.holds)
witness = other.counterexample
print("fails in", witness.mode, "at x =", [str(x) for x in witness.vector])

# %% [markdown]
# ## Part 5: take the proof along
#
# A certificate is a file that anybody can check again: exactly, without a solver, within a moment.

# %%
file = proved.save(folder / "certificates")
checked = nrs.verify(file, "specs/neuroboscope/soft-tissue.nrs.yaml")
print(file.name, "holds:", checked.fault is None)

# %% [markdown]
# Whoever changes one digit of it is found out:

# %%
forged = folder / "forged.cert.json"
content = file.read_text(encoding="utf-8").replace('"verdict": "proved"', '"verdict": "refuted"', 1)
forged.write_text(content, encoding="utf-8")
print(nrs.verify(forged).fault)

# %% [markdown]
# Next: [what a certificate claims](certificates/README.md), [all of the library](python.md) and its
# [reference](reference/library.md), [the loop that a processor runs](design/sampling.md).

"""Every system with a known answer, certified without being told anything about it."""

import pytest

from .known import names, settle


@pytest.mark.parametrize("name", names("continuous", "discrete"))
def test_known_answer(name):
    settle(name)


@pytest.mark.parametrize(
    "coordinates", ["deflection", pytest.param("force", marks=pytest.mark.slow)]
)
@pytest.mark.parametrize("name", names("robot"))
def test_known_answer_of_the_robot(name, coordinates):
    settle(name, coordinates=coordinates)

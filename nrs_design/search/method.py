"""Names of search methods; imports nothing, for the help of the command line."""

from enum import StrEnum


class Method(StrEnum):
    """The rungs of the ladder, or all of them in turn."""

    AUTO = "auto"
    CONEWISE_MODE_QUADRATIC = "conewise-mode-quadratic"
    CONEWISE_POLYNOMIAL = "conewise-polynomial"
    CONEWISE_QUADRATIC = "conewise-quadratic"
    LMI = "lmi"
    GRADIENT = "gradient"
    OBSTRUCTION = "obstruction"
    MEMORY_POLYNOMIAL = "memory-polynomial"
    MEMORY_QUADRATIC = "memory-quadratic"
    MIXTURE = "mixture"
    MODE_POLYNOMIAL = "mode-polynomial"
    MODE_QUADRATIC = "mode-quadratic"
    CONSTANTS_QUADRATIC = "constants-quadratic"
    PERIOD = "period"
    PERIODIC_QUADRATIC = "periodic-quadratic"
    POLYNOMIAL = "polynomial"
    VALUE = "value"

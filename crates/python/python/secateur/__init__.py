"""Levels of detail of trees and other plants in glTF.

>>> import secateur
>>> oak = secateur.grow("oak", leaves=500)
>>> level = oak.level(triangles=0.1)
>>> level.to_bytes()[:4]
b'glTF'

The stubs beside this file document everything; ``secateur --help`` is the program.
"""

from ._errors import Cancelled, Error, InputError, MachineError, UsageError
from ._secateur import (
    Level,
    Levels,
    Observation,
    Plant,
    __version__,
    from_arrays,
    grow,
    judge,
    open,
)

__all__ = [
    "Cancelled",
    "Error",
    "InputError",
    "Level",
    "Levels",
    "MachineError",
    "Observation",
    "Plant",
    "UsageError",
    "__version__",
    "from_arrays",
    "grow",
    "judge",
    "open",
]

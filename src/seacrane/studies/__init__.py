"""Many runs of one question: so far, the search for better designs.

for front in studies.optimise(crane, variables, goals): ...
front.design(int(np.flatnonzero(front.best)[0]))
"""

from seacrane.studies.optimisation import (
    Front,
    Goal,
    Variable,
    judged,
    loads,
    optimise,
    plain,
    read,
    save,
    specification,
    why_not,
)

__all__ = [
    "Front",
    "Goal",
    "Variable",
    "judged",
    "loads",
    "optimise",
    "plain",
    "read",
    "save",
    "specification",
    "why_not",
]
"""Names for users of the room."""

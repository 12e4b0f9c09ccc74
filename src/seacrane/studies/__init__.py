"""Many runs of one question: so far, the search for better designs.

for front in studies.optimise(crane, variables, goals): front.cranes()
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
)

__all__ = ["Front", "Goal", "Variable", "judged", "loads", "optimise", "plain", "read", "save", "specification"]
"""Names for users of the room."""

"""System Structure and Parameterization (SSP) 1.0 and 2.0, a standard of the Modelica Association: read and written.

`read_ssp` takes an archive (.ssp) or a system structure description (.ssd) with what lies beside it; `write_ssp` writes
either. What the standard has no word for (power bonds, sums of signals, macro step and algorithm) is in annotations of
the type `seacrane.structure` and `seacrane.experiment`, which other tools pass over.
"""

from seacrane.cosim.ssp.reading import read_ssp
from seacrane.cosim.ssp.writing import write_ssp

__all__ = ["read_ssp", "write_ssp"]

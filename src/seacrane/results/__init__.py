"""Named, unit-carrying time series: what a simulation returns, reads from files and plots."""

from typing import TYPE_CHECKING

from seacrane.results.columnar import Converted, StreamWriter
from seacrane.results.files import convert
from seacrane.results.plot import bode, family, overlay
from seacrane.results.recording import Recording, Signal

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Figure

__all__ = ["Converted", "Recording", "Signal", "StreamWriter", "bode", "convert", "family", "overlay"]

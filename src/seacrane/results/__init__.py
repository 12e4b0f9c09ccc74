"""Named, unit-carrying time series: what a simulation returns, reads from files and plots."""

from seacrane.results.plot import bode, family, overlay
from seacrane.results.recording import Recording, Signal

__all__ = ["Recording", "Signal", "bode", "family", "overlay"]

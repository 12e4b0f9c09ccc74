"""Named, unit-carrying time series: what a simulation returns, reads from files and plots."""

from seacrane.results.recording import Recording, Signal

__all__ = ["Recording", "Signal"]

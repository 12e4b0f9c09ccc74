"""The sea: lists of wave components.

sea = ocean.Jonswap(hs=2.5, tp=8.0, seed=7).waves()
sea.elevation(x=0.0, y=0.0, t=10.0)
"""

from seacrane.ocean.waves import Jonswap, WaveList, regular

__all__ = ["Jonswap", "WaveList", "regular"]

"""Numerical building blocks that know nothing of cranes: arrays in, arrays out."""

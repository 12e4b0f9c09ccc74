"""Drawings of diagrams as SVG: bond graphs and iconic diagrams."""

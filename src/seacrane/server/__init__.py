"""A running simulation for browsers and programs: HTTP, and JSON-RPC 2.0 over WebSocket and TCP.

`serve("package.module:build")` runs the simulation in a process of its own and serves it until interrupted.
"""

from seacrane.server.designer import Desk, serve_designer
from seacrane.server.serve import Server, serve
from seacrane.server.simulation import Factory, Simulation

__all__ = ["Desk", "Factory", "Server", "Simulation", "serve", "serve_designer"]

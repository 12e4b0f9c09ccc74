"""Co-simulation: slaves, the structure that couples them, algorithms, and runs.

    system = System("pendulum on a ship")
    system.add("ship", ModelSlave(ship))
    system.add("crane", FmuSlave("crane.fmu"))
    system.connect("ship.foot.ax", "crane.base.ax")
    with Execution(system, GaussSeidel(step=0.002)) as run:
        recording = run.run(until=60.0)

To extend it, implement `Slave` and `Instance` (what is stepped), `Algorithm` (who steps when) or `Observer` (who
watches).
"""

from seacrane.cosim.algorithms import Algorithm, GaussSeidel, Jacobi, Schedule
from seacrane.cosim.bonds import BondReport
from seacrane.cosim.execution import Execution, State, Usage
from seacrane.cosim.fmu import FmuSlave
from seacrane.cosim.function import FunctionSlave
from seacrane.cosim.model import ModelSlave
from seacrane.cosim.observers import CsvRecorder, MemoryRecorder, Observer
from seacrane.cosim.pacing import Pace, RealTime
from seacrane.cosim.slave import Instance, Interface, NativeCalls, Slave
from seacrane.cosim.structure import Bond, Connection, Connector, Experiment, Transformation
from seacrane.cosim.system import System

__all__ = [
    "Algorithm",
    "Bond",
    "BondReport",
    "Connection",
    "Connector",
    "CsvRecorder",
    "Execution",
    "Experiment",
    "FmuSlave",
    "FunctionSlave",
    "GaussSeidel",
    "Instance",
    "Interface",
    "Jacobi",
    "MemoryRecorder",
    "ModelSlave",
    "NativeCalls",
    "Observer",
    "Pace",
    "RealTime",
    "Schedule",
    "Slave",
    "State",
    "System",
    "Transformation",
    "Usage",
]

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

from seacrane.cosim.actions import Action, Freeze, Offset, Override, Ramp, Release, Scale, Set, Stop
from seacrane.cosim.algorithms import (
    ALGORITHMS,
    Adaptive,
    Algorithm,
    FixedPoint,
    GaussSeidel,
    Iterative,
    Jacobi,
    Newton,
    PowerResidual,
    Schedule,
    StepDoubling,
)
from seacrane.cosim.bonds import BondReport
from seacrane.cosim.diagnosis import BondDiagnosis, BondTrial, Diagnosis, Trial, diagnose
from seacrane.cosim.execution import Execution, Usage
from seacrane.cosim.files import load
from seacrane.cosim.fmu import FmuSlave
from seacrane.cosim.function import FunctionSlave
from seacrane.cosim.model import ModelSlave
from seacrane.cosim.observers import ArrowRecorder, CsvRecorder, MemoryRecorder, Observer
from seacrane.cosim.osp import read_osp
from seacrane.cosim.pacing import Pace, RealTime
from seacrane.cosim.recorded import RecordedSlave
from seacrane.cosim.saved import State
from seacrane.cosim.scenario import Event, Scenario
from seacrane.cosim.slave import Instance, Interface, NativeCalls, Slave
from seacrane.cosim.ssp import read_ssp, write_ssp
from seacrane.cosim.structure import Bond, Connection, Connector, Experiment, Transformation
from seacrane.cosim.system import System
from seacrane.cosim.triggers import Above, Below, Condition
from seacrane.cosim.watchdog import Late

__all__ = [
    "ALGORITHMS",
    "Above",
    "Action",
    "Adaptive",
    "Algorithm",
    "ArrowRecorder",
    "Below",
    "Bond",
    "BondDiagnosis",
    "BondReport",
    "BondTrial",
    "Condition",
    "Connection",
    "Connector",
    "CsvRecorder",
    "Diagnosis",
    "Event",
    "Execution",
    "Experiment",
    "FixedPoint",
    "FmuSlave",
    "Freeze",
    "FunctionSlave",
    "GaussSeidel",
    "Instance",
    "Interface",
    "Iterative",
    "Jacobi",
    "Late",
    "MemoryRecorder",
    "ModelSlave",
    "NativeCalls",
    "Newton",
    "Observer",
    "Offset",
    "Override",
    "Pace",
    "PowerResidual",
    "Ramp",
    "RealTime",
    "RecordedSlave",
    "Release",
    "Scale",
    "Scenario",
    "Schedule",
    "Set",
    "Slave",
    "State",
    "StepDoubling",
    "Stop",
    "System",
    "Transformation",
    "Trial",
    "Usage",
    "diagnose",
    "load",
    "read_osp",
    "read_ssp",
    "write_ssp",
]

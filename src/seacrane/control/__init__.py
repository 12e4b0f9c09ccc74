"""What stands between the operator and the valves.

joystick = control.Joystick.of(crane, rope=(38.0, 300.0))
cosim.FunctionSlave(joystick, joystick.inputs, joystick.outputs, state=joystick.start)
"""

from seacrane.control.joystick import HOIST, SLEW, Axis, JointAxis, Joystick, axis_names
from seacrane.control.kinematics import KnuckleBoom

__all__ = ["HOIST", "SLEW", "Axis", "JointAxis", "Joystick", "KnuckleBoom", "axis_names"]

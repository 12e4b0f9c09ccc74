"""What stands between the operator and the valves.

joystick = control.Joystick.of(crane, rope=(38.0, 300.0))
cosim.FunctionSlave(joystick, joystick.inputs, joystick.outputs, state=joystick.start)
"""

from seacrane.control.joystick import AXES, Axis, Joystick
from seacrane.control.kinematics import KnuckleBoom

__all__ = ["AXES", "Axis", "Joystick", "KnuckleBoom"]

"""Rigid bodies: motion of analytic surfaces, prescribed or free."""

from anisocontact.rigid.body import COMPONENTS, Pose, RigidBody, turns_in_radian
from anisocontact.rigid.moving import MovingInterface, MovingSurface, motion_derivative
from anisocontact.rigid.rotation import rotation, rotation_vector, skew, spin_of

__all__ = [
    "COMPONENTS",
    "MovingInterface",
    "MovingSurface",
    "Pose",
    "RigidBody",
    "motion_derivative",
    "rotation",
    "rotation_vector",
    "skew",
    "spin_of",
    "turns_in_radian",
]

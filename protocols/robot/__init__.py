"""Descriptions of robots as their makers publish them: URDF, xacro, MJCF."""

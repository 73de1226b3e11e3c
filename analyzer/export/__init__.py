"""A corrected arm for simulators: MJCF, URDF, SDF."""

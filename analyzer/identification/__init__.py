"""Identification: joint stiffness and damping, compliance axes, from modes and FRFs."""

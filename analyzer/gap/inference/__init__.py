"""Fits of a hypothesis, their intervals, and what they foretell of postures they did not see."""

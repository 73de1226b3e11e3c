"""A plant on MuJoCo: rigid bodies, springs and servos in generalised coordinates, hit in time."""

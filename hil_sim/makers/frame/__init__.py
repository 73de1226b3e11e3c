"""An arm as a frame of elastic beams in absolute coordinates, linear about its posture."""

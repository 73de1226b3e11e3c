"""What a corrected model is good for: shaping commands, stiff postures, stable cuts."""

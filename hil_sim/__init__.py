"""The simulated laboratory: plant, board, controller, operator, as processes of their own."""

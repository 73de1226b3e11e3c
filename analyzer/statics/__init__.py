"""How the arm gives under a load at its tool."""

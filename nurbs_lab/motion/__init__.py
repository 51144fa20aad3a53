"""Feedrate v(t), steppers, tool paths and their error (paper 3.1)."""

"""STEP, IGES, 3dm, JSON, G-code, CSV: to and from other programs."""

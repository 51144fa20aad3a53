"""Ordered contours of a mesh (paper, section 2.1)."""

"""Closed meshes to solids of NURBS faces (paper, section 2.3, and beyond)."""

"""Point clouds to triangle meshes (paper, Fig. 7)."""

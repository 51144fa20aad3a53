"""Point cloud, triangles, ordered contours, reconstruction (paper 2.1, 2.3, Fig. 7)."""

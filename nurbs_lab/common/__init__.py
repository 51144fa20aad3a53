"""Helpers of all rooms: checks of arguments, values, progress, threads, executors and the box tree."""

import nurbs_lab.common.kernels  # noqa: F401  (before the first kernel is declared)

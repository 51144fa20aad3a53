"""Helpers of all rooms: checks of arguments, values, progress, threads, executors and the box tree."""

"""Checks of arguments and progress of long work: the helpers that every room shares."""

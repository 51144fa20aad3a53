"""Cutters, finishing and roughing programs, the virtual machine."""

"""Tests of LinuxCNC's own interpreter are left out where it is not installed."""

import shutil


def pytest_collection_modifyitems(config, items):
    if shutil.which("rs274") is None:
        left_out = [item for item in items if item.get_closest_marker("linuxcnc")]
        items[:] = [item for item in items if item not in left_out]
        config.hook.pytest_deselected(items=left_out)

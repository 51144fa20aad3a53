"""Every run tries the same examples, so that only a change makes a test fail; `make fuzz` draws others."""

from hypothesis import settings

if settings.get_current_profile_name() == "default":
    settings.register_profile("repeatable", derandomize=True)
    settings.load_profile("repeatable")

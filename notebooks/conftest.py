"""What nbval compares: everything but stderr, where VTK reports the missing display with a time stamp."""


def pytest_collectstart(collector):
    if hasattr(collector, "skip_compare"):
        collector.skip_compare += ("stderr",)

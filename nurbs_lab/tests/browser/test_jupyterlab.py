"""The notebooks in a real JupyterLab, as a person meets them."""

import pytest

from nurbs_lab.tests.browser.lab import Lab

pytestmark = pytest.mark.browser


def test_the_tour_runs_and_shows_its_pictures(chromium, server):
    lab = Lab(chromium, server, "00-tour")
    cells = lab.run_all()
    lab.screenshot("00-tour")
    assert [cell["error"] for cell in cells if cell["error"]] == []
    assert sum(cell["pictures"] + cell["widgets"] for cell in cells) >= 2
    assert lab.complaints == []

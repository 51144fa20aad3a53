"""The notebooks in a real JupyterLab, as a person meets them."""

import numpy as np
import pytest

from nurbs_lab.tests.browser.lab import Lab

pytestmark = pytest.mark.browser


def test_the_tour_runs_and_shows_its_pictures(chromium, server):
    lab = Lab(chromium, server, "00-tour")
    cells = lab.run_all()
    assert lab.page.locator(".jp-Dialog, .jp-toast-button").count() == 0  # JupyterLab asks nothing at first
    lab.go_to_cell(3)
    lab.screenshot("00-tour")
    assert [cell["error"] + cell["complaint"] for cell in cells if cell["error"] or cell["complaint"]] == []
    assert sum(cell["pictures"] + cell["widgets"] for cell in cells) >= 5
    assert [cell["complaint"] for cell in lab.cells() if cell["complaint"]] == []
    assert lab.complaints == []


def test_a_part_of_ones_own_goes_all_the_way(chromium, server, tmp_path):
    lab = Lab(chromium, server, "10-your-own-part")
    cells = lab.run_all()
    assert [cell["error"] + cell["complaint"] for cell in cells if cell["error"] or cell["complaint"]] == []
    bench = lab.page.locator(".jp-Cell", has=lab.page.locator(".widget-upload")).first
    bench.scroll_into_view_if_needed()
    pictures = bench.locator("img")
    pictures.first.wait_for(timeout=60_000)

    before = lab.looks(pictures)
    handle = bench.locator(".noUi-handle").last
    handle.focus()
    handle.press("ArrowRight")
    lab.wait_for(lambda: lab.looks(pictures) != before)

    before = lab.looks(pictures)
    file = tmp_path / "mine.csv"
    np.savetxt(file, [(0, 0), (10, 8), (20, -3), (30, 5), (40, 0)], delimiter=",")
    with lab.page.expect_file_chooser() as chooser:
        bench.locator(".widget-upload").click()
    chooser.value.set_files(file)
    lab.wait_for(lambda: lab.looks(pictures) != before)

    program = lab.folder / "notebooks" / "exports" / "path.ngc"
    program.unlink(missing_ok=True)
    bench.get_by_role("button", name="export").click()
    lab.wait_for(program.is_file)
    lab.screenshot("10-your-own-part")
    assert lab.complaints == []

"""The notebooks in a real JupyterLab, as a person meets them."""

import nbformat
import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.tests.browser.lab import Lab
from nurbs_lab.workbench import work

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
    handle = bench.locator(".widget-inline-hbox", has_text="speed [").locator(".noUi-handle")
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


def notebook(server, name, *cells):
    """Save a notebook of these cells where JupyterLab finds it."""
    cells = [nbformat.v4.new_code_cell(cell) for cell in cells]
    spec = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    book = nbformat.v4.new_notebook(cells=cells, metadata=spec)
    nbformat.write(book, server[1] / "notebooks" / f"{name}.ipynb")
    return name


EXPLORER = """
import nurbs_lab as nl
def draw(height, kind):
    while height > 6:
        nl.trace(nl.paper.CURVE, 4.0, stepper="exact", period_s=1e-5)
    return nl.plotting.lines([0, 1], [0, height], x_label="x", y_label=kind)
nl.plotting.explore(draw, height=(1, 9), kind=["history, over time", "history, over the arc, cut at knots"])
"""
#: What the slider says that has the focus, if one has it.
FOCUSED = "document.activeElement.closest('.widget-slider, .jupyter-widget-slider')?.textContent"


def test_sliders_are_moved_by_keys_alone_and_outlive_an_interrupt(chromium, server):
    lab = Lab(chromium, server, notebook(server, "explorer", EXPLORER))
    lab.start_cell(0)
    picture = lab.page.locator(".jp-OutputArea-output img")
    picture.first.wait_for(timeout=120_000)
    said = []
    for name in ("height", "kind"):
        for _ in range(60):
            lab.page.keyboard.press("Tab")
            if (lab.page.evaluate(FOCUSED) or "").startswith(name):
                break
        before = lab.looks(picture)
        lab.page.keyboard.press("ArrowRight")
        lab.wait_for(lambda before=before: lab.looks(picture) != before)
        said.append(lab.page.evaluate(FOCUSED))
    handle, before = lab.page.locator(".noUi-handle").first, lab.looks(picture)
    handle.press("ArrowRight")
    lab.interrupt_until(lab.page.get_by_text("stopped").count)
    assert lab.looks(picture) == before
    handle.press("ArrowLeft")
    handle.press("ArrowLeft")
    lab.wait_for(lambda: lab.looks(picture) != before, 20)
    lab.screenshot("explorer")
    assert lab.page.get_by_text("stopped").count() == 0
    assert said == ["height6", "kindhistory, over the arc, cut at knots"]
    assert lab.complaints == []


SLOW = "while True:\n    nl.trace(nl.paper.CURVE, 1e-2, stepper='exact', period_s=1e-3)"
BENCH = "import nurbs_lab as nl\nfrom nurbs_lab.workbench import Workbench\nbench = Workbench()\nbench"


def test_a_curve_is_dragged_where_a_kernel_runs(chromium, server):
    drag = "import nurbs_lab as nl\nnl.plotting.drag(nl.paper.CURVE)"
    lab = Lab(chromium, server, notebook(server, "drag", drag))
    lab.start_cell(0)
    handle = lab.page.get_by_role("slider", name="control point 3")
    handle.wait_for(timeout=120_000)
    handle.press("ArrowUp")
    lab.screenshot("drag")
    made = eval(lab.page.locator(".jp-OutputArea-output figure code").text_content(), {"nl": nl})
    moved = made.control_points - nl.paper.CURVE.control_points
    assert moved[3, 1] > 0
    assert np.count_nonzero(moved) == 1
    assert lab.complaints == []


def test_the_last_of_twenty_quick_moves_wins_and_an_interrupt_stops_a_long_call(chromium, server):
    lab = Lab(chromium, server, notebook(server, "bench", BENCH, SLOW, "print(1 + 1)"))
    lab.start_cell(0)
    bench = lab.page.locator(".jp-Cell", has=lab.page.locator(".widget-upload")).first
    bench.locator("img").first.wait_for(timeout=120_000)
    speed = bench.locator(".widget-inline-hbox", has_text="speed [").locator(".noUi-handle")
    speed.focus()
    for _ in range(20):
        speed.press("ArrowRight", no_wait_after=True)
    wanted = work(nl.paper.CURVE, speed=40.0, acceleration=1000.0).summary().splitlines()
    status = bench.locator(".widget-html", has_text="path of").first
    lab.wait_for(lambda: status.inner_text().splitlines() == wanted)

    lab.start_cell(1)
    lab.page.wait_for_timeout(2000)
    assert lab.cells()[1]["count"] is None  # it runs
    lab.interrupt_until(lambda: lab.cells()[1]["count"])
    assert lab.cells()[1]["name"] == "KeyboardInterrupt"
    lab.start_cell(2)
    lab.wait_for(lambda: lab.cells()[2]["count"], 20)
    bench.get_by_role("button", name="ant").click()  # a reconstruction, which takes seconds
    bench.get_by_text("working").wait_for()
    lab.interrupt_until(bench.get_by_text("stopped").count)
    lab.screenshot("workbench")
    assert lab.complaints == []

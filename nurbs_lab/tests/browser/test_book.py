"""The book of all notebooks, built and read in a real browser."""

import io
import runpy
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import unquote, urldefrag

import numpy as np
import pytest
from PIL import Image

import nurbs_lab as nl
from nurbs_lab.plotting.orbit import MIME
from nurbs_lab.tests.browser.conftest import ROOT
from nurbs_lab.tests.browser.lab import EXPORTS

pytestmark = pytest.mark.browser
STEMS = [file.stem for file in sorted((ROOT / "notebooks").glob("*.ipynb"))]


def notebook(stem):
    return (ROOT / "notebooks" / f"{stem}.ipynb").read_text()


@pytest.fixture(scope="module")
def book(tmp_path_factory):
    """The folder of the built site."""
    folder = tmp_path_factory.mktemp("book")
    build = runpy.run_path(str(ROOT / "notebooks" / "book" / "build.py"))
    assert build["build"](folder) == 0
    return folder


@pytest.fixture(scope="module")
def host(book):
    """The address of a plain web server over the site."""

    class Quiet(SimpleHTTPRequestHandler):
        def log_message(self, *_):
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=book))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()


@pytest.fixture
def page(chromium, host):
    """A page that remembers what the browser complained about."""
    page = chromium.new_page(viewport={"width": 1280, "height": 900})
    page.complaints = []
    page.on("console", lambda message: message.type == "error" and page.complaints.append(message.text))
    page.on("pageerror", lambda error: page.complaints.append(str(error)))
    page.on("requestfailed", lambda request: _note_failure(page, request))
    page.on("request", lambda asked: asked.url.startswith(host) or page.complaints.append(asked.url))
    yield page
    page.close()


def test_the_book_is_small(book):
    assert sum(file.stat().st_size for file in book.rglob("*") if file.is_file()) < 25e6


#: The number of texts on a page, and those whose contrast with what is under them is below 4.5 (WCAG 2).
FAINT_TEXTS = """() => {
    const numbers = (text) => text.match(/[\\d.]+/g).map(Number);
    const linear = (v) => v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
    const light = (colour) => {
        const [r, g, b] = colour.map((v) => linear(v / 255));
        return 0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05;
    };
    const under = (element) => {
        for (let e = element; e; e = e.parentElement) {
            const [r, g, b, opacity = 1] = numbers(getComputedStyle(e).backgroundColor);
            if (opacity > 0.99) return [r, g, b];
        }
        return [255, 255, 255];
    };
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    const faint = [];
    let texts = 0;
    while (walker.nextNode()) {
        const words = walker.currentNode.data.trim(), element = walker.currentNode.parentElement;
        if (!words || !element.checkVisibility({ visibilityProperty: true })) continue;
        texts += 1;
        const colour = numbers(getComputedStyle(element).color).slice(0, 3);
        const [low, high] = [light(colour), light(under(element))].sort((p, q) => p - q);
        if (high / low < 4.5) faint.push([element.tagName, words, high / low]);
    }
    return [texts, faint];
}"""


@pytest.mark.parametrize("stem", ["index", *STEMS])
def test_every_page_is_whole_and_can_be_read_and_its_scenes_open(book, host, page, stem):
    page.goto(f"{host}/{stem}.html")
    page.wait_for_load_state("networkidle")
    page.evaluate("document.querySelectorAll('img').forEach((img) => { img.loading = 'eager' })")
    missing = "[...document.images].filter((img) => !(img.complete && img.naturalWidth))"
    page.wait_for_function(f"{missing}.length === 0")
    assert not page.evaluate("[...document.images].filter((img) => !img.alt && !img.closest('a')).length")
    assert page.locator("mjx-merror").count() == 0
    for target in page.evaluate("[...document.links].map((link) => link.href)"):
        if target.startswith(host):
            file = book / unquote(urldefrag(target)[0].removeprefix(f"{host}/").partition("?")[0])
            assert file.is_file() or (file / "index.html").is_file(), target
    for scheme in ("dark", "light"):
        page.emulate_media(color_scheme=scheme)
        page.wait_for_function("theme => document.documentElement.dataset.theme === theme", arg=scheme)
        page.wait_for_function("document.getAnimations().length === 0")  # the theme fades in
        texts, faint = page.evaluate(FAINT_TEXTS)
        assert texts > 20
        assert faint == [], scheme
        if stem == "02-slicing":
            page.locator("figure.stored").first.scroll_into_view_if_needed()
            EXPORTS.mkdir(exist_ok=True)
            page.screenshot(path=EXPORTS / f"book-{scheme}.png")
    page.set_viewport_size({"width": 390, "height": 800})  # of a phone
    assert page.evaluate("document.documentElement.scrollWidth") <= 391
    page.set_viewport_size({"width": 1280, "height": 900})
    scenes = page.locator("figure.orbit").all()
    assert len(scenes) == (0 if stem == "index" else notebook(stem).count(f'"{MIME}"'))
    for figure in scenes:
        figure.get_by_role("button", name="Turn in 3-D").click()
        canvas = figure.locator("canvas")
        canvas.wait_for()
        page.wait_for_timeout(300)
        picture = Image.open(io.BytesIO(canvas.screenshot())).convert("RGB")
        assert len(picture.getcolors(1 << 24)) > 20  # it is not blank
    assert page.complaints == []


def step_in(figure):
    """Put the focus on the first thing in a figure that the Tab key reaches."""
    figure.scroll_into_view_if_needed()
    figure.evaluate("figure => { figure.tabIndex = -1; figure.focus() }")
    figure.press("Tab")


def test_scenes_turn_under_mouse_and_keys(host, page):
    stem = next(stem for stem in STEMS if MIME in notebook(stem))
    page.goto(f"{host}/{stem}.html")
    figure = page.locator("figure.orbit").first
    step_in(figure)
    assert page.evaluate("document.activeElement.textContent") == "Turn in 3-D"
    page.keyboard.press("Enter")
    canvas = figure.locator("canvas")
    canvas.wait_for()
    page.wait_for_timeout(500)
    pictures = [canvas.screenshot()]
    box = canvas.bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] / 2 + 90, box["y"] + box["height"] / 2 + 30, steps=4)
    page.mouse.up()
    page.wait_for_timeout(200)
    pictures.append(canvas.screenshot())
    canvas.press("ArrowLeft")
    page.wait_for_timeout(200)
    pictures.append(canvas.screenshot())
    assert len(set(pictures)) == 3
    assert "Arrow keys" in canvas.get_attribute("aria-label")
    assert page.complaints == []


def test_a_curve_is_dragged_and_is_the_one_that_its_line_of_code_makes(host, page):
    page.goto(f"{host}/03-curves.html")
    figure = page.locator("figure:has(path[data-curve])")
    figure.scroll_into_view_if_needed()
    for handle, across, up in ((4, 40, -70), (9, -400, 0)):  # a control point, and a knot onto its neighbour
        box = figure.get_by_role("slider").nth(handle).bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x + across, y + up, steps=4)
        page.mouse.up()
    figure.locator("input").fill("0.5")
    made = eval(figure.locator("code").text_content(), {"nl": nl})
    given = nl.paper.CURVE
    assert (made.control_points != given.control_points).any(axis=1).sum() == 1
    assert made.weights.max() == 3.16
    assert len(np.unique(made.knots)) < len(np.unique(given.knots))
    drawn = figure.locator("path[data-curve]").get_attribute("d")[1:].split("L")
    drawn = np.array([point.split() for point in drawn], dtype=float)
    ours = made(np.linspace(*made.domain, len(drawn)))
    system = np.column_stack([ours, np.ones(len(ours))])
    fitted, *_ = np.linalg.lstsq(system, drawn)  # the map from millimetres to pixels
    assert abs(system @ fitted - drawn).max() < 0.5
    assert page.complaints == []


def test_keys_stop_a_moving_picture_at_a_frame_and_start_it_again(host, page):
    page.goto(f"{host}/00-tour.html")
    figure = page.locator("figure.moving", has_text="tolerance [mm]")
    picture, slider = figure.locator("img"), figure.get_by_role("slider", name="tolerance [mm]")
    moving = picture.get_attribute("src")
    assert slider.input_value() == "1"
    step_in(figure)
    for number in (2, 3):
        page.keyboard.press("ArrowRight")
        assert picture.get_attribute("src").endswith(f"-frame-{number}.png")
        page.wait_for_function("image => image.complete && image.naturalWidth", arg=picture.element_handle())
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    assert picture.get_attribute("src").endswith(moving)
    assert page.complaints == []


def test_nothing_moves_for_readers_who_want_no_motion(host, page):
    page.emulate_media(reduced_motion="reduce")
    page.goto(f"{host}/00-tour.html")
    assert "-frame-" in page.locator("figure.moving img").first.get_attribute("src")


def test_the_book_can_be_searched(host, page):
    page.goto(f"{host}/search.html?q=trapezoid")
    page.get_by_text("search finished", exact=False).or_(page.locator("ul.search li")).first.wait_for()
    assert page.locator("ul.search li").count()
    assert page.complaints == []


def _note_failure(page, request):
    """A page that is left aborts what it still loads; every other failure counts."""
    if request.failure != "net::ERR_ABORTED":
        page.complaints.append(request.url)

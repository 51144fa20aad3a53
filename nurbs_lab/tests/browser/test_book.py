"""The book of all notebooks, built and read in a real browser."""

import io
import runpy
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import unquote, urldefrag

import pytest
from PIL import Image

from nurbs_lab.plotting.orbit import MIME
from nurbs_lab.tests.browser.conftest import ROOT

pytestmark = pytest.mark.browser
STEMS = [file.stem for file in sorted((ROOT / "notebooks").glob("*.ipynb"))]


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
    page.on("requestfailed", lambda request: page.complaints.append(request.url))
    page.on("request", lambda asked: asked.url.startswith(host) or page.complaints.append(asked.url))
    yield page
    page.close()


def test_the_book_is_small(book):
    assert sum(file.stat().st_size for file in book.rglob("*") if file.is_file()) < 25e6


@pytest.mark.parametrize("stem", ["index", *STEMS])
def test_every_page_is_whole(book, host, page, stem):
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
    assert page.complaints == []


def test_no_page_is_wider_than_a_phone(host, page):
    page.set_viewport_size({"width": 390, "height": 800})
    for stem in ["index", *STEMS]:
        page.goto(f"{host}/{stem}.html")
        assert page.evaluate("document.documentElement.scrollWidth") <= 391, stem


def test_scenes_turn_under_mouse_and_keys(host, page):
    stem = next(stem for stem in STEMS if MIME in (ROOT / "notebooks" / f"{stem}.ipynb").read_text())
    page.goto(f"{host}/{stem}.html")
    figure = page.locator("figure.orbit").first
    figure.scroll_into_view_if_needed()
    figure.get_by_role("button", name="Turn in 3-D").click()
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


def test_every_scene_opens_and_is_not_blank(host, page):
    opened = 0
    for stem in STEMS:
        page.goto(f"{host}/{stem}.html")
        for figure in page.locator("figure.orbit").all():
            figure.get_by_role("button", name="Turn in 3-D").click()
            canvas = figure.locator("canvas")
            canvas.wait_for()
            page.wait_for_timeout(300)
            picture = Image.open(io.BytesIO(canvas.screenshot())).convert("RGB")
            assert len(picture.getcolors(1 << 24)) > 20, stem
            opened += 1
    assert opened >= 10
    assert page.complaints == []


def test_the_book_can_be_searched(host, page):
    page.goto(f"{host}/search.html?q=trapezoid")
    page.get_by_text("search finished", exact=False).or_(page.locator("ul.search li")).first.wait_for()
    assert page.locator("ul.search li").count()
    assert page.complaints == []

"""The page in a real browser: what it shows at a moment, and what keys and the policy do."""

import base64
import hashlib
import re
import subprocess
from html import unescape

import pytest

from symolo.core.progress import LineReport
from symolo.reader.dataset import load
from symolo.view.page import ViewLimits, view_page
from tests.conftest import browser

pytestmark = pytest.mark.browser

OPTIONS = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync")
OPTIONS += ("--disable-background-networking", "--disable-component-update", "--virtual-time-budget=1500")


@pytest.fixture(scope="module")
def page(painted):
    limits = ViewLimits(max_runs=12, max_images=1500, max_width_px=320)
    return view_page(load(painted()), limits, LineReport()).html.decode()


@pytest.fixture
def opened(page, tmp_path):
    """Opens the page at a place, after some steps of JavaScript, and returns the document that results."""

    def opened(place="", steps="", html=page):
        file = tmp_path / "view.html"
        file.write_text(with_steps(html, steps) if steps else html)
        command = [browser(), *OPTIONS, f"--user-data-dir={tmp_path / 'profile'}", "--dump-dom", file.as_uri() + place]
        ended = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120)
        return re.sub(r"<script.*?</script>", "", ended.stdout, flags=re.DOTALL)

    return opened


def with_steps(html, steps):
    """The page with steps at the end of its script, which its policy then allows."""
    script = re.search(r"<script>(.*?)</script>", html, re.DOTALL).group(1)
    longer = script.replace("//]]>", f"{steps}\n//]]>")
    before, after = (base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in (script, longer))
    assert html.count(before) == 1
    return html.replace(before, after).replace(script, longer)


def press(*keys):
    return "".join(f"document.dispatchEvent(new KeyboardEvent('keydown', {{key: '{key}'}}));" for key in keys)


def shown(document):
    """Clock, caption of the image, place of the robot and state, as a reader sees them."""

    def text(pattern):
        return unescape(re.sub(r"<[^>]*>", "", re.search(pattern, document, re.DOTALL).group(1)))

    return {
        "clock": text(r'<output id="clock">(.*?)</output>'),
        "image": text(r'<div id="cameras">.*?<figcaption>(.*?)</figcaption>'),
        "place": text(r'<figcaption id="now">(.*?)</figcaption>'),
        "state": text(r"<strong>state</strong>(.*?)</p>"),
    }


def test_it_begins_with_the_first_row_of_the_first_run(opened):
    assert shown(opened()) == {
        "clock": "0.00 / 2.0 s",
        "image": "camera: image 1, 0.00 s",
        "place": "x 0.550 m, y -0.200 m, heading -90 deg",
        "state": "0 line",
    }


def test_a_link_shows_its_moment(opened):
    # Row 22 of the drive of the fixture: 1.1 s, in state 5, after image 6 of 1.0 s.
    document = opened("#run=CW/test_2&t=1.1")
    assert shown(document) == {
        "clock": "1.10 / 2.0 s",
        "image": "camera: image 6, 1.00 s",
        "place": "x 0.580 m, y -0.420 m, heading -90 deg",
        "state": "5 avoid by the left",
    }
    assert re.search(r'<img [^>]*src="data:image/jpeg;base64,[^"]+"', document)
    assert '<strong>forward speed v [m/s]</strong><span class="value">0.2</span>' in document


def test_keys_go_from_image_to_image_and_from_run_to_run(opened):
    steps = "const log = [], note = (id) => document.getElementById(id).textContent;"
    for key in ("ArrowRight", "ArrowRight", "ArrowLeft", "End", "ArrowRight", "Home", "ArrowLeft", "n", "p", "p"):
        steps += press(key) + "log.push(`${runs.selectedIndex} ${note('clock')}`);"
    title = re.search(r"<title>(.*?)</title>", opened(steps=steps + "document.title = log.join(', ');")).group(1)
    times = ["0 0.20", "0 0.40", "0 0.20", "0 2.00", "0 2.00", "0 0.00", "0 0.00", "1 0.00", "0 0.00", "2 0.00"]
    assert title == ", ".join(f"{time} / 2.0 s" for time in times)


def test_the_bar_of_the_scale_covers_no_wall_and_no_obstacle(opened):
    """The bar, its number and their background are in the lowest 32 px, where nothing else is drawn."""
    steps = (
        "const strip = (from) => { const ratio = canvas.width / canvas.clientWidth;"
        " const y = Math.round((canvas.clientHeight - 32) * ratio), x = Math.round(from * ratio);"
        " const data = canvas.getContext('2d').getImageData(x, y, canvas.width - x, canvas.height - y).data;"
        " return data.filter((value, index) => index % 4 === 3 && value > 0).length; };"
        "const canvas = document.getElementById('map'); document.title = `${strip(0) > 0} ${strip(260)}`;"
    )
    assert re.search(r"<title>(.*?)</title>", opened(steps=steps)).group(1) == "true 0"


def test_it_plays_to_the_end_and_stops(opened):
    """A busy browser may draw no image within the virtual time, so a timer, which counts that time, takes its place."""
    timer = "window.requestAnimationFrame = (step) => setTimeout(() => step(performance.now()), 16);"
    document = opened("#t=1.9", steps=f"{timer} speed.value = '8';" + press(" "))
    assert shown(document)["clock"] == "2.00 / 2.0 s"
    assert re.search(r'<button id="play"[^>]*aria-pressed="false">Play</button>', document)


def test_a_script_that_is_not_the_page_s_own_does_not_run(opened, page):
    mark = "<script>document.title = 'taken over'</script></body>"
    document = opened(html=page.replace("</body>", mark))
    assert "taken over" not in re.search(r"<title>.*?</title>", document).group()
    assert shown(document)["clock"] == "0.00 / 2.0 s"
    changed = opened(html=page.replace("//]]>", "document.title = 'taken over'\n//]]>"))
    assert '<output id="clock"></output>' in changed, "a changed script has another hash"

"""The page in a real browser, at the width of a phone and of a desktop."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--hide-scrollbars",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--enable-logging=stderr",
    "--virtual-time-budget=20000",
    "--window-size=1800,900",
]

# Figures that are far from the screen are drawn for printing only.
PROBE = """
<script>
addEventListener("load", () => {
  dispatchEvent(new Event("beforeprint"));
  setTimeout(() => {
    const plots = [...document.querySelectorAll(".plot")];
    const drawn = plots.filter((plot) => {
      const picture = plot.querySelector(".main-svg");
      return picture && picture.getBoundingClientRect().width <= plot.clientWidth + 1;
    });
    console.log(`PROBE width=${innerWidth} content=${document.documentElement.scrollWidth} ` +
      `plots=${plots.length} drawn=${drawn.length}`);
  }, 3000);
});
</script>
</body>"""
FRAMES = """<!doctype html><body style="margin:0">
<iframe src="probed.html" style="border:0;width:390px;height:844px"></iframe>
<iframe src="probed.html" style="border:0;width:1280px;height:844px"></iframe></body>"""


@pytest.fixture(scope="module")
def console(page: Path, tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """Return what the page said on the console in frames of both widths."""
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None:
        pytest.skip(f"no browser here: looked for {', '.join(BROWSERS)}")
    folder = tmp_path_factory.mktemp("browser")
    html = page.read_text(encoding="utf-8")
    (folder / "probed.html").write_text(html.replace("</body>", PROBE), encoding="utf-8")
    # A window cannot be as narrow as a phone, a frame can.
    (folder / "frames.html").write_text(FRAMES, encoding="utf-8")
    picture = folder / "screen.png"
    finished = subprocess.run(
        [
            browser,
            *FLAGS,
            f"--user-data-dir={folder / 'profile'}",
            f"--screenshot={picture}",
            (folder / "frames.html").as_uri(),
        ],
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    )
    assert picture.stat().st_size > 0
    return re.findall(r'CONSOLE[^"]*"(.*)", source', finished.stderr)


def probes(console: list[str]) -> list[dict[str, int]]:
    return [
        {name: int(value) for name, value in re.findall(r"(\w+)=(\d+)", line)}
        for line in console
        if line.startswith("PROBE")
    ]


def test_no_script_complains(console):
    assert [line for line in console if not line.startswith("PROBE")] == []


def test_the_page_is_no_wider_than_the_window(console):
    found = {probe["width"]: probe["content"] for probe in probes(console)}
    assert found == {390: 390, 1280: 1280}


def test_every_figure_is_drawn_and_fits(console):
    for probe in probes(console):
        assert probe["drawn"] == probe["plots"] > 0

"""What the first hours share: a terminal to type into, and a browser to look with."""

import base64
import contextlib
import io
import os
import shutil
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

from dualpin.cli import main

SHOTS = os.environ.get("DUALPIN_SCREENSHOTS")  # a folder to leave screenshots in
FLAGS = ("headless=new", "no-sandbox", "disable-gpu", "no-first-run", "disable-background-networking",
         "disable-component-update", "disable-sync", "disable-dev-shm-usage", "hide-scrollbars")  # fmt: skip
LOOKS = [(width, scheme) for width in (1280, 390) for scheme in ("light", "dark")]
OUTSIDE = """
const inside = e => e.closest('.scroll, .hush, .skip, pre, svg, table, .md-header, .md-sidebar');
return [...document.querySelectorAll('main *')]
  .filter(e => !inside(e) && e.offsetParent && e.getBoundingClientRect().right > innerWidth + 1)
  .map(e => e.tagName + '.' + e.className)"""


class Terminal:
    """A folder in which a user types commands; everything that was said is kept."""

    def __init__(self, folder):
        self.folder, self.said = Path(folder), ""

    def type(self, line, code=0):
        """Type a line, expect an exit code; returns what was printed, results and remarks.

        The first line of an hour is a process of its own, those after it run in this one, which saves the starts.
        """
        exit_code, text = (self._here if self.said else self._apart)(line.split()[1:])
        self.said += f"$ {line}\n{text}"
        assert "Traceback" not in text, text
        assert exit_code == code, text
        return text

    def _apart(self, words):
        command = [sys.executable, "-m", "dualpin", *words]
        done = subprocess.run(command, capture_output=True, text=True, cwd=self.folder, timeout=240, check=False)
        return done.returncode, done.stdout + done.stderr

    def _here(self, words):
        before, out, err = Path.cwd(), io.StringIO(), io.StringIO()
        with (pytest.MonkeyPatch.context() as patch, warnings.catch_warnings(),
              contextlib.redirect_stdout(out), contextlib.redirect_stderr(err)):  # fmt: skip
            patch.setattr(sys, "argv", ["dualpin", *words])
            os.chdir(self.folder)
            try:
                main()
                exit_code = 0
            except SystemExit as e:
                exit_code = e.code or 0
            finally:
                os.chdir(before)
        return exit_code, out.getvalue() + err.getvalue()


def opened(browser, path, width, scheme):
    """A page as it is on a screen of this width; it overflows nowhere, and its console is silent."""
    device = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 500}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", device)
    feature = {"name": "prefers-color-scheme", "value": scheme}
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [feature]})
    forget = {"source": "localStorage.clear()"}  # a scheme that was chosen before
    script = browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", forget)
    browser.get_log("browser")
    browser.get(Path(path).as_uri())
    browser.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", script)
    assert [e["message"] for e in browser.get_log("browser") if e["level"] in ("SEVERE", "WARNING")] == []
    assert browser.execute_script("return document.documentElement.scrollWidth <= innerWidth")
    assert browser.execute_script(OUTSIDE) == []
    colour = browser.execute_script("return getComputedStyle(document.body).backgroundColor")
    light = sum(int(float(x)) for x in colour.strip("rgba()").split(",")[:3]) / 3
    assert (light > 128) == (scheme == "light"), colour
    if SHOTS:
        Path(SHOTS).mkdir(parents=True, exist_ok=True)
        shot = browser.execute_cdp_cmd("Page.captureScreenshot", {"format": "png"})
        name = f"{Path(path).parent.name}-{Path(path).stem}-{width}-{scheme}.png"
        Path(SHOTS, name).write_bytes(base64.b64decode(shot["data"]))
    return browser


def chromium(profile):
    """A headless Chromium, or the test is skipped."""
    webdriver = pytest.importorskip("selenium.webdriver")
    program = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    driver = shutil.which("chromedriver")
    if not program or not driver:
        pytest.skip("no Chromium with its driver here (Debian: chromium chromium-driver)")
    options = webdriver.ChromeOptions()
    options.binary_location = program
    for flag in (*FLAGS, f"user-data-dir={profile}"):
        options.add_argument(f"--{flag}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))

"""Figures of docs/identification.md and docs/workspace.md, from the robots themselves.

python docs/figures/analysis.py     writes exciting-motion.svg, residuals.png, workspace.png and data-sheet.png
                                    (the last where Chromium and its driver are installed) beside this file
"""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

import matplotlib as mpl
import numpy as np

import dualpin as dp
from dualpin.report import robot_page

mpl.rcParams.update({"svg.hashsalt": "dualpin", "svg.fonttype": "none"})
HERE = Path(__file__).parent


def identification() -> None:
    """An exciting motion, and what identified parameters leave of measured torques."""
    arm = dp.load("ur5")
    motion = dp.excite(arm, {"velocity": 2.0, "acceleration": 6.0})
    motion.plot(HERE / "exciting-motion.svg")
    _, q, v, a = motion.sample(rate=50.0)
    noise = np.array([0.8, 1.0, 0.6, 0.2, 0.15, 0.1])
    tau = dp.rnea(arm, q, v, a) + 3.0 * v + 2.0 * np.sign(v) + noise * np.random.default_rng(0).standard_normal(v.shape)
    dp.identify(arm, q, v, a, tau, friction=True).plot().savefig(HERE / "residuals.png", dpi=70)


def workspace() -> None:
    """Where a ur5 reaches, how well it moves there, and what it holds."""
    arm = dp.load("ur5")
    reach = dp.reach_map(arm, "tool0")
    isotropy = reach.survey(lambda q: 1 / dp.manipulability(arm, q, "tool0").condition, "max", 200_000)
    capacity = reach.survey(lambda q: dp.payload_capacity(arm, q, "tool0"), "min", 200_000)
    reach.plot(HERE / "workspace.png", **{"isotropy, best": isotropy, "capacity [kg], least": capacity})


def data_sheet() -> None:
    """The beginning of a data sheet, as a browser shows it."""
    driver = shutil.which("chromedriver")
    if driver is None:
        return
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    for flag in ("--headless=new", "--no-sandbox", "--hide-scrollbars", "--window-size=1100,1250"):
        options.add_argument(flag)
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder, "page.html")
        page.write_text(robot_page(dp.load("ur5"), "tool0"), encoding="utf-8")
        browser = webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))
        try:
            browser.get(page.as_uri())
            browser.save_screenshot(str(HERE / "data-sheet.png"))
        finally:
            browser.quit()


if __name__ == "__main__":
    identification()
    workspace()
    data_sheet()

"""The site: built strictly, every public name and command in its reference, usable from the disk."""

import importlib.util
import inspect
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest

import dualpin as dp
from tests.first_hour.hour import LOOKS, chromium, opened

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
_spec = importlib.util.spec_from_file_location("docs_build", DOCS / "build.py")
build = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(build)
pytest.importorskip("zensical")


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The site, built once; a warning of the builder is an error."""
    folder = tmp_path_factory.mktemp("site")
    assert build.build(folder) == 0
    return folder


def public():
    """Every name that the package and its public rooms offer: (as it is written, value)."""
    found = {f"dualpin.{name}": getattr(dp, name) for name in dp.__all__ if name != "__version__"}
    for room in dp._PACKAGES:
        for name in getattr(getattr(dp, room), "__all__", ()):
            found[f"dualpin.{room}.{name}"] = getattr(getattr(dp, room), name)
    return found


def test_the_reference_has_every_public_name(site):
    """Functions and classes have an entry of their own (a module of the same name is none); constants are named."""
    pages = "".join(p.read_text(encoding="utf-8") for p in (site / "api").glob("*.html"))
    entries = set(re.findall(r'id="(dualpin[.\w]*)" class="doc doc-heading"', pages))
    missing = []
    for name, value in public().items():
        if inspect.ismodule(value):
            continue
        if hasattr(value, "__qualname__"):
            last = getattr(value, "__qualname__", name.rpartition(".")[2])
            parts = value.__module__.split(".")
            rooms = {".".join([*parts[:k], last]) for k in range(2, len(parts) + 1)}
            if not {name, *rooms} & entries:
                missing.append(name)
        elif not re.search(rf"<code>[\w., ]*\b{name.rpartition('.')[2]}(\(\))?</code>", pages):
            missing.append(name)
    assert missing == []


def test_the_reference_of_commands_has_every_command(site):
    from typer.main import get_command

    from dualpin.cli.main import program

    text = (site / "cli.html").read_text(encoding="utf-8")
    for name, command in get_command(program()).commands.items():
        assert f"<code>dualpin {name}</code>" in text
        for option in (o for p in command.params for o in p.opts if o.startswith("--")):
            assert option in text, (name, option)


def test_what_the_site_links_to_is_in_it(site):
    broken = []
    for page in site.rglob("*.html"):
        for target in re.findall(r'(?:href|src)="([^"#?]+)', page.read_text(encoding="utf-8")):
            if not re.match(r"[a-z]+:|/", target) and not (page.parent / target).exists():
                broken.append((page.name, target))
    assert broken == []


def said(folder, text):
    """What is said of a site of one page, which does not build with the settings of the site."""
    settings = (ROOT / "zensical.toml").read_text(encoding="utf-8")
    start, end = settings.index("nav = ["), settings.index("[project.theme]")
    settings = settings[:start] + settings[end:].replace('custom_dir = "docs/theme"\n', "")
    (folder / "zensical.toml").write_text(settings, encoding="utf-8")
    (folder / build.STAGE.relative_to(ROOT)).mkdir(parents=True, exist_ok=True)
    (folder / build.STAGE.relative_to(ROOT) / "index.md").write_text(f"# Page\n\n{text}\n", encoding="utf-8")
    command = [sys.executable, "-m", "zensical", "build", "--clean", "--strict"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    return re.sub(r"\x1b\[[\d;]*m", "", done.stdout + done.stderr)


def test_a_mistake_in_a_page_fails_the_build(tmp_path):
    """The builder is strict, so that the other tests of the site mean something."""
    links = said(tmp_path, "[here](#page) [x](nowhere.md) [y](#nowhere)")
    assert re.findall(r"Warning: (.*)", links) == ["page does not exist", "anchor does not exist"]
    assert "dualpin.nothing could not be found" in said(tmp_path, "::: dualpin.nothing")


def test_the_navigation_names_every_page():
    named = re.findall(r'"([\w/-]+\.md)"', (ROOT / "zensical.toml").read_text(encoding="utf-8"))
    pages = {p.relative_to(DOCS).as_posix() for p in DOCS.rglob("*.md")}
    assert pages <= set(named)


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    driver = chromium(tmp_path_factory.mktemp("profile"))
    yield driver
    driver.quit()


@pytest.mark.parametrize("page", ["index.html", "gallery.html", "cli.html", "api/functions.html", "reports.html"])
def test_pages_fit_a_screen_and_a_phone_by_day_and_by_night(page, site, browser):
    """Opened from the disk: nothing overflows, nothing is missing, the console is silent."""
    for width, scheme in LOOKS:
        opened(browser, site / page, width, scheme)


def test_search_and_dark_mode_work_from_the_disk(site, browser):
    webdriver = pytest.importorskip("selenium.webdriver")
    support = pytest.importorskip("selenium.webdriver.support.ui")
    opened(browser, site / "index.html", 1280, "light")
    browser.find_element("css selector", "[data-md-color-media='(prefers-color-scheme: light)'] ~ label").click()
    assert browser.execute_script("return document.body.dataset.mdColorScheme") == "slate"
    browser.find_element("css selector", ".md-search__button").click()
    time.sleep(1.0)  # the page adds the field later, by its script
    webdriver.ActionChains(browser).send_keys("cylindroid").perform()
    found = """
        const roots = [document, ...[...document.querySelectorAll('*')].map(e => e.shadowRoot).filter(r => r)];
        return roots.flatMap(r => [...r.querySelectorAll('a')]).some(a => /gallery.html.*cylindroid/.test(a.href))"""
    support.WebDriverWait(browser, 30).until(lambda b: b.execute_script(found))

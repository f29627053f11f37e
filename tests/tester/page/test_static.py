"""The page's files: limits of size and content, and computed contrasts of colours."""

from __future__ import annotations

import gzip
import json
import re
from hashlib import sha256
from itertools import combinations
from pathlib import Path

import pytest

import tester.page

STATIC = Path(tester.page.__file__).parent / "static"
SCRIPTS = sorted((STATIC / "js").glob("*.js"))
VENDOR = STATIC / "vendor"
MOST_BYTES, MOST_FIRST_LOAD, MOST_LINES, MOST_COLUMNS = 250_000, 120_000, 400, 120
FORBIDDEN = re.compile(
    r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\b|new Function|DOMParser|createContextualFragment|"
    r"srcdoc|document\.cookie|\.cssText|setAttribute\(\s*['\"]style"
)
"""Calls that turn a text into markup or code, or hide a secret in a cookie."""
ELSEWHERE = re.compile(r"(?:https?:|wss?:|['\"(])//(?!www\.w3\.org/2000/svg)[\w.]")


def text_of(path: Path) -> str:
    return path.read_text(encoding="utf-8")


# -- size and content ------------------------------------------------------------------------------------------------


def test_the_page_is_small_in_the_wheel_and_on_the_first_load() -> None:
    files = [path for path in STATIC.rglob("*") if path.is_file()]
    assert sum(path.stat().st_size for path in files) <= MOST_BYTES
    loaded = [path for path in files if path.suffix in (".html", ".js", ".css", ".svg")]
    assert sum(len(gzip.compress(path.read_bytes())) for path in loaded) <= MOST_FIRST_LOAD


def test_the_vendored_files_are_those_of_the_manifest() -> None:
    manifest = json.loads(text_of(VENDOR / "manifest.json"))
    found = {
        path.name: sha256(path.read_bytes()).hexdigest() for path in VENDOR.iterdir() if path.name != "manifest.json"
    }
    assert found == manifest["files"]
    assert f"v{manifest['version']}" in text_of(VENDOR / "uPlot.iife.min.js")[:80]
    assert text_of(VENDOR / "LICENSE").startswith("The MIT License")


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.name)
def test_a_script_makes_no_markup_of_texts_and_loads_nothing_from_elsewhere(path: Path) -> None:
    assert not FORBIDDEN.findall(text_of(path))
    assert not ELSEWHERE.findall(text_of(path))


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.name)
def test_a_script_is_short_and_its_exports_are_described(path: Path) -> None:
    lines = text_of(path).splitlines()
    assert len(lines) <= MOST_LINES and max(map(len, lines)) <= MOST_COLUMNS
    bare = [line for before, line in zip(["", *lines], lines, strict=False)
            if line.startswith("export ") and not before.rstrip().endswith("*/")]  # fmt: skip
    assert not bare


def test_every_import_of_a_script_is_one_of_the_page_and_every_script_is_used() -> None:
    wanted = {name for path in SCRIPTS for name in re.findall(r'from "\./([\w.]+)"', text_of(path))}
    assert wanted | {"main.js"} == {path.name for path in SCRIPTS}


def test_the_document_has_no_inline_script_or_style_and_loads_only_the_page_s_files() -> None:
    html = text_of(STATIC / "index.html")
    assert not re.findall(r"<style|\sstyle=|\son\w+=", html)
    assert all(re.search(r'\ssrc="/static/', tag) for tag in re.findall(r"<script[^>]*>", html))
    for place in re.findall(r'(?:src|href)="([^"]*)"', html):
        assert (STATIC / place.removeprefix("/static/")).is_file(), place


def test_the_style_loads_nothing() -> None:
    assert not re.findall(r"url\(|@import|@font-face", text_of(STATIC / "style.css"))


# -- colours ---------------------------------------------------------------------------------------------------------

Colour = tuple[float, float, float]
"""Linear red, green, blue, 0..1."""
DEFICIENCIES = {
    "protan": ((0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216), (-0.003882, -0.048116, 1.051998)),
    "deutan": ((0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413), (-0.011820, 0.042940, 0.968881)),
    "tritan": ((1.255528, -0.076749, -0.178779), (-0.078411, 0.930809, 0.147602), (0.004733, 0.691367, 0.303900)),
}
"""Machado, Oliveira, Fernandes 2009 (doi 10.1109/TVCG.2009.113), severity 1, on linear colours."""
TEXT, LINES, APART = 4.5, 3.0, 10.0
"""Least contrasts (WCAG 2.2, 1.4.3 and 1.4.11) and least distance of two series for the colour-blind (CIE 1976)."""


def linear(hexadecimal: str) -> Colour:
    parts = [int(hexadecimal[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    r, g, b = (p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts)
    return r, g, b


def luminance(colour: Colour) -> float:
    return 0.2126 * colour[0] + 0.7152 * colour[1] + 0.0722 * colour[2]


def contrast(one: str, other: str) -> float:
    low, high = sorted((luminance(linear(one)), luminance(linear(other))))
    return (high + 0.05) / (low + 0.05)


def lab(colour: Colour) -> Colour:
    r, g, b = colour
    white = (0.95047, 1.0, 1.08883)
    xyz = (
        0.4124564 * r + 0.3575761 * g + 0.1804375 * b,
        luminance(colour),
        0.0193339 * r + 0.1191920 * g + 0.9503041 * b,
    )
    x, y, z = (
        (v / w) ** (1 / 3) if v / w > 0.008856 else 7.787 * v / w + 16 / 116 for v, w in zip(xyz, white, strict=True)
    )
    return 116 * y - 16, 500 * (x - y), 200 * (y - z)


def seen(colour: Colour, kind: str) -> Colour:
    r, g, b = (min(max(sum(k * c for k, c in zip(row, colour, strict=True)), 0.0), 1.0) for row in DEFICIENCIES[kind])
    return r, g, b


def apart(one: Colour, other: Colour) -> float:
    return sum((a - b) ** 2 for a, b in zip(lab(one), lab(other), strict=True)) ** 0.5


def themes() -> dict[str, dict[str, str]]:
    """Return the style's colours, light and dark."""
    style = text_of(STATIC / "style.css")
    blocks = re.findall(r":root\s*\{([^}]*)\}", style)
    light, dark = (dict(re.findall(r"--([\w-]+):\s*(#[0-9a-f]{6});", block)) for block in blocks[:2])
    return {"light": light, "dark": {**light, **dark}}


def listed(name: str) -> list[str]:
    """Return a list of colours of colours.js."""
    found = re.search(rf"{name} = \[([^\]]*)\]", text_of(STATIC / "js" / "colours.js"))
    assert found is not None
    return re.findall(r"#[0-9a-f]{6}", found[1])


THEMES = pytest.mark.parametrize("theme", ["light", "dark"])


@THEMES
def test_texts_have_contrast_on_every_ground_on_which_they_are(theme: str) -> None:
    colours = themes()[theme]
    pairs = [("ink", ground) for ground in ("ground", "panel", "plot", "button", "wants-ground", "alarm-ground")]
    pairs += [("ink-2", ground) for ground in ("ground", "panel", "plot")] + [
        ("wants", "panel"),
        ("wants", "wants-ground"),
    ]
    pairs += [
        ("wants", "plot"),
        ("alarm", "panel"),
        ("alarm", "alarm-ground"),
        ("on-stop", "stop"),
        ("on-main", "main"),
    ]
    low = [
        (one, other, contrast(colours[one], colours[other]))
        for one, other in pairs
        if contrast(colours[one], colours[other]) < TEXT
    ]
    assert not low


@THEMES
def test_lines_and_borders_that_mean_something_have_contrast(theme: str) -> None:
    colours = themes()[theme]
    pairs = [(f"series-{n}", "plot") for n in range(6)] + [
        ("focus", "panel"),
        ("focus", "ground"),
        ("wants", "plot"),
        ("stop", "on-stop"),
    ]
    low = [
        (one, other, contrast(colours[one], colours[other]))
        for one, other in pairs
        if contrast(colours[one], colours[other]) < LINES
    ]
    assert not low


@THEMES
def test_the_series_are_those_of_the_scripts(theme: str) -> None:
    assert [themes()[theme][f"series-{n}"] for n in range(6)] == listed(f"SERIES_{theme.upper()}")


@THEMES
@pytest.mark.parametrize("kind", DEFICIENCIES)
def test_two_series_are_apart_for_a_colour_blind_person(theme: str, kind: str) -> None:
    shown = [seen(linear(colour), kind) for colour in listed(f"SERIES_{theme.upper()}")]
    assert min(apart(one, other) for one, other in combinations(shown, 2)) >= APART


def test_the_map_is_monotone_in_lightness_for_everybody() -> None:
    found = re.search(r"CIVIDIS = \[(.*?)\];", text_of(STATIC / "js" / "colours.js"), re.DOTALL)
    assert found is not None
    points = [tuple(map(int, triple)) for triple in re.findall(r"\[(\d+), (\d+), (\d+)\]", found[1])]
    colours = [linear("#{:02x}{:02x}{:02x}".format(*point)) for point in points]
    for kind in DEFICIENCIES:
        lightness = [lab(seen(colour, kind))[0] for colour in colours]
        assert lightness == sorted(lightness) and lightness[-1] - lightness[0] > 60.0, kind


def test_series_differ_by_dash_and_marker_as_well() -> None:
    script = text_of(STATIC / "js" / "colours.js")
    dashes = re.search(r"DASHES = (\[\[.*?\]\]);", script, re.DOTALL)
    markers = re.search(r"MARKERS = (\[.*?\]);", script, re.DOTALL)
    assert dashes is not None and markers is not None
    assert len({str(one) for one in json.loads(dashes[1])}) == len(set(json.loads(markers[1]))) == 6

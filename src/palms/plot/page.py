"""The page that every report is: one file, nothing loaded, light and dark, wide and narrow."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from string import Template
from typing import Final

__all__ = ["html_page"]

_PAGE: Final = Template("""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>$title</title>
<style>
:root { color-scheme: light dark;
  --ink: #1c1c1c; --paper: #ffffff; --line: #d0d0d0; --soft: #f3f3f3; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e9e9e9; --paper: #16181b; --line: #474b50; --soft: #22262b; }
}
body { margin: 0 auto; max-width: 70rem; padding: 1.5rem; background: var(--paper);
  color: var(--ink); font: 1rem/1.5 system-ui, sans-serif; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.2rem; margin-top: 2.2rem; }
h3 { font-size: 1.05rem; margin-top: 1.6rem; }
.verdict { font-size: 1.15rem; border-left: 0.3rem solid #0072b2; padding-left: 0.8rem; }
.verdict p { margin: 0.3rem 0; max-width: 50rem; }
table { border-collapse: collapse; margin: 0.5rem 0; }
caption { text-align: left; font-style: italic; padding: 0.2rem 0; }
th, td { border-bottom: 1px solid var(--line); padding: 0.3rem 0.9rem 0.3rem 0; text-align: left;
  font-variant-numeric: tabular-nums; vertical-align: top; }
.wide { overflow-x: auto; }
figure { margin: 1rem 0; }
img { max-width: 100%; height: auto; background: #ffffff; border-radius: 6px; padding: 6px;
  box-sizing: border-box; }
figcaption { font-size: 0.92rem; max-width: 50rem; }
pre { background: var(--soft); padding: 0.7rem; border-radius: 6px; white-space: pre-wrap;
  overflow-wrap: anywhere; }
summary { cursor: pointer; }
$style
</style>
</head>
<body>
<header>
<h1>$title</h1>
<div class="verdict">
$verdict
</div>
</header>
<main>
$main
</main>
</body>
</html>
""")


def html_page(title: str, verdict: Sequence[str], main: str, style: str = "") -> str:
    """Return a self-contained HTML page.

    Parameters
    ----------
    title : str
        Plain text.
    verdict : sequence of str
        Sentences of plain text that say first what matters.
    main : str
        HTML of the rest.
    style : str
        More CSS.

    Examples
    --------
    >>> page = html_page("A & B", ["It works."], "<p>Because.</p>")
    >>> "<h1>A &amp; B</h1>" in page, "http" in page
    (True, False)
    """
    sentences = "\n".join(f"<p>{escape(sentence)}</p>" for sentence in verdict)
    return _PAGE.substitute(title=escape(title), verdict=sentences, main=main, style=style)

# SPDX-License-Identifier: Apache-2.0
"""Looking at the layout of a page in the browser: what overlaps, what reaches over the edge."""

from __future__ import annotations

from reporting.browser import Browser

# Texts and controls that a reader sees, in page coordinates; of those in a figure, its own ticks and titles.
_BOXES = """
(() => {
  const seen = (element) => element.checkVisibility({ visibilityProperty: true, opacityProperty: true });
  const leaves = "h1, h2, h3, p, li, button, figcaption, dt, dd, .tile > *, .plot, summary > .explanation";
  const boxes = [];
  for (const element of document.querySelectorAll(leaves)) {
    if (!seen(element) || element.closest("pre")) continue;
    for (const box of element.getClientRects()) {
      if (box.width > 1 && box.height > 1) boxes.push([element, box]);
    }
  }
  const overlaps = [];
  for (let i = 0; i < boxes.length; i++) {
    for (let j = i + 1; j < boxes.length; j++) {
      const [one, a] = boxes[i], [other, b] = boxes[j];
      if (one === other || one.contains(other) || other.contains(one)) continue;
      const wide = Math.min(a.right, b.right) - Math.max(a.left, b.left);
      const high = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
      const name = (e) => e.tagName + (e.id ? "#" + e.id : "") + " " + e.textContent.slice(0, 40);
      if (wide > 1 && high > 1) overlaps.push(name(one) + " / " + name(other));
    }
  }
  return overlaps;
})()
"""

# Labels of one axis that lie over each other, and labels that a figure cuts off.
_FIGURE_TEXTS = """
(() => {
  const faults = [];
  for (const plot of document.querySelectorAll(".plot")) {
    if (!plot.querySelector(".main-svg") || !plot.checkVisibility()) continue;
    const frame = plot.getBoundingClientRect();
    const names = ".xtick text, .ytick text, .xtitle, .ytitle, .annotation text";
    const texts = Array.from(plot.querySelectorAll(names));
    const boxes = texts.map((text) => [text.textContent, text.getBoundingClientRect()]);
    for (const [text, box] of boxes) {
      if (box.left < frame.left - 1 || box.right > frame.right + 1 || box.bottom > frame.bottom + 1) {
        faults.push(plot.id + " cuts " + text);
      }
    }
    for (let i = 0; i < boxes.length; i++) {
      for (let j = i + 1; j < boxes.length; j++) {
        const a = boxes[i][1], b = boxes[j][1];
        const wide = Math.min(a.right, b.right) - Math.max(a.left, b.left);
        const high = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
        if (wide > 1 && high > 1) faults.push(plot.id + ": " + boxes[i][0] + " / " + boxes[j][0]);
      }
    }
  }
  return faults;
})()
"""


def overlaps(browser: Browser) -> list[str]:
    """Return pairs of texts, controls and figures that lie over each other, and labels that are cut off."""
    return [*browser.value(_BOXES), *browser.value(_FIGURE_TEXTS)]


def unfold(browser: Browser) -> None:
    """Open everything that is folded, and wait until its figures are drawn."""
    browser.value("document.querySelectorAll('details').forEach(d => d.open = true)")
    wait_for_figures(browser)


def wait_for_figures(browser: Browser) -> None:
    """Wait until every figure that is not folded away is drawn."""
    shown = "Array.from(document.querySelectorAll('.plot')).filter(p => !p.closest('details:not([open])'))"
    browser.wait_for(f"{shown}.every(p => p.dataset.drawn === 'yes')")

"""What can be seen of a page and taken hold of: rules of axe, and whether controls are whole."""

import needs

_JUDGE = "part => axe.run(part ?? document, {resultTypes: ['violations'], preload: false})"


def broken(page, part=None):
    """Returns the rules of axe that a page breaks, or a part of it, with what breaks them."""
    needs.ask("axe")
    if page.evaluate("typeof axe") == "undefined":
        page.evaluate(needs.AXE.read_text(encoding="utf-8"))
    found = page.evaluate(_JUDGE, part and part.element_handle())["violations"]
    return {
        violation["id"]: [node["html"][:120] for node in violation["nodes"]] for violation in found
    }


_CONTROLS = """
    const controls = () => [...document.querySelectorAll(
        "button, select, input, textarea, summary, a[href], [role=tab], [role=application]"
    )].filter(each => {
        const { width, height } = each.getBoundingClientRect();
        const isSeen = getComputedStyle(each).visibility !== "hidden" && width > 1 && height > 1;
        // Boxes, lines and the map of the diagram are as large as the diagram is near.
        const isPart = each.closest(".react-flow, .unseen, .splitter, .cm-editor, .operate-hidden");
        return isSeen && !isPart;
    });
    const nameOf = each => (
        each.getAttribute("aria-label") || each.textContent || each.placeholder || each.id
    ).trim().slice(0, 50);
"""

_MISPLACED = (
    "() => {"
    + _CONTROLS
    + """
    const faults = [];
    const isTouched = matchMedia("(pointer: coarse)").matches;
    const top = document.querySelector(".operate, dialog[open]");
    const pen = document.createElement("canvas").getContext("2d");
    for (const each of controls()) {
        if (top && !top.contains(each) && !each.matches(".stop-button")) continue;
        each.scrollIntoView({ block: "center", inline: "center", behavior: "instant" });
        const { left, top: up, right, bottom, width, height } = each.getBoundingClientRect();
        const isMark = each.matches("[type=checkbox], [type=radio]");
        const label = each.closest("label");
        const area = isMark && label ? label.getBoundingClientRect() : { width, height };
        // Marks are as large as those of the system where a pointer meets them.
        const isFree = each.matches("a, .link") || (isMark && !isTouched);
        if (Math.min(area.width, area.height) < 24 && !isFree) {
            faults.push(`${nameOf(each)} is small: ${Math.round(width)} x ${Math.round(height)}`);
        }
        const across = Math.min(5, width / 4), down = Math.min(5, height / 4);
        for (const x of [left + across, right - across]) {
            for (const y of [up + down, bottom - down]) {
                const at = document.elementFromPoint(x, y);
                // What a text of several lines leaves free at its corners belongs to it.
                if (!at || !(each.contains(at) || at.contains(each))) {
                    const by = at ? at.className : "the edge";
                    faults.push(`${nameOf(each)} is covered or cut by ${by}`);
                }
            }
        }
        const style = getComputedStyle(each);
        const shown = each.matches("select") ? each.selectedOptions[0]?.text : each.placeholder;
        if (each.closest("[role=toolbar]") && shown) {
            pen.font = style.font;
            const arrow = each.matches("select") ? 20 : 0;
            const room = each.clientWidth - parseFloat(style.paddingLeft)
                - parseFloat(style.paddingRight) - arrow;
            if (pen.measureText(shown).width > room + 0.5) faults.push(`${shown} is cut`);
        }
        if (each.matches("button") && each.scrollWidth > each.clientWidth + 1) {
            faults.push(`${nameOf(each)} is cut`);
        }
    }
    scrollTo(0, 0);
    if (document.documentElement.scrollWidth > innerWidth) faults.push("the page is too wide");
    return [...new Set(faults)];
}"""
)

_NOTE = """() => {
    window.reached ??= new Set();
    const isAgain = document.activeElement !== document.body
        && window.reached.has(document.activeElement);
    window.reached.add(document.activeElement);
    return isAgain;
}"""

_UNREACHED = (
    "() => {"
    + _CONTROLS
    + """
    const isLeft = each => !each.disabled && !window.reached.has(each)
        && !each.matches("[role=tab][aria-selected=false], [tabindex='-1']");
    const found = controls().filter(isLeft);
    // Of radio buttons of a name one is a stop.
    const isAlone = each => each.type !== "radio"
        || ![...window.reached].some(other => other.name === each.name);
    return found.filter(isAlone).map(nameOf);
}"""
)


def misplaced(page):
    """Returns which controls are cut, covered, or smaller than 24 pixels."""
    return page.evaluate(_MISPLACED)


def unreached(page, most=400):
    """Returns which controls the key Tab does not come to."""
    page.evaluate("() => { window.reached = undefined; document.activeElement.blur(); }")
    for _ in range(most):
        page.keyboard.press("Tab")
        if page.evaluate(_NOTE):
            break
    return page.evaluate(_UNREACHED)

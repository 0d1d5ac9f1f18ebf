"""The page as its users meet it: what they see has a role and a name."""

import re

from playwright.sync_api import expect


class Desktop:
    """One page of the studio.

    Args:
        page: The page of Playwright.
    """

    def __init__(self, page) -> None:
        self.page = page
        self.keyboard = page.keyboard
        self.diagram = page.locator(".flow")
        self.verdict = page.locator(".verdict")
        self.said = page.locator("footer.said")

    def new_model(self, name, notation="XMI"):
        self.page.get_by_role("button", name="New model…").last.click()
        dialog = self.dialog("New model")
        dialog.get_by_label("Name").fill(name)
        dialog.get_by_label(notation).check()
        self.keyboard.press("Enter")
        expect(dialog).to_have_count(0)
        ending = "xmi" if notation == "XMI" else "ros2jaus"
        expect(self.file).to_have_value(f"{name}.{ending}")

    @property
    def file(self):
        return self.page.locator(".header select").first

    @property
    def view(self):
        return self.page.locator(".header select").nth(1)

    def add(self, words, offered):
        """Searches the palette, and adds what is offered first, which has this name."""
        search = self.page.get_by_role("combobox", name="Search what can be added")
        search.fill(words)
        offers = self.page.get_by_role("listbox", name="What can be added").get_by_role("option")
        expect(offers.first.locator(".offer-label")).to_have_text(offered)
        search.press("Enter")

    def box(self, name):
        """The box of this title, whatever is in its rows."""
        return self.page.locator(".box").filter(
            has=self.page.locator(".title", has_text=re.compile(f"^{re.escape(name)}$"))
        )

    def place(self, name):
        """Where a box stands in the diagram, in whole pixels."""
        return self.stands(self.page.locator(".react-flow__node").filter(has=self.box(name)))

    def stands(self, node):
        """Where a part of the diagram stands in it, in whole pixels."""
        moved = node.evaluate("node => node.style.transform")
        return [round(float(match)) for match in re.findall(r"-?[\d.]+(?=px)", moved)]

    def zoom_into(self, part, is_near):
        """Goes nearer to the upper left of a part until something is so."""
        place = part.bounding_box()
        left, top = max(place["x"], 0) + 12, max(place["y"], 0) + 12
        self.page.mouse.move(left, top)
        for _ in range(200):
            if is_near():
                return
            self.page.mouse.wheel(0, -60)
            self.page.wait_for_timeout(400)
        raise AssertionError("it is not nearer")

    def title(self, name):
        return self.box(name).locator(".title")

    def row(self, box, name):
        return self.box(box).locator(".row").filter(has=self.page.locator(".label", has_text=name))

    def rename(self, box, name):
        self.title(box).click()
        self.keyboard.press("F2")
        field = self.box_field()
        field.fill(name)
        field.press("Enter")
        expect(self.box(name)).to_have_count(1)

    def box_field(self):
        return self.page.locator(".box input")

    def dialog(self, title):
        dialog = self.page.get_by_role("dialog", name=title)
        expect(dialog).to_be_visible()
        return dialog

    def tab(self, name):
        """Opens a tab, which may say how much is in it."""
        self.page.get_by_role("tab", name=re.compile(rf"^{name}( \(|$)")).click()

    def draw(self, source, target):
        """Draws a line from a box to another, or row to row, by the pointer."""
        # Between its handles: at its corners and in the middle of its lower border is one.
        place = source.bounding_box()
        source.hover(position={"x": place["width"] / 4, "y": place["height"] / 2})
        start = source.locator("xpath=self::*").evaluate(_SOURCE)
        end = target.bounding_box()
        mouse = self.page.mouse
        mouse.move(start["x"], start["y"])
        mouse.down()
        mouse.move(end["x"] + end["width"] / 2, end["y"] + end["height"] / 2, steps=8)
        mouse.up()

    def drag(self, part, x, y):
        """Drags a part, which is taken near its corner, to a place of the page."""
        place = part.bounding_box()
        mouse = self.page.mouse
        mouse.move(place["x"] + 5, place["y"] + 5)
        mouse.down()
        mouse.move(x, y, steps=5)
        mouse.up()

    def no_problems(self):
        expect(self.verdict).to_have_text("No problems.")


_SOURCE = """box => {
    const node = box.closest('.react-flow__node');
    const ends = [...node.querySelectorAll('.react-flow__handle-right')];
    const near = box.getBoundingClientRect();
    const middle = near.y + near.height / 2;
    const far = end => {
        const place = end.getBoundingClientRect();
        return Math.abs(place.y + place.height / 2 - middle);
    };
    const place = ends.sort((a, b) => far(a) - far(b))[0].getBoundingClientRect();
    return {x: place.x + place.width / 2, y: place.y + place.height / 2};
}"""

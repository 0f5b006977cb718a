"""Checks a built site: links and anchors lead somewhere, nothing is loaded from another host, and
every public name of the Python package is on one page."""

import collections
import html.parser
import pathlib
import re
import sys
import urllib.parse

SITE = pathlib.Path(sys.argv[1]).resolve()
PACKAGE = pathlib.Path(__file__).parents[2] / "crates/cylindroid-py/python/cylindroid/__init__.py"
# Loaded without a click: by tag, the attributes that hold addresses.
LOADED = {
    "script": ["src"], "img": ["src", "srcset"], "iframe": ["src"], "source": ["src", "srcset"],
    "link": ["href"], "video": ["src", "poster"], "audio": ["src"], "object": ["data"],
    "embed": ["src"], "use": ["href", "xlink:href"], "image": ["href", "xlink:href"],
}  # fmt: skip
# Relations of <link> that load nothing.
NOT_LOADED = {"canonical", "next", "prev", "alternate"}
CSS_ADDRESS = re.compile(r"url\(\s*['\"]?([^'\")]+)|@import\s+['\"]([^'\"]+)")


class Page(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.ids, self.links, self.loads, self.in_style = set(), [], [], False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = {name: value or "" for name, value in attributes}
        self.in_style = tag == "style"
        if "id" in attributes:
            self.ids.add(attributes["id"])
        if tag == "a" and "name" in attributes:
            self.ids.add(attributes["name"])
        if tag == "a" and "href" in attributes:
            self.links.append(attributes["href"])
        if tag == "link" and attributes.get("rel") in NOT_LOADED:
            return
        self.loads += [attributes[name] for name in LOADED.get(tag, []) if name in attributes]
        self.loads += addresses(attributes.get("style", ""))

    def handle_endtag(self, tag):
        self.in_style = False

    def handle_data(self, data):
        if self.in_style:
            self.loads += addresses(data)


def addresses(css):
    return [a or b for a, b in CSS_ADDRESS.findall(css)]


def is_elsewhere(address):
    return bool(re.match(r"(?!data:|about:|javascript:)[a-z][a-z0-9+.-]*:|//", address, re.I))


def check():
    problems = []
    # rustdoc checks its own links.
    own = [path for path in SITE.rglob("*.html") if path.relative_to(SITE).parts[0] != "rust"]
    pages = {path: Page(path.read_text()) for path in own}
    # The script of the theme would load Mermaid from another host.
    problems += [f"{path} has a diagram of Mermaid" for path in own if '="mermaid' in path.read_text()]
    links = 0
    for path, page in pages.items():
        name = path.relative_to(SITE)
        # 404.html is shown at any address, so its links start at the root.
        base = SITE if name == pathlib.Path("404.html") else path.parent
        for address in page.loads:
            if is_elsewhere(address):
                problems.append(f"{name} loads {address} from another host")
        for address in page.links + page.loads:
            if is_elsewhere(address) or re.match("(data|about|javascript):", address):
                continue
            links += 1
            split = urllib.parse.urlsplit(address)
            relative = urllib.parse.unquote(split.path)
            there = (SITE / relative.lstrip("/")) if relative.startswith("/") else base / relative
            there = path if not relative else there.resolve()
            if there.is_dir():
                there /= "index.html"
            anchor = urllib.parse.unquote(split.fragment)
            if not there.is_file():
                problems.append(f"{name} leads to {address}, which is not there")
            elif anchor and there in pages and anchor not in pages[there].ids:
                problems.append(f"{name} leads to {address}: no such anchor")
    for path in SITE.rglob("*.css"):
        for address in addresses(path.read_text()):
            there = path.parent / urllib.parse.urlsplit(address).path
            if is_elsewhere(address) or not (address.startswith(("data:", "#")) or there.is_file()):
                problems.append(f"{path.relative_to(SITE)} loads {address}")
    problems += python_names(pages)
    if problems:
        sys.exit("\n".join(sorted(set(problems))))
    print(f"{len(pages)} pages, {links} links and addresses: all lead somewhere in the site")


def python_names(pages):
    """Every public name once, with a docstring."""
    exports = re.search(r"__all__ = \[(.*?)\]", PACKAGE.read_text(), re.S)
    names = set(re.findall(r'"(\w+)"', exports[1])) - {"__version__"}
    found = collections.Counter()
    for path, page in pages.items():
        if "reference/python" in path.as_posix():
            found.update(i for i in page.ids if i.startswith("cylindroid.") and i.count(".") == 1)
    wrong = [name for name in names if found[f"cylindroid.{name}"] != 1]
    return [f"cylindroid.{name} is on {found[f'cylindroid.{name}']} pages" for name in wrong]


check()

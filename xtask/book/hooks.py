"""Hooks of MkDocs: pages of the repository outside docs/, formulas, and files of npm packages."""

import html
import json
import os
import pathlib
import posixpath
import re
import subprocess

from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File, InclusionLevel

HERE = pathlib.Path(__file__).parent
ROOT = HERE.parents[1]
PACKAGES = pathlib.Path(os.environ["CYLINDROID_BOOK_PACKAGES"])  # set by `cargo xtask book`

# Documents of the repository that are pages of the book.
DOCUMENTS = {
    "CONVENTIONS.md": "conventions.md",
    "CONTRIBUTING.md": "project/contributing.md",
    "ARCHITECTURE.md": "project/architecture.md",
    "CHANGELOG.md": "project/changelog.md",
}
# Where links to these lead.
ALSO = {"README.md": "index.md"}
LANGUAGES = {".rs": "rust", ".py": "python", ".toml": "toml", ".ts": "typescript", ".sh": "sh"}
LINK = re.compile(r"(\]\()([^)\s#]+)((?:#[^)\s]*)?\))")
FENCE = re.compile(r"^```.*?^```", re.M | re.S)

place = {}  # page of the book -> path in the repository
page_of = {}  # path in the repository -> page of the book
rendered = {}  # formulas


def outside_code(markdown, change):
    """Applies a change to the text between fenced blocks."""
    parts, last = [], 0
    for fence in FENCE.finditer(markdown):
        parts += [change(markdown[last : fence.start()]), fence.group()]
        last = fence.end()
    return "".join([*parts, change(markdown[last:])])


def target(origin, link):
    """The path in the repository to which a link leads, or None where it leads elsewhere."""
    if re.match(r"[a-z]+:|/", link):
        return None
    path = posixpath.normpath(posixpath.join(posixpath.dirname(origin), link))
    return path if (ROOT / path).is_file() else None


def on_files(files, config):
    for file in files.documentation_pages():
        place[file.src_uri] = f"docs/{file.src_uri}"
    for path, uri in DOCUMENTS.items():
        files.append(File.generated(config, uri, content=(ROOT / path).read_text()))
        place[uri] = path
    page_of.update({path: uri for uri, path in place.items()} | ALSO)

    # Sources that pages link to are pages as well.
    linked = set()
    for path in list(page_of):
        outside_code((ROOT / path).read_text(), lambda text: linked.update(links(path, text)) or "")
    for path in sorted(linked):
        if path in page_of or path.startswith("docs/"):
            continue
        source = (ROOT / path).read_text()
        language = LANGUAGES.get(pathlib.Path(path).suffix, "text")
        text = f"---\nsearch: {{ exclude: true }}\n---\n# {path}\n\n````{language}\n{source}\n````\n"
        page = File.generated(config, f"source/{path}.md", content=text)
        page.inclusion = InclusionLevel.NOT_IN_NAV
        files.append(page)
        page_of[path] = page.src_uri

    katex = PACKAGES / "katex"
    css = (katex / "dist/katex.min.css").read_text()
    css = re.sub(r",url\([^)]*\.(woff|ttf)\) format\([^)]*\)", "", css)
    files.append(File.generated(config, "assets/katex/katex.min.css", content=css))
    copies = {f"assets/katex/fonts/{font.name}": font for font in (katex / "dist/fonts").glob("*.woff2")}
    copies["assets/katex/LICENSE"] = katex / "LICENSE"
    copies["assets/iframe-worker/shim.js"] = PACKAGES / "iframe-worker/shim/index.js"
    copies["assets/iframe-worker/LICENSE"] = PACKAGES / "iframe-worker/LICENSE"
    for name in ("book.css", "favicon.svg"):
        copies[f"assets/{name}"] = HERE / name
    for uri, path in copies.items():
        files.append(File.generated(config, uri, abs_src_path=str(path)))
    return files


def links(origin, text):
    found = (target(origin, link) for _, link, _ in LINK.findall(text))
    return [path for path in found if path]


def on_page_markdown(markdown, page, config, files):
    uri = page.file.src_uri
    origin = place.get(uri)
    if origin is None:
        return markdown

    def moved(match):
        path = target(origin, match[2])
        if path is None or (path not in page_of and not path.startswith("docs/")):
            return match[0]
        there = page_of.get(path, path.removeprefix("docs/"))
        return match[1] + posixpath.relpath(there, posixpath.dirname(uri) or ".") + match[3]

    def shown(fence):
        # Lines that rustdoc hides.
        text = fence.group()
        return re.sub(r"^# .*\n|^#\n", "", text, flags=re.M) if text.startswith("```rust") else text

    markdown = outside_code(markdown, lambda text: LINK.sub(moved, text))
    return FENCE.sub(shown, markdown)


class Formulas:
    """KaTeX in one process of Node.js."""

    def __init__(self):
        command = ["node", str(HERE / "formulas.mjs"), str(PACKAGES)]
        self.node = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, encoding="utf-8"
        )

    def render(self, tex, display):
        self.node.stdin.write(json.dumps({"tex": tex, "display": display}) + "\n")
        self.node.stdin.flush()
        return json.loads(self.node.stdout.readline())

    def close(self):
        self.node.stdin.close()
        self.node.wait()


formulas = None
ARITHMATEX = re.compile(r'<(span|div) class="arithmatex">\s*\\([(\[])(.*?)\\[)\]]\s*</\1>', re.S)


def on_page_content(content, page, config, files):
    global formulas

    def formula(match):
        global formulas
        tag, bracket, tex = match.groups()
        key = (html.unescape(tex), bracket == "[")
        if key not in rendered:
            formulas = formulas or Formulas()
            answer = formulas.render(*key)
            if "error" in answer:
                raise PluginError(f"{page.file.src_uri}: {answer['error']} in {key[0]}")
            rendered[key] = answer["html"]
        return f'<{tag} class="formula">{rendered[key]}</{tag}>'

    content = ARITHMATEX.sub(formula, content)
    left = re.sub(r"<(pre|code|annotation)\b.*?</\1>", "", content, flags=re.S)
    if "$$" in left:
        raise PluginError(f"{page.file.src_uri}: a formula between $$ needs empty lines around it")
    return content


def on_post_build(config):
    global formulas
    if formulas:
        formulas.close()
        formulas = None

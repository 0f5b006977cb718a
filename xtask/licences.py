"""Licences of the npm packages of the lock files and of the Python packages of this environment.

    python xtask/licences.py LOCK...

deny.toml has the licences that dependencies of what is published may have; tools, which build and
test it, may have those of TOOLS as well. A package without a licence, or with another one, is an
error.
"""

import importlib.metadata
import json
import pathlib
import re
import sys
import tomllib

#: Of programs that build and test; nothing of them is in what is published.
TOOLS = {"0BSD", "BSL-1.0", "CC0-1.0", "MIT-0", "MIT-CMU", "MPL-2.0", "PSF-2.0", "Qhull"}
#: Published to users of plots and of the package: numpy and matplotlib with what they need.
PUBLISHED = {"0BSD", "CC0-1.0", "MIT-CMU", "PSF-2.0"}
#: Words of classifiers and of older metadata.
WORDS = {
    "3-Clause BSD License": "BSD-3-Clause",
    "Apache 2.0": "Apache-2.0",
    "Apache Software License": "Apache-2.0",
    "BSD 3-Clause License": "BSD-3-Clause",
    "BSD License": "BSD-3-Clause",
    "EPL-2.0, BSD-3-Clause": "EPL-2.0 OR BSD-3-Clause",
    "ISC license": "ISC",
    "MIT License": "MIT",
    "any-OSI": "MIT",
    "Mozilla Public License 2.0 (MPL 2.0)": "MPL-2.0",
    "Python Software Foundation License": "PSF-2.0",
}
#: Packages whose metadata have no licence: that of their files.
BY_HAND = {"cmeel-qhull": "Qhull", "ptyprocess": "ISC"}

root = pathlib.Path(__file__).parent.parent
usual = set(tomllib.loads((root / "deny.toml").read_text())["licenses"]["allow"])


def is_allowed(expression, allowed):
    """True if one side of every OR, and all sides of every AND, are allowed."""
    expression = expression.strip("() ")
    return all(
        any(side.strip("() ") in allowed for side in re.split(r" OR ", part))
        for part in re.split(r" AND ", expression)
    )


def python_licence(metadata):
    if metadata.get("License-Expression"):
        return metadata["License-Expression"]
    known = [
        WORDS[word]
        for line in metadata.get_all("Classifier", [])
        if line.startswith("License ::") and (word := line.split(" :: ")[-1]) in WORDS
    ]
    line = (metadata.get("License") or "").split("\n")[0].strip()
    line = "" if line == "UNKNOWN" else line
    return (
        " OR ".join(known)
        or WORDS.get(line, line if len(line) < 30 else "")
        or BY_HAND.get(metadata["Name"].lower(), "")
    )


def needed_by(name):
    """The distributions that one needs."""
    found, open_ = set(), [name]
    while open_:
        current = open_.pop()
        if current in found:
            continue
        found.add(current)
        for line in importlib.metadata.distribution(current).requires or []:
            if re.search(r"extra\s*==", line):
                continue
            needed = re.match(r"[\w.-]+", line)[0].lower().replace("_", "-")
            try:
                importlib.metadata.distribution(needed)
            except importlib.metadata.PackageNotFoundError:
                continue  # of another system or version
            open_.append(needed)
    return found


refused, count = [], 0
for lock in sys.argv[1:]:
    for path, package in json.loads(pathlib.Path(lock).read_text())["packages"].items():
        if path:
            count += 1
            licence = package.get("license", "")
            if not is_allowed(licence, usual | TOOLS if package.get("dev") else usual):
                refused.append(f"{lock}: {path}: {licence or 'no licence'}")
published = set()
for name in ("numpy", "matplotlib"):
    published |= needed_by(name)
for distribution in importlib.metadata.distributions():
    count += 1
    name, licence = distribution.metadata["Name"], python_licence(distribution.metadata)
    is_published = name.lower().replace("_", "-") in published
    if not is_allowed(licence, usual | (PUBLISHED if is_published else TOOLS)):
        refused.append(f"Python: {name}: {licence or 'no licence'}")
if refused:
    sys.exit("\n".join(["licences that are not allowed:", *refused]))
print(f"{count} packages of npm and Python with licences that are allowed")

#!/usr/bin/env python3
"""The licences of everything that the program is built of, as one text: what goes into archives and containers.

usage: licences.py [--platform TARGET] [--offline] > LICENCES.md

Lists the dependencies of the crate secateur-cli (of one platform, or of all), by name, with the licence that each
states and the licence files that it brings along; the same text is printed once. Fails where one states none.
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path

PROGRAM = "secateur-cli"
ROOT = Path(__file__).resolve().parent.parent


def metadata(args):
    words = ["cargo", "metadata", "--format-version", "1", "--locked"]
    words += ["--filter-platform", args.platform] if args.platform else []
    words += ["--offline"] if args.offline else []
    return json.loads(subprocess.run(words, cwd=ROOT, check=True, stdout=subprocess.PIPE).stdout)


def dependencies(told):
    """The packages that the program is linked of; what only tests and builds need is none."""
    nodes = {node["id"]: node for node in told["resolve"]["nodes"]}
    packages = {package["id"]: package for package in told["packages"]}
    first = next(it["id"] for it in told["packages"] if it["name"] == PROGRAM)
    found, left = set(), [first]
    while left:
        place = left.pop()
        if place in found:
            continue
        found.add(place)
        for dependency in nodes[place]["deps"]:
            if any(kind["kind"] is None for kind in dependency["dep_kinds"]):
                left.append(dependency["pkg"])
    own = set(told["workspace_members"])
    return sorted((packages[place] for place in found - own), key=lambda it: (it["name"], it["version"]))


def texts(package):
    """Licence files in the package's folder."""
    folder = Path(package["manifest_path"]).parent
    begins = ("license", "licence", "copying", "notice", "unlicense", "copyright")
    files = [it for it in folder.iterdir() if it.is_file() and it.name.lower().startswith(begins)]
    named = package.get("license_file")
    files += [folder / named] if named and (folder / named) not in files else []
    return [it.read_text(encoding="utf-8", errors="replace").strip() for it in sorted(files)]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--platform")
    parser.add_argument("--offline", action="store_true")
    args = parser.parse_args()
    packages = dependencies(metadata(args))
    users, nameless = {}, []
    print(f"# Licences\n\nsecateur is under the MIT licence. Its program is built of {len(packages)} other packages:\n")
    print("| package | version | licence |\n|---|---|---|")
    for package in packages:
        licence = package["license"] or ("see its text" if package["license_file"] else "")
        if not licence:
            nameless.append(package["name"])
        print(f"| {package['name']} | {package['version']} | {licence} |")
        for text in texts(package):
            users.setdefault(text, []).append(package["name"])
    print("\n## Texts")
    for text, names in users.items():
        print(f"\nOf {', '.join(sorted(set(names)))}:\n\n```\n{text.replace('```', '`` `')}\n```")
    if nameless:
        print(f"no licence is stated by {', '.join(nameless)}", file=sys.stderr)
    return 1 if nameless else 0


if __name__ == "__main__":
    sys.exit(main())
